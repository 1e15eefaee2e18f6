#!/bin/sh
# embed.sh FILE...: prints the bytes of files as numbers. Use: `const char text[] = {`, `#include "FILE.inc"`, `};`.
set -eu
cat -- "$@" | od -A n -v -t u1 | sed 's/[0-9][0-9]*/&,/g'
