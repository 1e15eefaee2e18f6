#!/bin/sh
# map.sh SOURCE: checks that the map in tests/README.md names exactly the files of src/, and that the tests in it exist. At the
# end the script proves that it notices a missing file.
set -eu
cd "$1"
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
find src -name '*.c' -o -name '*.h' -o -name '*.def' | sed 's/^src\///; s/\.[a-z]*$//' | sort -u >"$scratch/files"

differences() { # differences README: prints files that only one side has
    sed -n '/^## From source to test/,$p' "$1" | grep '^| `' | sed 's/ | .*//' | grep -o '`[^`]*`' | tr -d '`' | sort -u >"$scratch/map"
    diff "$scratch/files" "$scratch/map" | sed -n 's/^< /not in tests\/README.md: src\//p; s/^> /in tests\/README.md, but not a file: src\//p'
}

found=$(
    differences tests/README.md
    sed -n '/^## From source to test/,$p' tests/README.md | sed -n 's/^| `.*` | \(.*\) |$/\1/p' | tr ',' '\n' | sed 's/^ *//' | sort -u |
        while read -r name; do
            [ "$name" = "every test" ] || [ -e "tests/test_$name.c" ] || [ -e "tests/$name.sh" ] || [ -e "tests/$name.c" ] ||
                [ -e "tests/$name" ] || [ -e "tests/fuzz_${name#corpus_}.c" ] || echo "tests/README.md names a test that does not exist: $name"
        done
)
[ -z "$found" ] || { echo "$found"; exit 1; }
sed 's/`core\/state`/`core\/gone`/' tests/README.md >"$scratch/wrong.md"
[ "$(differences "$scratch/wrong.md" | wc -l)" = 2 ] || { echo "the check does not notice a missing file"; exit 1; }
echo "map: complete"
