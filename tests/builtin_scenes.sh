#!/bin/sh
# builtin_scenes.sh SOURCE RHEOLOG: the built-in scenes are those of tests/builtin_scenes.txt, number by number. Users have golden
# recordings of them, which no change here may break unnoticed. After an intended change:
#
#   sh tests/builtin_scenes.sh . build/rheolog --write
set -eu
kept=$1/tests/builtin_scenes.txt rheolog=$2
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
"$rheolog" scenes | sed 's/ .*//' >"$tmp/names"
while read -r name; do
    "$rheolog" run "$name" --write-scene
done <"$tmp/names" >"$tmp/now"
if [ "${3-}" = --write ]; then
    cp "$tmp/now" "$kept"
    exit
fi
diff "$kept" "$tmp/now" || { echo "built-in scenes have changed; see the head of tests/builtin_scenes.sh"; exit 1; }

# Proves that one digit is noticed.
sed '0,/0\.5/s//0.6/' "$tmp/now" >"$tmp/other"
if cmp -s "$kept" "$tmp/other"; then
    echo "builtin_scenes.sh does not notice another number"
    exit 1
fi
echo "builtin_scenes: $(wc -l <"$tmp/names") scenes are as they were"
