#!/bin/sh
# What the libraries define and use: everything exported starts with rheo_ and a letter (rheo__ is private), and the code that feeds the state uses nothing
# from outside but what is listed here. Of libm that is the square root, whose bits alone are the same everywhere; of
# libc, nothing whose result depends on more than its arguments, but for memory, the clock (times of stages) and the decimal
# point (text.c takes it out again; strtod and printf of the digits used there are exact). Includes the proof that the
# check fails when it should.
#
#   symbols.sh STATE_ARCHIVE SHARED_LIBRARY COMPILER...
set -eu
archive=$1 library=$2
shift 2
allowed='sqrtf?|malloc|free|(mem(cpy|move|set|cmp)|bcmp)|str(len|n?cmp|chr|str|c?spn)|v?snprintf|strtod|localeconv|clock_gettime'
# The same with _FORTIFY_SOURCE, and failing.
allowed="$allowed|__(mem(cpy|move|set)|v?snprintf)_chk|__stack_chk_(fail|guard)(_local)?|__assert_fail|abort"
# Helpers of compilers: integer operations and conversions without an instruction, calls, processor detection.
allowed="$allowed|__(u?(div|mod|divmod)|mul|ash[lr]|lshr|cmp|ucmp|neg|popcount|clz|ctz|ffs|bswap)[sdt]i[234]?"
allowed="$allowed|__(fix(uns)?[sd]f[sd]i|float(un)?[sd]i[sd]f)"
allowed="$allowed|__aeabi_(u?(id|ld)iv(mod)?|u?l2[df]|[df]2u?lz|lmul|llsl|llsr|lasr|u?lcmp|mem(cpy|move|set|clr)[48]?|unwind_cpp_pr[012])"
allowed="$allowed|_GLOBAL_OFFSET_TABLE_|\.TOC\.|__tls_get_addr|___tls_get_addr|__cpu_(model|features2|indicator_init)|_(save|rest)[gf]pr_[0-9]+.*"
# Additions of checking and measuring builds.
allowed="$allowed|__(asan|ubsan|msan|tsan|hwasan|sanitizer|sancov|gcov|llvm_(prof|gcov)[a-z]*)_.*|__start___sancov_.*|__stop___sancov_.*|_?mcount|__fentry__"

# The objects of a build with link-time optimisation are read by the compiler's own nm only.
reader=
for nm in nm gcc-nm llvm-nm $(ls /usr/bin/llvm-nm-* 2>/dev/null || true); do
    if command -v "$nm" >/dev/null && "$nm" "$archive" 2>/dev/null | grep -q ' T rheo_world_step$'; then
        reader=$nm
        break
    fi
done
[ -n "$reader" ] || { echo "no nm here reads $archive"; exit 1; }
# Prints the symbols that are used, defined in none of the objects, and not allowed.
strangers() {
    { "$reader" "$1" | sed -n 's/^[0-9a-f]* *[A-TV-Zi] //p' | sort -u | sed 's/^/defined /'; "$reader" -u "$1" | sed -n 's/^ *[Uwv] //p'; } |
        sed 's/@.*//' | awk '$1 == "defined" { own[$2] = 1; next } !($1 in own)' | sort -u | grep -vxE "$allowed" || true
}
found=$(strangers "$archive")
[ -z "$found" ] || { echo "the state's code uses what it must not:"; echo "$found"; exit 1; }
foreign=$(nm -D --defined-only "$library" | awk '{ print $NF }' | grep -vE '^rheo_[a-z0-9]|^_(init|fini)$|^__(asan|ubsan|odr_asan|start|stop)' || true)
[ -z "$foreign" ] || { echo "exported, but not as rheo_ and a letter:"; echo "$foreign"; exit 1; }
nm -D --defined-only "$library" | grep -q ' rheo_world_step$' || { echo "rheo_world_step is not exported"; exit 1; }
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
[ "$seen" = "expm1 floorf getenv hypot realloc rheo__of_nowhere " ] || { echo "the check does not see what it should, but: $seen"; exit 1; }
echo "symbols: as they should be"
