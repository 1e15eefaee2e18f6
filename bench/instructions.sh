#!/bin/sh
# A gate for the cost of a step that no other work on the machine can disturb: instructions a particle and step, counted
# by callgrind over 8 steps of bowling-ball-small from a checkpoint (the difference of a run of 16 steps and one of 8, so
# that reading the checkpoint does not count; 8 is how many steps the history's sums are made ahead), and over 2 steps of
# a small melting-box. Counts repeat exactly; callgrind knows no AVX-512, so the simd are those below it. CSV on standard output.
#
# They are compared with the bounds in bench/instructions.csv, 3 % above what was measured when they were blessed. Other
# compilers count otherwise: a build that the file has no line for is not compared.
#
#   bench/instructions.sh [--bless] [PROGRAM]     default: build/rheolog
#   --bless  write what is measured, and bounds above it, for this build; for a change that is meant
#
# exit codes: 0 within the bounds, or blessed; 1 above; 2 bad usage, or it cannot be measured; 77 nothing to compare with
set -eu
bless=no program=build/rheolog
for word; do
    case $word in
    --bless) bless=yes ;;
    -*)
        echo "instructions: unknown option $word; there is --bless" >&2
        exit 2
        ;;
    *) program=$word ;;
    esac
done
bounds=$(dirname "$0")/instructions.csv
command -v valgrind >/dev/null || { echo "instructions: valgrind is missing" >&2; exit 2; }
[ -x "$program" ] || { echo "instructions: there is no program $program" >&2; exit 2; }
program=$(realpath "$program")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# compare MEASURED BOUNDS: lines "scene,build,simd,instructions" against the same with ",bound". Prints them side
# by side; 1 if one is above its bound, 77 if none has any.
compare() {
    awk -F , '
        NR == FNR { if (FNR > 1) bound[$1 "," $2 "," $3] = $5; next }
        {
            key = $1 "," $2 "," $3
            if (!(key in bound)) { printf "%s,,not compared\n", $0; next }
            compared++
            above = $4 + 0 > bound[key] + 0
            bad += above
            printf "%s,%s,%s\n", $0, bound[key], above ? "ABOVE" : "within"
        }
        END { exit bad ? 1 : compared ? 0 : 77 }' "$2" "$1"
}
code() {
    "$@" >/dev/null && echo 0 || echo $?
}
# The proof that the comparison fails when it should.
printf 'scene,build,simd,instructions,bound\ns,a,x,100,103\ns,b,y,100,103\n' >"$work/bounds"
echo 's,a,x,103' >"$work/equal"
printf 's,a,x,103\ns,b,y,103.1\n' >"$work/above"
echo 't,a,x,1' >"$work/unknown"
[ "$(code compare "$work/equal" "$work/bounds") $(code compare "$work/above" "$work/bounds") $(code compare "$work/unknown" "$work/bounds")" = "0 1 77" ] ||
    { echo "instructions: the comparison does not see what it should" >&2; exit 2; }

# Everything after the version, without commas: compiler, optimisation, number type, machine.
build=$("$program" --version | sed -n '2s/^rheolog [^,]*, //p' | tr -d ',')
available=" $("$program" --version | sed -n 's/^simd: \(.*\) (in use.*/\1/p') "
fixed=
setarch -R true 2>/dev/null && fixed="setarch -R"
cd "$work"
"$program" run bowling-ball-small --steps 30 -o run.rlog --quiet >/dev/null
"$program" checkpoint run.rlog --step 30 -o bowling-ball-small.rlog >/dev/null
"$program" run melting-box --set particles=600 --steps 4 -o box.rlog --quiet >/dev/null
"$program" checkpoint box.rlog --step 4 -o melting-box.rlog >/dev/null
# count SCENE KERNELS STEPS: instructions of a whole run.
count() {
    # shellcheck disable=SC2086
    env -i PATH=/usr/bin:/bin $fixed valgrind --tool=callgrind --callgrind-out-file=/dev/null \
        "$program" run --from "$1.rlog" --steps "$3" --simd "$2" --quiet --json >json 2>log || { tail -n 20 log >&2; exit 2; }
    sed -n 's/.*Collected : *\([0-9]*\).*/\1/p' log
}
# measure SCENE STEPS: a line for each set of simd.
measure() {
    for simd in avx2 portable scalar; do
        case $available in *" $simd "*) ;; *) continue ;; esac
        few=$(count "$1" $simd "$2")
        many=$(count "$1" $simd $((2 * $2)))
        particles=$(sed -n 's/.*"particles": \([0-9]*\).*/\1/p' json)
        echo "$few $many $particles" |
            awk -v name="$1,$build,$simd" -v steps="$2" '{ printf "%s,%.1f\n", name, ($2 - $1) / (steps * $3) }'
    done
}
{
    measure bowling-ball-small 8
    measure melting-box 2
} >measured
[ -s measured ] || { echo "instructions: nothing was measured" >&2; exit 2; }
cd "$OLDPWD"

if [ $bless = yes ]; then
    { [ ! -e "$bounds" ] || sed 1d "$bounds"; } | grep -v ",$build," >"$work/others" || true
    {
        echo scene,build,simd,instructions,bound
        { cat "$work/others"; awk -F , '{ printf "%s,%.1f\n", $0, 1.03 * $4 }' "$work/measured"; } | LC_ALL=C sort
    } >"$work/new"
    cp "$work/new" "$bounds"
fi
echo scene,build,simd,instructions,bound,verdict
[ -e "$bounds" ] || echo scene,build,simd,instructions,bound >"$work/bounds"
[ ! -e "$bounds" ] || cp "$bounds" "$work/bounds"
result=0
compare "$work/measured" "$work/bounds" || result=$?
case $result in
1) echo "instructions: a step takes more instructions than it did; --bless if that is meant" >&2 ;;
77) echo "instructions: not compared, there are no bounds for $build" >&2 ;;
esac
exit $result
