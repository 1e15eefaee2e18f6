#!/bin/sh
# abi.sh SOURCE float|double LIBRARY... -- COMPILER...: compares what the public headers promise to compiled programs, the functions and
# the layout of structs, with the baseline tests/abi.xml.gz. New functions, structs and enumerators break no program and need no new
# baseline. A changed or removed function or struct breaks some, and needs a note. Also checks that the shared libraries export exactly
# the functions of the headers. Skipped without abidw and abidiff.
#
#   sh tests/abi.sh . --write           makes the baseline again after additions
#   sh tests/abi.sh . --write "NOTE"    after any change; puts the note into CHANGELOG.md
#
# It is made of a library with the headers' functions, but without their contents. So changes inside of the library do not count, and
# compilers and their options do not matter. It is that of float; the functions and structs for double come from the same lines.
set -eu
source=$(realpath "$1")
shift
baseline=$source/tests/abi.xml.gz
command -v abidw >/dev/null && command -v abidiff >/dev/null || { echo "there is no abidw or abidiff"; exit 77; }
[ "$(getconf LONG_BIT)" = 64 ] || { echo "the baseline is of machines with 64 bits"; exit 77; }
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
libraries='' real=float write='' note=''
if [ "$1" = --write ]; then
    write=yes note=${2-}
    set -- cc
else
    real=$1
    shift
    while [ "$1" != -- ]; do
        libraries="$libraries $1"
        shift
    done
    shift
fi

# describe HEADERS NAME COMPILER...: writes the library $tmp/NAME.so and its description $tmp/NAME.xml
describe() {
    headers=$1 name=$2
    shift 2
    rm -rf "$tmp/include"
    mkdir -p "$tmp/include/rheolog"
    cp "$headers"/*.h "$tmp/include/rheolog"
    sh "$source/src/config.sh" float "$headers"/*.h >"$tmp/include/rheolog/config.h"
    printf '#include "rheolog/rheolog.h"\n#include "rheolog/scene_json.h"\n' >"$tmp/all.c"
    # RHEO_API becomes a mark, and what is marked gets a body.
    "$@" -E -P -I"$tmp/include" '-D__attribute__(x)=rheo__function' "$tmp/all.c" |
        awk '/^ *rheo__function /{ on = 1 } on && /;$/ { sub(/;$/, " { for (;;) ; }"); on = 0 } { gsub(/rheo__function/, ""); print }' >"$tmp/$name.c"
    "$@" -w -g -O0 -std=gnu17 -fPIC -shared "$tmp/$name.c" -o "$tmp/$name.so"
    abidw --no-architecture --no-corpus-path --no-comp-dir-path --no-show-locs --no-elf-needed --no-parameter-names --type-id-style hash \
        --no-write-default-sizes --out-file "$tmp/$name.xml" "$tmp/$name.so"
    [ "$(names "$tmp/$name.so" | wc -l)" -gt 200 ] || { echo "too few functions are found"; exit 1; }
}
names() { # names LIBRARY: its functions
    nm -D --defined-only "$1" | awk '{ print $NF }' | grep '^rheo_' | sort
}
changes() { # changes OLD.xml NEW: prints how programs that were compiled with OLD break; the status is that of abidiff
    abidiff --no-architecture --no-added-syms --no-unreferenced-symbols "$1" "$2"
}
compiler=$*
describe "$source/include/rheolog" new "$@"
missing=$(sed -n 's/^typedef struct \(rheo_[a-z_]*\) {$/\1/p' "$source"/include/rheolog/*.h | while read -r name; do
    grep -q "<class-decl name='$name' " "$tmp/new.xml" || echo "$name"
done)
[ -z "$missing" ] || { echo "no function has to do with these structs: $missing"; exit 1; }
[ ! -e "$baseline" ] || gzip -dc "$baseline" >"$tmp/old.xml"

if [ "$write" ]; then
    if [ -e "$baseline" ] && ! changes "$tmp/old.xml" "$tmp/new.xml" >"$tmp/said" && [ -z "$note" ]; then
        cat "$tmp/said"
        echo "compiled programs break; say why: sh tests/abi.sh . --write \"NOTE\""
        exit 1
    fi
    if [ "$note" ]; then
        awk -v note="- Programs must be compiled again: $note" '{ print } /^### Changed$/ && !done { getline; print; print note; done = 1 }' \
            "$source/CHANGELOG.md" >"$tmp/changelog"
        cp "$tmp/changelog" "$source/CHANGELOG.md"
    fi
    gzip -n -9 <"$tmp/new.xml" >"$baseline"
    echo "abi: wrote tests/abi.xml.gz"
    exit 0
fi

if ! changes "$tmp/old.xml" "$tmp/new.xml" >"$tmp/said"; then
    cat "$tmp/said"
    echo "The headers break compiled programs. If that must be: sh tests/abi.sh . --write \"NOTE\""
    exit 1
fi
if [ "$libraries" ]; then
    names "$tmp/new.so" >"$tmp/promised"
    ending=
    [ "$real" = float ] || ending=_double
    # shellcheck disable=SC2086
    for library in $libraries; do
        names "$library"
    done | sed "s/$ending\$//" | sort >"$tmp/exported"
    [ "${libraries#*scene-json}" != "$libraries" ] || sed -i '/^rheo_scene_\(from\|read\|to\|write\)_json$/d' "$tmp/promised"
    diff "$tmp/promised" "$tmp/exported" || { echo "the headers (<) and the libraries (>) have other functions"; exit 1; }
fi

# Proves that the comparison notices changes, and what it lets pass.
notices() { # notices yes|no HEADER CHANGE: whether a changed copy of the headers breaks programs
    rm -rf "$tmp/copy"
    cp -R "$source/include/rheolog" "$tmp/copy"
    sed "$3" "$source/include/rheolog/$2" >"$tmp/copy/$2"
    ! cmp -s "$source/include/rheolog/$2" "$tmp/copy/$2" || { echo "$2 is not changed by $3"; exit 1; }
    # shellcheck disable=SC2086
    describe "$tmp/copy" changed $compiler
    broken=no
    changes "$tmp/old.xml" "$tmp/changed.xml" >"$tmp/said" || broken=yes
    [ $broken = "$1" ] || { cat "$tmp/said"; echo "$2 changed by $3: noticed: $broken"; exit 1; }
}
notices yes world.h 's/uint32_t rheo_world_particle_count(/uint64_t rheo_world_particle_count(/'
notices yes world.h 's/^    double radius;/&\n    double more;/'
notices yes record.h 's/^RHEO_API uint64_t rheo_recorder_bytes(.*//'
notices yes why.h 's/RHEO_SOURCE_SPRING = 4/RHEO_SOURCE_SPRING = 40/'
notices yes find.h 's/typedef bool rheo_find_receiver(void \*data/typedef bool rheo_find_receiver(int data/'
notices no why.h 's/^    RHEO_CHAIN_BORN = 6,/&\n    RHEO_CHAIN_MORE = 7,/'
notices no base.h 's/^RHEO_API const char \*rheo_version(void);/&\ntypedef struct rheo_more { int more; } rheo_more;\nRHEO_API rheo_more rheo_more_of(int a);/'
notices no base.h 's/Version of the library, for/The version, for/'
echo "abi: $(names "$tmp/new.so" | wc -l) functions, $(grep -c '<class-decl' "$tmp/new.xml") structs: no compiled program breaks"
