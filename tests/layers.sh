#!/bin/sh
# Lower folders never include higher ones: core < space < thickening, melting, solids < world < record < scenes < view < cli.
# The program stands on the public headers (and the JSON scenes, which are a part of it). Includes the proof that the
# check fails when it should.
set -eu
rank() {
    case $1 in
    core) echo 1 ;; space) echo 2 ;; thickening | melting | solids) echo 3 ;; world) echo 4 ;; record) echo 5 ;;
    scenes) echo 6 ;; view) echo 7 ;; cli) echo 8 ;; *) echo 0 ;;
    esac
}
# Prints every line below $1/src that includes what it must not.
check() {
    for file in $(find "$1/src" -name '*.[ch]'); do
        folder=$(basename "$(dirname "$file")")
        own=$(rank "$folder")
        [ "$own" != 0 ] || echo "$file: the folder $folder has no place in the order"
        sed -n 's/^#include "\([a-z]*\)\/\([a-z0-9_]*\.h\)".*/\1 \2/p' "$file" | while read -r other header; do
            [ "$other" != rheolog ] || continue
            its=$(rank "$other")
            bad=no
            [ "$its" -le "$own" ] || bad=yes
            # Folders of one rank do not know each other.
            [ "$its" -ne "$own" ] || [ "$other" = "$folder" ] || bad=yes
            # The program: its own headers and the JSON scenes.
            [ "$folder" != cli ] || [ "$other" = cli ] || [ "$other/$header" = cli/scene_json.h ] || bad=yes
            [ $bad = no ] || echo "$file includes $other/$header"
        done
    done
}
found=$(check "$1")
[ -z "$found" ] || { echo "$found"; exit 1; }
trap 'rm -rf "$tmp"' EXIT
tmp=$(mktemp -d)
mkdir -p "$tmp/src/core" "$tmp/src/solids" "$tmp/src/cli"
echo '#include "world/world.h"' >"$tmp/src/core/a.c"
echo '#include "thickening/thickening.h"' >"$tmp/src/solids/a.c"
echo '#include "record/recording.h"' >"$tmp/src/cli/a.c"
[ "$(check "$tmp" | wc -l)" = 3 ] || { echo "the check does not see what it should"; exit 1; }
echo "layers: in order"
