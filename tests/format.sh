#!/bin/sh
# format.sh SOURCE: checks that every C file in git is formatted by .clang-format, and that no file is too long, nor any script or
# style of a page: 500 lines in src/, 800 in tests/ and bench/. Other versions than clang-format 14 format differently; without version 14 only the sizes are
# checked. At the end the script proves that it notices each error.
set -eu
cd "$1"
source=$PWD
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
[ -e .git ] && command -v git >/dev/null || { echo "format: not a git checkout; skipped"; exit 77; }

sizes() { # sizes FILE...: prints the files that are too long
    for file; do
        case $file in
        src/* | */src/*) limit=500 ;;
        tests/* | bench/*) limit=800 ;;
        *) continue ;;
        esac
        lines=$(wc -l <"$file")
        [ "$lines" -le $limit ] || echo "$file has $lines lines; at most $limit are allowed"
    done
}

# .def files are rows of macros, which clang-format cannot format.
files=$(git ls-files '*.c' '*.h')
# shellcheck disable=SC2086
found=$(sizes $files $(git ls-files '*.def' '*.js' '*.css'))
[ -z "$found" ] || { echo "$found"; exit 1; }
mkdir -p "$scratch/src"
yes '/* a line */' | head -n 501 >"$scratch/src/long.c"
[ "$(sizes "$scratch/src/long.c" | wc -l)" = 1 ] || { echo "the check does not see a long file"; exit 1; }

formatter=
for name in clang-format-14 clang-format; do
    if command -v $name >/dev/null && $name --version | grep -q 'version 14\.'; then
        formatter=$name
        break
    fi
done
if [ -z "$formatter" ]; then
    echo "format: no clang-format 14 here; only the sizes are checked"
    exit 77
fi
# shellcheck disable=SC2086
if ! $formatter --dry-run -Werror $files 2>"$scratch/log"; then
    grep error "$scratch/log"
    echo "format these files with: clang-format -i FILE"
    exit 1
fi
cp "$source/.clang-format" "$scratch"
printf 'int  main( void ){return 0;}\n' >"$scratch/bad.c"
if $formatter --dry-run -Werror "$scratch/bad.c" 2>/dev/null; then
    echo "the check does not see bad formatting"
    exit 1
fi
echo "format: correct"
