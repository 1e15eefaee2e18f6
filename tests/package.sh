#!/bin/sh
# package.sh SOURCE: checks what surrounds the sources for those who pass them on: version and date are the same everywhere, the texts of
# the licence are, CITATION.cff has the fields that its format (1.2.0) demands, and every file has a licence (`reuse lint`, if there is
# one). At the end the script proves that it notices faults.
set -eu
source=$(realpath "$1")
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT

# dates ROOT: prints the date of the newest version, with each file that has it
dates() {
    version=$(sed -n "s/^  version: '\([0-9.]*\)',$/\1/p" "$1/meson.build")
    sed -n "s/^## $version - //p" "$1/CHANGELOG.md" | sed 's/$/ CHANGELOG.md/'
    sed -n 's/^date-released: //p' "$1/CITATION.cff" | sed 's/$/ CITATION.cff/'
    LC_ALL=C date -u -d "$(sed -n 's/^ -- .*>  //p' "$1/debian/changelog" | head -n 1)" '+%F debian/changelog' || true
}
# versions ROOT: prints each version, with its file
versions() {
    sed -n "s/^  version: '\([0-9.]*\)',$/\1 meson.build/p" "$1/meson.build"
    sed -n 's/^#define RHEO_VERSION "\([0-9.]*\)"$/\1 base.h/p' "$1/include/rheolog/base.h"
    sed -n 's/^#define RHEO_VERSION_\(MAJOR\|MINOR\|PATCH\) //p' "$1/include/rheolog/base.h" | paste -s -d . | sed 's/$/ base.h, in numbers/'
    sed -n 's/^version: //p' "$1/CITATION.cff" | sed 's/$/ CITATION.cff/'
    sed -n '1s/^rheolog (\([0-9.]*\)-.*/\1 debian\/changelog/p' "$1/debian/changelog"
}
# faults ROOT: prints what is wrong
faults() {
    [ "$(versions "$1" | sed 's/ .*//' | uniq -c | sed 's/^ *\([0-9]*\) .*/\1/')" = 5 ] || { echo "versions differ:"; versions "$1"; }
    [ "$(dates "$1" | sed 's/ .*//' | uniq -c | sed 's/^ *\([0-9]*\) .*/\1/')" = 3 ] || { echo "dates differ:"; dates "$1"; }
    cmp -s "$1/LICENSE" "$1/LICENSES/MIT.txt" || echo "LICENSE and LICENSES/MIT.txt differ"
    # The package's text of a licence is that of LICENSES, indented.
    for license in MIT LicenseRef-Stanford-Bunny; do
        sed -n "/^License: $license\$/,/^\$/p" "$1/debian/copyright" | sed -n '/^ /{ s/^ //; s/^[.]$//; p; }' >"$tmp/of_package"
        sed '/^MIT License$/,/^Copyright/d' "$1/LICENSES/$license.txt" | sed '/./,$!d' | cmp -s - "$tmp/of_package" ||
            echo "debian/copyright has another text of $license"
    done
    for field in 'cff-version: 1[.]2[.]0' 'message: .' 'title: .' 'type: software' 'license: MIT'; do
        grep -qx "$field.*" "$1/CITATION.cff" || echo "CITATION.cff lacks $field"
    done
    awk '/^authors:$/ { list = 1; next } list { good = /^  - name: ./; exit } END { exit !good }' "$1/CITATION.cff" ||
        echo "CITATION.cff lacks authors"
    # Every file but those of git and the licences is one of a stanza that has files, and each licence has its text.
    for license in $(sed -n 's/^License: //p' "$1/debian/copyright" | sort -u); do
        [ -s "$1/LICENSES/$license.txt" ] || echo "LICENSES lacks $license"
    done
    grep -qx 'Files: [*]' "$1/debian/copyright" || echo "debian/copyright leaves out files"
}
found=$(faults "$source")
[ -z "$found" ] || { echo "$found"; exit 1; }

mkdir -p "$tmp/copy/include/rheolog" "$tmp/copy/debian"
cp -R "$source/meson.build" "$source/LICENSE" "$source/LICENSES" "$source/CHANGELOG.md" "$source/CITATION.cff" "$tmp/copy"
cp "$source/include/rheolog/base.h" "$tmp/copy/include/rheolog"
cp "$source/debian/changelog" "$source/debian/copyright" "$tmp/copy/debian"
[ -z "$(faults "$tmp/copy")" ] || { echo "a copy has faults"; exit 1; }
while read -r file change said; do
    cp "$tmp/copy/$file" "$tmp/kept"
    sed "$change" "$tmp/kept" >"$tmp/copy/$file"
    faults "$tmp/copy" | grep -q "$said" || { echo "not noticed: $file with $change"; exit 1; }
    cp "$tmp/kept" "$tmp/copy/$file"
done <<'LIST'
CITATION.cff s/^version:.*/version:9.9.9/ versions differ
CITATION.cff /^date-released:/d dates differ
CITATION.cff /^authors:/d lacks authors
debian/changelog 1s/([0-9.]*/(9.9.9/ versions differ
include/rheolog/base.h s/MINOR.*/MINOR/ versions differ
LICENSE s/free/dear/ differ
debian/copyright s/WARRANTY/warranty/ another text of MIT
debian/copyright s/^Files:.*/Files:x/ leaves out files
LIST
reuse=
if [ -e "$source/.git" ] && command -v reuse >/dev/null; then
    (cd "$source" && reuse lint) >"$tmp/said" 2>&1 || { cat "$tmp/said"; exit 1; }
    reuse=", and reuse lint agrees"
fi
echo "package: one version, one licence, a citation$reuse"
