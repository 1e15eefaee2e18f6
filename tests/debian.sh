#!/bin/sh
# debian.sh SOURCE BUILD: checks that the package for Debian takes every file that BUILD installs. Debian refuses a package that leaves
# one out.
#
#   sh tests/debian.sh . build package    also builds the packages of the last commit, source and binary, and shows them to lintian,
#                                         which must have nothing to say; ten minutes. Skipped without debhelper or lintian
set -eu
source=$(realpath "$1") build=$(realpath "$2")
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
# left_out FOLDER: prints installed files that no *.install file of the folder has. Libraries are in another folder there.
left_out() {
    sed 's/ .*//; s|^usr/lib/[*]/|usr/lib/|' "$1"/*.install >"$tmp/patterns"
    while read -r file; do
        taken=
        while read -r pattern; do
            # shellcheck disable=SC2254
            case $file in
            $pattern | $pattern/*) taken=yes && break ;;
            esac
        done <"$tmp/patterns"
        [ "$taken" ] || echo "$file"
    done <"$tmp/files"
}
meson introspect --installed "$build" | python3 -c '
import json, sys
prefix = sys.argv[1].rstrip("/") + "/"
for name in json.load(sys.stdin).values():
    name = name[len(prefix):] if name.startswith(prefix) else name.lstrip("/")
    print("usr/" + name.replace("local/lib/python", "lib/python"))
' "$(meson introspect --buildoptions "$build" | python3 -c 'import json, sys
print(next(o["value"] for o in json.load(sys.stdin) if o["name"] == "prefix"))')" | sed 's/-double//g' >"$tmp/files"
[ "$(wc -l <"$tmp/files")" -gt 20 ] || { echo "too few files are installed: $(cat "$tmp/files")"; exit 1; }
found=$(left_out "$source/debian")
[ -z "$found" ] || { echo "debian/*.install leave out: $found"; exit 1; }
# Proves that the check notices a file that is left out.
mkdir "$tmp/debian"
cp "$source"/debian/*.install "$tmp/debian"
sed -i '/fish/d' "$tmp/debian/rheolog.install"
left_out "$tmp/debian" | grep -q rheolog.fish || { echo "a file that is left out is not noticed"; exit 1; }
[ "${3-}" = package ] || { echo "debian: takes $(wc -l <"$tmp/files") files"; exit 0; }

for command in dh dh_python3 dpkg-buildpackage lintian; do
    command -v $command >/dev/null || { echo "there is no $command"; exit 77; }
done
version=$(sed -n "s/^  version: '\(.*\)',$/\1/p" "$source/meson.build")
git -C "$source" archive --prefix="rheolog-$version/" HEAD . ':!debian' | gzip -n >"$tmp/rheolog_$version.orig.tar.gz"
git -C "$source" archive --prefix="rheolog-$version/" HEAD | tar -x -C "$tmp"
(cd "$tmp/rheolog-$version" && dpkg-buildpackage -us -uc) >"$tmp/said" 2>&1 || { tail -n 30 "$tmp/said"; exit 1; }
# Nobody can know: the address of a maintainer, the number of a bug that asks for the package, the page of the project.
(cd "$tmp" && lintian --profile debian --display-info --pedantic --allow-root --fail-on error,warning,info,pedantic --suppress-tags \
    bogus-mail-host,bogus-mail-host-in-debian-changelog,initial-upload-closes-no-bugs,debian-watch-file-is-missing,no-homepage-field \
    ./*.changes)
echo "debian: packages are built, and lintian has nothing to say"
