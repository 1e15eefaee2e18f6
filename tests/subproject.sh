#!/bin/sh
# Uses rheolog as a subproject of meson: a small parent project gets the libraries by their pkg-config names, nothing else of
# rheolog is built, tested or installed, only public headers are found, and a debug build has optimised loops. The parent's programs
# come to the same states as the program RHEOLOG.
#
#   subproject.sh SOURCE RHEOLOG float|double enabled|disabled COMPILER...
set -eu
source=$1 rheolog=$2 real=$3 json=$4
shift 4
unset DESTDIR LD_LIBRARY_PATH
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
fail() {
    echo "$1"
    [ ! -e "$tmp/said" ] || tail -n 40 "$tmp/said"
    exit 1
}
ending=
[ "$real" = float ] || ending=-double
mkdir -p "$tmp/parent/subprojects"
for part in include meson.build meson_options.txt src; do
    mkdir -p "$tmp/parent/subprojects/rheolog"
    ln -s "$source/$part" "$tmp/parent/subprojects/rheolog/$part"
done
cp "$source/tests/installed_program.c" "$source/tests/example_scene.c" "$tmp/parent"
# As docs/install.md shows.
cat >"$tmp/parent/meson.build" <<END
project('parent', 'c')
rheolog = dependency('rheolog$ending', fallback: 'rheolog', default_options: ['real=$real', 'lanes=scalar', 'json=$json'])
program = executable('own', 'installed_program.c', dependencies: rheolog, install: true)
test('own', program)
if '$json' == 'enabled'
  scenes = dependency('rheolog-scene-json$ending', fallback: 'rheolog')
  executable('own_scene', 'example_scene.c', dependencies: scenes)
endif
END
CC=$* meson setup "$tmp/debug" "$tmp/parent" --wrap-mode nodownload >"$tmp/said" 2>&1 || fail "a debug build is not configured"
tests=$(meson introspect --tests "$tmp/debug" | grep -o '"name": "[^"]*"' | tr '\n' ' ')
[ "$tests" = '"name": "own" ' ] || fail "the parent's tests are $tests"
grep '"command"' "$tmp/debug/compile_commands.json" >"$tmp/commands"
grep 'gravity\.c' "$tmp/commands" | grep -q -e ' -O3 ' || fail "a debug build of the parent does not optimise rheolog"
grep -e '-c .*installed_program\.c' "$tmp/commands" | grep -q -e ' -O0 ' || fail "the parent's own files are optimised"
own=$(grep -e '-c .*installed_program\.c' "$tmp/commands" | grep -o -e ' "\?-I[^ ]*' | sed -n 's/"$//; s/.*rheolog\///p' | sort -u)
[ "$own" = include ] || fail "the parent searches for headers in: $own"

# A build without debugging takes less time here.
CC=$* meson setup "$tmp/build" "$tmp/parent" --wrap-mode nodownload -Doptimization=1 --prefix /usr >"$tmp/said" 2>&1 ||
    fail "the parent is not configured"
ninja -C "$tmp/build" >"$tmp/said" 2>&1 || fail "the parent is not built"
built=$(cd "$tmp/build/subprojects/rheolog" && find . -maxdepth 1 -type f ! -name '*.a' | tr '\n' ' ')
[ -z "$built" ] || fail "the parent also builds $built"
meson install -C "$tmp/build" --destdir "$tmp/root" >"$tmp/said" 2>&1 || fail "the parent is not installed"
rm "$tmp/said"
installed=$(cd "$tmp/root" && find . -type f)
[ "$installed" = ./usr/bin/own ] || fail "the parent installs $installed"
hash_of() {
    "$rheolog" run "$@" --quiet --json | sed -n 's/.*"hash": "\([0-9a-f]*\)".*/\1/p'
}
[ "$("$tmp/build/own" | sed 's/.* //')" = "$(hash_of bowling-ball-small --set particles=300 --steps 3)" ] ||
    fail "the parent's program comes to another state"
if [ "$json" = enabled ]; then
    "$rheolog" run vibration --set particles=300 --write-scene >"$tmp/scene.json"
    [ "$("$tmp/build/own_scene" "$tmp/scene.json" 5)" = "$(hash_of "$tmp/scene.json" --steps 5)" ] ||
        fail "the parent's program reads another scene"
fi
echo "subproject: used, and nothing else built, tested or installed"
