#!/bin/sh
# config.sh REAL HEADER...: prints config.h, the header that states the number type of a build. In a build for double it also gives
# every public function another name in the library. So a program cannot be linked with, or start with, a library of the other type.
set -eu
real=$1
shift
is_double=0
[ "$real" = float ] || is_double=1
cat <<END
/* Made by the build: the number type of the library, and the names of its functions if that is double. */
#ifndef RHEOLOG_CONFIG_H
#define RHEOLOG_CONFIG_H

/* 1: rheo_real is double; 0: it is float. */
#define RHEO_DOUBLE $is_double
END
if [ $is_double = 1 ]; then
    echo
    sed -n 's/^RHEO_API [^(]*[ *]\(rheo_[a-z0-9_]*\)(.*/#define \1 \1_double/p' "$@"
fi
printf '\n#endif\n'
