#!/bin/sh
# A gate for the cost of a step, independent of other load on the machine: callgrind counts instructions per particle and step.
# Scenes: 8 steps of bowling-ball-small from a checkpoint, and 2 steps of a small melting-box. The history computes its sums 8
# steps ahead. A run of twice the steps minus a run of the steps excludes reading the checkpoint. Counts repeat exactly.
# callgrind does not support AVX-512, so the SIMD variants below it are measured. Prints CSV.
#
# The counts must not exceed bench/instructions.csv, whose bounds are 3 % above the blessed counts. Counts depend on the
# compiler: a build without a line in the file is not compared.
#
#   bench/instructions.sh [--bless] [PROGRAM]     default: build/rheolog
#   --bless  write the counts and their bounds for this build, after an intended change
#
# exit codes: 0 within the bounds, or blessed; 1 above a bound; 2 bad usage, or counting failed; 77 no bounds for this build
set -eu
bless=no program=build/rheolog
for word; do
    case $word in
    --bless) bless=yes ;;
    -*)
        echo "instructions: unknown option $word; the only option is --bless" >&2
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

# compare MEASURED BOUNDS: compares lines "scene,build,simd,instructions" with lines that also have a bound. Prints them side by
# side; returns 1 if a count is above its bound, 77 if none has a bound.
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
# Proves that the comparison fails when it should.
printf 'scene,build,simd,instructions,bound\ns,a,x,100,103\ns,b,y,100,103\n' >"$work/bounds"
echo 's,a,x,103' >"$work/equal"
printf 's,a,x,103\ns,b,y,103.1\n' >"$work/above"
echo 't,a,x,1' >"$work/unknown"
[ "$(code compare "$work/equal" "$work/bounds") $(code compare "$work/above" "$work/bounds") $(code compare "$work/unknown" "$work/bounds")" = "0 1 77" ] ||
    { echo "instructions: the comparison does not notice a count above its bound" >&2; exit 2; }

# Build description after the version, without commas: compiler, optimisation, number type, machine.
build=$("$program" --version | sed -n '2s/^rheolog [^,]*, //p' | tr -d ',')
available=" $("$program" --version | sed -n 's/^simd: \(.*\) (in use.*/\1/p') "
fixed=
setarch -R true 2>/dev/null && fixed="setarch -R"
cd "$work"
"$program" run bowling-ball-small --steps 30 -o run.rlog --quiet >/dev/null
"$program" checkpoint run.rlog --step 30 -o bowling-ball-small.rlog >/dev/null
"$program" run melting-box --set particles=600 --steps 4 -o box.rlog --quiet >/dev/null
"$program" checkpoint box.rlog --step 4 -o melting-box.rlog >/dev/null
# count SCENE SIMD STEPS: prints the instructions of a whole run.
count() {
    # shellcheck disable=SC2086
    env -i PATH=/usr/bin:/bin $fixed valgrind --tool=callgrind --callgrind-out-file=/dev/null \
        "$program" run --from "$1.rlog" --steps "$3" --simd "$2" --quiet --json >json 2>log || { tail -n 20 log >&2; exit 2; }
    sed -n 's/.*Collected : *\([0-9]*\).*/\1/p' log
}
# measure SCENE STEPS: prints a line for each SIMD variant.
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
1) echo "instructions: a step takes more instructions than its bound; --bless accepts an intended change" >&2 ;;
77) echo "instructions: not compared, there are no bounds for $build" >&2 ;;
esac
exit $result
