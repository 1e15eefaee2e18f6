#!/bin/sh
# What the libraries define and use: everything exported starts with rheo_, and the code that feeds the state calls no
# function of libm but sqrt, whose bits alone are the same everywhere. Includes the proof that the check fails when it
# should.
#
#   symbols.sh STATE_ARCHIVE SHARED_LIBRARY COMPILER...
set -eu
archive=$1 library=$2
shift 2
math='a?(sin|cos|tan)h?|atan2|exp|exp2|expm1|log|log10|log1p|log2|logb|ilogb|pow|cbrt|hypot|erf|erfc|[lt]gamma'
math="$math|fmod|remainder|remquo|fma|fmin|fmax|fdim|[ls]?l?l?r?int|nearbyint|l?l?round|ceil|floor|trunc|frexp|ldexp|scalb|scalbl?n|modf|nextafter|nexttoward"
uses_math() {
    nm -u "$1" | awk 'NF { print $NF }' | sed 's/@.*//' | sort -u | grep -E "^($math)[fl]?$" || true
}
found=$(uses_math "$archive")
[ -z "$found" ] || { echo "the state's code calls libm:"; echo "$found"; exit 1; }
foreign=$(nm -D --defined-only "$library" | awk '{ print $NF }' | grep -vE '^rheo_|^_(init|fini)$|^__(asan|ubsan|odr_asan|start|stop)' || true)
[ -z "$foreign" ] || { echo "exported without rheo_:"; echo "$foreign"; exit 1; }
nm -D --defined-only "$library" | grep -q ' rheo_world_step$' || { echo "rheo_world_step is not exported"; exit 1; }
hidden=$(nm -D --defined-only "$library" | grep -cE ' rheo_(state_|stage_gravity|grow)' || true)
[ "$hidden" = 0 ] || { echo "private functions are exported"; exit 1; }

trap 'rm -rf "$tmp"' EXIT
tmp=$(mktemp -d)
echo 'double expm1(double), hypot(double, double); float floorf(float); volatile double x; float y;
double f(void) { return expm1(x) + hypot(x, x) + floorf(y); }' >"$tmp/a.c"
"$@" -O0 -fno-builtin -c "$tmp/a.c" -o "$tmp/a.o"
[ "$(uses_math "$tmp/a.o" | wc -l)" = 3 ] || { echo "the check does not see what it should"; exit 1; }
echo "symbols: as they should be"
