#!/bin/sh
# embed.sh FILE: prints the bytes of a file as numbers. Use: `const char text[] = {`, `#include "FILE.inc"`, `};`.
set -eu
od -A n -v -t u1 <"$1" | sed 's/[0-9][0-9]*/&,/g'
