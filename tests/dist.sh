#!/bin/sh
# dist.sh SOURCE COMPILER...: two calls of `meson dist` from clones with other times and another umask make equal bytes, and
# the tarball builds a program that verifies the golden recordings. The files are those of the last commit. Skipped without git.
set -eu
source=$(realpath "$1")
shift
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
fail() {
    echo "$1"
    [ ! -e "$tmp/said" ] || tail -n 30 "$tmp/said"
    exit 1
}
unset DESTDIR GIT_DIR GIT_WORK_TREE
# Git also refuses a checkout of another user.
[ -e "$source/.git" ] && git -C "$source" rev-parse -q --verify HEAD >/dev/null 2>&1 || { echo "dist: not a git checkout; skipped"; exit 77; }
compiler=$*
archive() { # archive NAME UMASK: makes $tmp/NAME.tar.xz
    (
        umask "$2"
        git clone -q --no-local "$source" "$tmp/$1" &&
            CC=$compiler meson setup "$tmp/$1/build" "$tmp/$1" -Dtests=disabled &&
            meson dist -C "$tmp/$1/build" --no-tests --formats xztar
    ) >"$tmp/said" 2>&1 || fail "there is no tarball"
    cp "$tmp/$1"/build/meson-dist/rheolog-*.tar.xz "$tmp/$1.tar.xz"
}
archive first 022
archive second 077
cmp "$tmp/first.tar.xz" "$tmp/second.tar.xz" || fail "two tarballs of one commit differ"
tar -xf "$tmp/first.tar.xz" -C "$tmp"
root=$(echo "$tmp"/rheolog-*)
sh "$source/tests/package.sh" "$root" >"$tmp/said" || fail "the tarball lacks something"
# Scalar loops take least time to compile, and have the same bits.
{ CC=$compiler meson setup "$tmp/build" "$root" -Dtests=disabled -Dlanes=scalar -Doptimization=1 && ninja -C "$tmp/build" rheolog; } \
    >"$tmp/said" 2>&1 || fail "the tarball does not build"
"$tmp/build/rheolog" verify "$root"/replays/*.rlog "$root"/replays/builtin/*.rlog >"$tmp/said" 2>&1 ||
    fail "the program of the tarball does not verify the golden recordings"
echo "dist: equal bytes, and the golden recordings verify"
