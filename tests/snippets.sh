#!/bin/sh
# Compiles the C snippets of docs/library.md exactly as printed, as C17 and as C++, runs them, and proves that the tests
# among them fail without their golden recording and with a shorter one. The first snippet is a program; the others
# are put into functions behind it, as docs/library.md says.
#
#   snippets.sh SOURCE_FOLDER INCLUDE_FOLDER_OF_BUILD LIBRARY RHEOLOG CC...
set -eu
source=$1 include=$2 library=$(realpath "$3") rheolog=$(realpath "$4")
shift 4
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
count=$(awk -v out="$tmp/snippet" '
    /^```c$/ { n++; on = 1; next }
    /^```$/ { on = 0 }
    on { print >(out n) }
    END { print n + 0 }' "$source/docs/library.md")
[ "$count" -ge 4 ] || { echo "docs/library.md has only $count snippets in C"; exit 1; }
{
    printf '#define main first_main\n#include "snippet1"\n#undef main\n'
    printf '#include <setjmp.h>\n#include <stdarg.h>\n#include <stddef.h>\n#include <stdint.h>\n'
    printf '#ifdef __cplusplus\nextern "C" {\n#endif\n#include <cmocka.h>\n#ifdef __cplusplus\n}\n#endif\n'
    for i in $(seq 2 "$count"); do
        printf 'static void snippet_%s(void **state)\n{\n(void)state;\n#include "snippet%s"\n}\n' "$i" "$i"
    done
    printf 'int main(void)\n{\nconst struct CMUnitTest tests[] = {\n'
    for i in $(seq 2 "$count"); do
        printf 'cmocka_unit_test(snippet_%s),\n' "$i"
    done
    printf '};\nreturn cmocka_run_group_tests_name("snippets", tests, NULL, NULL);\n}\n'
} >"$tmp/others.c"
cp "$tmp/snippet1" "$tmp/first.c"
compile() { # compile LANGUAGE NAME COMPILER...
    language=$1 name=$2
    shift 2
    "$@" -x "$language" -Wall -Wextra -Wpedantic -Werror -I"$source/include" -I"$include" "$tmp/$name.c" -x none -o "$tmp/$name-$language" \
        "$library" -Wl,-rpath,"$(dirname "$library")" -lcmocka
}
languages=c
compile c first "$@" -std=c17
compile c others "$@" -std=c17
for cxx in c++ g++ clang++; do
    command -v "$cxx" >/dev/null || continue
    compile c++ first "$cxx" -std=c++11
    compile c++ others "$cxx" -std=c++11
    languages="c c++"
    break
done
. "$(dirname "$0")/fails.sh"
cd "$tmp"
mkdir golden
for language in $languages; do
    rm -f run.rlog golden/drop.rlog
    "./first-$language" >hash || { echo "the first snippet fails in $language"; exit 1; }
    fails "exists" "./first-$language"
    fails "golden/drop.rlog" "./others-$language"
    fails "2 FAILED" "./others-$language"
    "$rheolog" bless golden/drop.rlog run.rlog --because "the first" >said
    "./others-$language" >said 2>&1 || { cat said; exit 1; }
    grep -q "216 particles" said
    "$rheolog" run --from run.rlog@0 --steps 100 --quiet -o golden/drop.rlog.new >said
    mv -f golden/drop.rlog.new golden/drop.rlog
    fails "100 steps are the same, but at least 120" "./others-$language"
    fails "differs in length: the golden recording has steps 0 to 100, this run 0 to 101" "./others-$language"
done
echo "snippets: $count of docs/library.md compile and run in: $languages"
