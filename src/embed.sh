#!/bin/sh
# embed.sh FILE: the bytes of a file as numbers for a C array, for `const char text[] = {` `#include "FILE.inc"` `};`.
set -eu
od -A n -v -t u1 <"$1" | sed 's/[0-9][0-9]*/&,/g'
