#!/bin/sh
# Installs this build and one for the other number type into one folder, and uses both as a user does, with pkg-config: each
# has its own headers, libraries and program, one process can use both, and every mixture of the two is refused. A program that
# reads a scene file comes to the same state as `rheolog run`.
#
#   installed.sh SOURCE BUILD PREFIX REAL JSON COMPILER...
set -eu
source=$1 build=$2 prefix=$3 real=$4 json=$5
shift 5
unset DESTDIR LD_LIBRARY_PATH PKG_CONFIG_SYSROOT_DIR
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
fail() {
    echo "$1"
    [ ! -e "$tmp/said" ] || cat "$tmp/said"
    exit 1
}
differ() { # differ FILE FILE: both can be read, and they are not the same
    status=0
    cmp -s "$1" "$2" || status=$?
    [ $status = 1 ]
}
other=double
[ "$real" = float ] || other=float

# The other build is as small as it can be: scalar loops, not optimised, no tests.
CC=$* meson setup "$tmp/build" "$source" --prefix "$prefix" -Dreal=$other -Dlanes=scalar -Doptimization=0 -Dtests=disabled \
    -Djson=$json >"$tmp/said" 2>&1 || fail "there is no build for $other"
ninja -C "$tmp/build" >"$tmp/said" 2>&1 || fail "the build for $other fails"
for folder in "$build" "$tmp/build"; do
    meson install -C "$folder" --no-rebuild --destdir "$tmp/root" >"$tmp/said" 2>&1 || fail "$folder is not installed"
done
rm "$tmp/said"
root=$tmp/root$prefix
PKG_CONFIG_PATH=$(dirname "$(find "$root" -name rheolog.pc)")
export PKG_CONFIG_PATH
libraries=$(dirname "$PKG_CONFIG_PATH")
package() { # package ARGUMENTS: what pkg-config says of the packages below $root
    pkg-config --define-variable=prefix="$root" "$@"
}

# ---- Each alone ----

# make NAME PACKAGE FLAGS...: compiles and links the program
compiler=$*
make() {
    name=$1 of=$2
    shift 2
    # shellcheck disable=SC2046,SC2086
    $compiler "$@" $(package --cflags $of) "$source/tests/installed_program.c" -o "$tmp/$name" $(package --libs $of)
}
for type in float double; do
    ending=
    [ $type = float ] || ending=-double
    [ "$(package --variable=real rheolog$ending)" = $type ] || fail "rheolog$ending.pc does not say real=$type"
    for file in "man1/rheolog$ending.1" "bash-completion/completions/rheolog$ending" "zsh/site-functions/_rheolog$ending" \
        "fish/vendor_completions.d/rheolog$ending.fish"; do
        [ -n "$(find "$root" -path "*/$file" -size +1k)" ] || fail "$file is not installed"
    done
    make $type rheolog$ending -std=c17 -Wall -Wextra -Werror
    LD_LIBRARY_PATH=$libraries "$tmp/$type" >"$tmp/$type.out"
    hash=$("$root/bin/rheolog$ending" run bowling-ball-small --set particles=300 --steps 3 --quiet --json |
        sed -n 's/.*"hash": "\([0-9a-f]*\)".*/\1/p')
    size=4
    [ $type = float ] || size=8
    [ "$(cat "$tmp/$type.out")" = "$size bytes $hash" ] ||
        fail "the program for $type prints $(cat "$tmp/$type.out"), and rheolog$ending the hash $hash"
done
differ "$tmp/float.out" "$tmp/double.out" || fail "both number types have the same results"

# ---- Python ----

# Both builds install the same module, and each library makes a step that a recording of its number type does not store.
modules=$(find "$root" -name rheolog.py)
if [ -n "$modules" ] && (. "$source/tests/numpy.sh") >"$tmp/said"; then
    [ "$(echo "$modules" | wc -l)" = 1 ] || fail "rheolog.py is installed more than once: $modules"
    cmp "$modules" "$source/src/python/rheolog.py" || fail "another rheolog.py is installed"
    . "$source/tests/numpy.sh"
    for type in float double; do
        ending=
        [ $type = float ] || ending=-double
        "$root/bin/rheolog$ending" run bowling-ball-small --set particles=300 --steps 3 --quiet -o "$tmp/$type.rlog" >"$tmp/said"
        hash=$(cd "$tmp" && PYTHONPATH=$(dirname "$modules") LD_LIBRARY_PATH=$libraries "$python" -c '
import sys
import rheolog
print(rheolog.__file__, rheolog.open(sys.argv[1])[3].hash())' "$tmp/$type.rlog")
        [ "$hash" = "$modules $(sed -n 's/^hash *//p' "$tmp/said")" ] || fail "rheolog.py has another state of $type: $hash"
    done
fi

# ---- Scene files ----

if [ "$json" = enabled ]; then
    "$root/bin/rheolog" run vibration --set particles=300 --set history.order=0.3 --write-scene >"$tmp/scene.json"
    for type in float double; do
        ending=
        [ $type = float ] || ending=-double
        # shellcheck disable=SC2046
        "$@" -std=c17 $(package --cflags rheolog-scene-json$ending) "$source/tests/example_scene.c" -o "$tmp/scene-$type" \
            $(package --libs rheolog-scene-json$ending)
        "$root/bin/rheolog$ending" run "$tmp/scene.json" --steps 5 --quiet --json |
            sed -n 's/.*"hash": "\([0-9a-f]*\)".*/\1/p' >"$tmp/expected"
        LD_LIBRARY_PATH=$libraries "$tmp/scene-$type" "$tmp/scene.json" 5 | cmp - "$tmp/expected" ||
            fail "the scene file leads to another state in the program for $type"
        LD_LIBRARY_PATH=$libraries "$tmp/scene-$type" "$tmp/scene.json" 4 >"$tmp/shorter"
        differ "$tmp/shorter" "$tmp/expected" || fail "the comparison does not notice a missing step"
        names=$(nm -D --defined-only "$libraries/librheolog-scene-json$ending.so" | awk '{ print $NF }' | sort | tr '\n' ' ')
        [ "$(echo "$names" | sed 's/_double//g; s/rheo_scene_//g')" = "from_json read_json to_json write_json " ] ||
            fail "librheolog-scene-json$ending exports $names"
    done
    # Only this library needs jansson.
    package --libs --static rheolog-scene-json | grep -q jansson || fail "rheolog-scene-json.pc does not name jansson"
    needs=$(package --libs --static rheolog && readelf -d "$libraries/librheolog.so")
    case $needs in
    *jansson*) fail "librheolog needs jansson: $needs" ;;
    *-lrheolog*NEEDED*) ;;
    *) fail "what librheolog needs cannot be read: $needs" ;;
    esac
elif [ -e "$root/include/rheolog/scene_json.h" ] || [ -n "$(find "$root" -name '*scene-json*')" ]; then
    fail "a build without JSON installs parts of the library for scene files"
fi

# ---- CMake ----

# The packages are found where they are, which is not the prefix of the build. A program in C, and one in C++
# if there is a compiler, use each number type.
if command -v cmake >/dev/null; then
    mkdir "$tmp/cmake"
    sources="program.c cpp.cc" languages="C CXX"
    if ! command -v c++ && ! command -v clang++; then
        sources=program.c languages=C
    fi >/dev/null
    # cmake_finds LINES...: configures a project with these lines
    cmake_finds() {
        rm -rf "$tmp/cmake/build"
        { printf 'cmake_minimum_required(VERSION 3.18)\nproject(program %s)\n' "$languages" && printf '%s\n' "$@"; } >"$tmp/cmake/CMakeLists.txt"
        cmake -G Ninja -S "$tmp/cmake" -B "$tmp/cmake/build" -DCMAKE_PREFIX_PATH="$root" >"$tmp/said" 2>&1
    }
    cp "$source/tests/installed_program.c" "$tmp/cmake/program.c"
    cp "$source/tests/installed_program.c" "$tmp/cmake/cpp.cc"
    # These lines are those of docs/install.md.
    lines=$(sed -n '/^```cmake$/,/^```$/p' "$source/docs/install.md" | grep -v '^```')
    cmake_finds "$lines" 'find_package(rheolog-double REQUIRED)' "foreach(name $sources)" \
        'add_executable(${name}-float ${name})' 'target_link_libraries(${name}-float PRIVATE rheolog::rheolog)' \
        'add_executable(${name}-double ${name})' 'target_link_libraries(${name}-double PRIVATE rheolog::rheolog-double)' 'endforeach()' &&
        cmake --build "$tmp/cmake/build" >"$tmp/said" 2>&1 || fail "CMake does not build a program with rheolog"
    "$tmp/cmake/build/program" | cmp - "$tmp/float.out" || fail "the program of docs/install.md has other results"
    for name in $sources; do
        for type in float double; do
            "$tmp/cmake/build/$name-$type" | cmp - "$tmp/$type.out" || fail "$name for $type has other results with CMake"
        done
    done
    if [ "$json" = enabled ]; then
        cp "$source/tests/example_scene.c" "$tmp/cmake/scene.c"
        cmake_finds 'find_package(rheolog 0 REQUIRED COMPONENTS scene-json)' 'add_executable(scene scene.c)' \
            'target_link_libraries(scene PRIVATE rheolog::rheolog-scene-json)' && cmake --build "$tmp/cmake/build" >"$tmp/said" 2>&1 ||
            fail "CMake does not build a program that reads scene files"
        "$tmp/cmake/build/scene" "$tmp/scene.json" 5 >"$tmp/scene.out"
        LD_LIBRARY_PATH=$libraries "$tmp/scene-float" "$tmp/scene.json" 5 | cmp - "$tmp/scene.out" ||
            fail "the program of CMake reads another scene"
    elif cmake_finds 'find_package(rheolog REQUIRED COMPONENTS scene-json)' || ! grep -q 'has no component scene-json' "$tmp/said"; then
        fail "CMake finds scene files in a build without them"
    fi
    version=$(sed -n "s/^  version: '\(.*\)',$/\1/p" "$source/meson.build")
    major=${version%%.*} minor=${version#*.}
    minor=${minor%%.*}
    older=
    [ "$minor" = 0 ] || older=$major.$((minor - 1))
    for wanted in $older "$major.$((minor + 1))" $((major + 1)) "$version EXACT" "$major.$minor"; do
        met=0
        cmake_finds "find_package(rheolog $wanted REQUIRED)" || met=$?
        case $wanted in
        *EXACT | "$major.$minor") [ $met = 0 ] || fail "CMake does not find version $wanted" ;;
        *) [ $met != 0 ] && grep -qF "version: $version" "$tmp/said" || fail "CMake takes version $version for version $wanted" ;;
        esac
    done
    rm "$tmp/said"
fi

# ---- Both in one process ----

echo 'int run_float(void), run_double(void); int main(void) { return run_float() || run_double(); }' >"$tmp/both.c"
# shellcheck disable=SC2046
for type in float double; do
    ending=
    [ $type = float ] || ending=-double
    "$@" -DENTRY=run_$type $(package --cflags rheolog$ending) -c "$source/tests/installed_program.c" -o "$tmp/$type.o"
done
# shellcheck disable=SC2046
"$@" "$tmp/both.c" "$tmp/float.o" "$tmp/double.o" -o "$tmp/both" $(package --libs rheolog rheolog-double)
LD_LIBRARY_PATH=$libraries "$tmp/both" >"$tmp/both.out"
cat "$tmp/float.out" "$tmp/double.out" | cmp - "$tmp/both.out" || fail "in one process, the two libraries disturb each other"

# ---- Mixtures ----

# refused WHAT WORDS COMMAND...: the command must fail, say these words and print no result
refused() {
    what=$1 words=$2
    shift 2
    ! "$@" >"$tmp/said" 2>&1 || fail "$what is not refused"
    grep -q "$words" "$tmp/said" && ! grep -q '^[48] bytes' "$tmp/said" || fail "$what is refused in other words than \"$words\":"
    rm "$tmp/said"
}
# shellcheck disable=SC2046
refused "an object for float with the library for double" 'rheo_world_step[^_]' \
    "$@" -DENTRY=main "$source/tests/installed_program.c" $(package --cflags rheolog) \
    -o "$tmp/mixed" $(package --libs rheolog-double)
# shellcheck disable=SC2046
refused "an object for double with the library for float" 'rheo_world_step_double' \
    "$@" -DENTRY=main "$source/tests/installed_program.c" $(package --cflags rheolog-double) \
    -o "$tmp/mixed" $(package --libs rheolog)
# shellcheck disable=SC2046
refused "a program with both static libraries" 'multiple definition\|duplicate symbol' \
    "$@" "$tmp/both.c" "$tmp/float.o" "$tmp/double.o" "$libraries/librheolog.a" "$libraries/librheolog-double.a" \
    $(package --libs --static zlib) -lm -o "$tmp/mixed"
# A library that has the file name of the other one, as after a wrong copy or in a wrong LD_LIBRARY_PATH.
mkdir "$tmp/swapped"
cp "$libraries/librheolog-double.so.0" "$tmp/swapped/librheolog.so.0"
cp "$libraries/librheolog.so.0" "$tmp/swapped/librheolog-double.so.0"
refused "a program for float that finds the library for double" 'undefined symbol: rheo_[a-z_]*\|rheo_[a-z_]*: symbol not found' \
    env LD_LIBRARY_PATH="$tmp/swapped" "$tmp/float"
refused "a program for double that finds the library for float" 'rheo_[a-z_]*_double' \
    env LD_LIBRARY_PATH="$tmp/swapped" "$tmp/double"
mkdir "$tmp/alone"
cp "$libraries/librheolog-double.so.0" "$tmp/alone"
refused "a program for float where only the library for double is" 'librheolog\.so\.0' env LD_LIBRARY_PATH="$tmp/alone" "$tmp/float"
echo "installed: float and double stand side by side, and do not mix"
