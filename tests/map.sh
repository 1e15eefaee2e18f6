#!/bin/sh
# map.sh SOURCE: checks that the map in tests/README.md names exactly the files of src/, and that the tests in it exist; and that
# tests/meson.build compiles all files that a changed library must have. At the end the script proves that it notices a missing
# file.
set -eu
cd "$1"
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
find src -name '*.c' -o -name '*.h' -o -name '*.def' -o -name '*.py' -o -name '*.js' -o -name '*.html' -o -name '*.css' | sed 's/^src\///; s/\.[a-z]*$//' | sort -u >"$scratch/files"

differences() { # differences README: prints files that only one side has
    sed -n '/^## From source to test/,$p' "$1" | grep '^| `' | sed 's/ | .*//' | grep -o '`[^`]*`' | tr -d '`' | sort -u >"$scratch/map"
    diff "$scratch/files" "$scratch/map" | sed -n 's/^< /not in tests\/README.md: src\//p; s/^> /in tests\/README.md, but not a file: src\//p'
}

# Files that depend on RHEO__MORE_MODELS, RHEO__SABOTAGE or RHEO__REWORDED.
not_changed() { # not_changed MESON: prints those that it does not name
    for file in $(grep -rlE --include='*.c' 'world/model_list\.h"|RHEO__SABOTAGE|rheo__reword\(' src); do
        grep -q "'\.\./$file'" "$1" || echo "tests/meson.build does not compile $file for its changed library"
    done
}

found=$(
    differences tests/README.md
    not_changed tests/meson.build
    sed -n '/^## From source to test/,$p' tests/README.md | sed -n 's/^| `.*` | \(.*\) |$/\1/p' | tr ',' '\n' | sed 's/^ *//' | sort -u |
        while read -r name; do
            [ "$name" = "every test" ] || [ -e "tests/test_$name.c" ] || [ -e "tests/$name.sh" ] || [ -e "tests/$name.c" ] ||
                [ -e "tests/$name" ] || [ -e "tests/fuzz_${name#corpus_}.c" ] || echo "tests/README.md names a test that does not exist: $name"
        done
)
[ -z "$found" ] || { echo "$found"; exit 1; }
sed 's/`core\/state`/`core\/gone`/' tests/README.md >"$scratch/wrong.md"
[ "$(differences "$scratch/wrong.md" | wc -l)" = 2 ] || { echo "the check does not notice a missing file"; exit 1; }
sed 's/world\/models/world\/gone/' tests/meson.build >"$scratch/wrong.build"
[ "$(not_changed "$scratch/wrong.build" | wc -l)" = 1 ] || { echo "the check does not notice a missing file of a changed library"; exit 1; }
echo "map: complete"
