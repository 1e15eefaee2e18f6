#!/bin/sh
# dist.sh: run by `meson dist` in its copy of the sources. Gives all files the time of the commit and the usual modes, so that the
# same commit makes the same bytes, whatever the umask.
set -eu
time=$(git -C "$MESON_SOURCE_ROOT" log -1 --format=%ct)
cd "$MESON_DIST_ROOT"
find . ! -type l -exec chmod u=rwX,go=rX {} +
find . -depth -exec touch -h -d "@$time" {} +
