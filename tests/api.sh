#!/bin/sh
# api.sh SOURCE: makes the reference of the library, in which every public declaration must be documented and every link must lead
# somewhere, and proves that the check notices declarations that are not documented. Skipped without doxygen.
set -eu
source=$(realpath "$1")
command -v doxygen >/dev/null || { echo "there is no doxygen"; exit 77; }
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
# undocumented SOURCE: prints what is not documented in the headers of this folder, then the number of declarations
undocumented() {
    rm -rf "$tmp/api"
    sh "$source/docs/api/make.sh" "$1" "$tmp/api" >"$tmp/said" 2>&1 || cat "$tmp/said"
    python3 "$source/tests/api.py" "$tmp/api/xml"
}
found=$(undocumented "$source")
case $found in
*[!0-9]*) echo "$found" && exit 1 ;;
esac
# A header with a function has at least a group of them in the reference.
functions=$(grep -ch '^RHEO_API' "$source"/include/rheolog/*.h | awk '{ n += $1 } END { print n }')
[ "$found" -gt $((3 * functions)) ] || { echo "only $found declarations are read"; exit 1; }
for header in "$source"/include/rheolog/*.h; do
    name=$(basename "$header" .h | sed 's/_/__/g')_8h.html
    grep -q "href=\"$name\"" "$tmp/api/files.html" || { echo "the reference has no page of $header"; exit 1; }
done
broken=$(cd "$tmp/api" && grep -oh 'href="[^":#]*["#]' ./*.html | sed 's/href="//; s/["#]$//' | sort -u | while read -r name; do
    [ -z "$name" ] || [ -e "$name" ] || echo "$name"
done)
[ -z "$broken" ] || { echo "links lead nowhere: $broken"; exit 1; }
grep -q 'rheo_recorder_open</a>' "$tmp/api/index.html" || { echo "the first page has no example"; exit 1; }

# notices WHAT HEADER CHANGE: the check says this of a copy of the headers that sed changes
mkdir "$tmp/copy"
notices() {
    rm -rf "$tmp/copy/include"
    cp -R "$source/include" "$source/meson.build" "$tmp/copy"
    mkdir -p "$tmp/copy/docs"
    cp -R "$source/docs/api" "$source/docs/library.md" "$tmp/copy/docs"
    sed "$3" "$source/include/rheolog/$2" >"$tmp/copy/include/rheolog/$2"
    ! cmp -s "$source/include/rheolog/$2" "$tmp/copy/include/rheolog/$2" || { echo "$2 is not changed"; exit 1; }
    undocumented "$tmp/copy" >"$tmp/noticed"
    grep -q "$1" "$tmp/noticed" || { echo "not noticed: $1"; exit 1; }
}
notices 'rheo_version.*not documented' base.h '/Version of the library, for example/d'
notices 'RHEO_ERROR_FILE is not documented' base.h '/could not open, read, write or rename/d'
notices 'quadratic_viscosity is not documented' world.h '/Factor beta of the viscosity impulse/d'
notices 'rheo_use_simd does not say how it fails' base.h 's/RHEO_ERROR_ARGUMENT if this build lacks/Fails if this build lacks/'
echo "api: $found declarations are documented"
