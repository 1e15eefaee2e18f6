#!/bin/sh
# Checks the symbols of the libraries. Exported names start with rheo_ and a letter (rheo__ is private); those of a library for
# double, and only those, end in _double, so that nothing can be linked with the other library by mistake. The code that feeds the
# state uses only the external functions listed here. The only one from libm is the square root, whose bits are the same
# everywhere. The results of those from libc depend on their arguments only, with three exceptions: memory (madvise gives a hint
# about it), the clock (times of stages) and the decimal point (text.c replaces it or changes the locale of the thread; strtod and
# printf are exact for the digits used there). The script also proves that it notices forbidden functions.
#
#   symbols.sh float|double STATE_ARCHIVE SHARED_LIBRARY STATIC_LIBRARY SCENE_FILE_LIBRARY COMPILER...
set -eu
real=$1 archive=$2 library=$3 static=$4 scene_files=$5
shift 5
ending=
[ "$real" = float ] || ending=_double
allowed='sqrtf?|malloc|free|(mem(cpy|move|set|cmp|chr)|bcmp)|str(len|n?cmp|chr|str|c?spn)|v?snprintf|strtod|localeconv|(new|use|free)locale|clock_gettime|madvise'
# Variants of these with _FORTIFY_SOURCE, and functions that end the program.
allowed="$allowed|__(mem(cpy|move|set)|v?snprintf)_chk|__stack_chk_(fail|guard)(_local)?|__assert_fail|abort"
# Compiler helpers: integer operations and conversions that have no instruction, calls, processor detection.
allowed="$allowed|__(u?(div|mod|divmod)|mul|ash[lr]|lshr|cmp|ucmp|neg|popcount|clz|ctz|ffs|bswap)[sdt]i[234]?"
allowed="$allowed|__(fix(uns)?[sd]f[sd]i|float(un)?[sd]i[sd]f)"
allowed="$allowed|__aeabi_(u?(id|ld)iv(mod)?|u?l2[df]|[df]2u?lz|lmul|llsl|llsr|lasr|u?lcmp|mem(cpy|move|set|clr)[48]?|unwind_cpp_pr[012])"
allowed="$allowed|_GLOBAL_OFFSET_TABLE_|\.TOC\.|__tls_get_addr|___tls_get_addr|__cpu_(model|features2|indicator_init)|_(save|rest)[gf]pr_[0-9]+.*"
# Functions of builds with sanitizers, coverage or profiling.
allowed="$allowed|__(asan|ubsan|msan|tsan|hwasan|sanitizer|sancov|gcov|llvm_(prof|gcov)[a-z]*)_.*|__start___sancov_.*|__stop___sancov_.*|_?mcount|__fentry__"

# Only the compiler's own nm reads objects of a build with link-time optimisation.
reader=
for nm in nm gcc-nm llvm-nm $(ls /usr/bin/llvm-nm-* 2>/dev/null || true); do
    if command -v "$nm" >/dev/null && "$nm" "$archive" 2>/dev/null | grep -q " T rheo_world_step$ending\$"; then
        reader=$nm
        break
    fi
done
[ -n "$reader" ] || { echo "no nm here reads $archive"; exit 1; }
# strangers ARCHIVE: prints the symbols that are used, but neither defined in the objects nor allowed.
strangers() {
    { "$reader" "$1" | sed -n 's/^[0-9a-f]* *[A-TV-Zi] //p' | sort -u | sed 's/^/defined /'; "$reader" -u "$1" | sed -n 's/^ *[Uwv] //p'; } |
        sed 's/@.*//' | awk '$1 == "defined" { own[$2] = 1; next } !($1 in own)' | sort -u | grep -vxE "$allowed" || true
}
found=$(strangers "$archive")
[ -z "$found" ] || { echo "code that feeds the state uses forbidden functions:"; echo "$found"; exit 1; }
foreign=$(nm -D --defined-only "$library" | awk '{ print $NF }' | grep -vE '^rheo_[a-z0-9]|^_(init|fini)$|^__(asan|ubsan|odr_asan|start|stop)' || true)
[ -z "$foreign" ] || { echo "exported names that do not start with rheo_ and a letter:"; echo "$foreign"; exit 1; }
nm -D --defined-only "$library" | grep -q " rheo_world_step$ending\$" || { echo "rheo_world_step$ending is not exported"; exit 1; }
# misnamed REAL: prints exported functions whose name is not that of a library with this number type.
misnamed() {
    nm -D --defined-only "$library" | sed -n 's/.* \(rheo_[a-z0-9_]*\)$/\1/p' | awk -v real="$1" '(real == "double") != /_double$/'
}
found=$(misnamed "$real")
[ -z "$found" ] || { echo "names that a library for $real must not export:"; echo "$found"; exit 1; }
other=double
[ "$real" = float ] || other=float
[ "$(misnamed $other | wc -l)" -gt 100 ] || { echo "the check does not notice the names of the other number type"; exit 1; }
# strange ARCHIVE: prints names that a program linked with the archive could have, too. Static libraries cannot hide private names.
strange() {
    "$reader" "$1" | sed -n 's/^[0-9a-f]* *[A-TV-Z] //p' | sort -u | grep -vE '^rheo__?[a-z0-9]|^__(asan|ubsan|odr_asan|start|stop)|^DW\.ref\.' || true
}
found=$(strange "$static"; strange "$scene_files")
[ -z "$found" ] || { echo "names in static libraries that do not start with rheo_:"; echo "$found"; exit 1; }
hidden=$(nm -D --defined-only "$library" | grep -cE ' rheo__' || true)
[ "$hidden" = 0 ] || { echo "private functions are exported"; exit 1; }

trap 'rm -rf "$tmp"' EXIT
tmp=$(mktemp -d)
cat >"$tmp/a.c" <<'END'
double expm1(double), hypot(double, double), sqrt(double), strtod(const char *, char **);
float floorf(float), sqrtf(float), rheo__of_nowhere(float);
char *getenv(const char *);
void *memcpy(void *, const void *, unsigned long), *realloc(void *, unsigned long);
double own(double x) { return x; }
volatile double x;
volatile float y;
double f(void) { return own(expm1(x) + hypot(x, x) + sqrt(x)) + floorf(y) + sqrtf(y) + rheo__of_nowhere(y); }
void *g(void *p) { return memcpy(realloc(p, 8), getenv("LANG"), (unsigned long)strtod(p, 0)); }
END
"$@" -O0 -w -fno-builtin -fno-lto -c "$tmp/a.c" -o "$tmp/a.o"
seen=$(reader=nm strangers "$tmp/a.o" | tr '\n' ' ')
[ "$seen" = "expm1 floorf getenv hypot realloc rheo__of_nowhere " ] || { echo "the check finds the wrong symbols: $seen"; exit 1; }
seen=$(reader=nm strange "$tmp/a.o" | tr '\n' ' ')
[ "$seen" = "f g own x y " ] || { echo "the check finds the wrong names: $seen"; exit 1; }
echo "symbols: only allowed ones"
