#!/bin/sh
# tolerance.sh SOURCE RHEOLOG: the comparison of docs/ci.md with a tolerance, as printed. It accepts the same run and one of slightly
# other parameters, and refuses a larger difference and recordings with no step in common.
set -eu
source=$1 rheolog=$(realpath "$2")
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
sed -n '/^## Other builds/,/^## Keeping/p' "$source/docs/ci.md" | sed -n '/^```sh$/,/^```$/p' | grep -v '^```' >"$tmp/compare.sh"
cd "$tmp"
mkdir bin golden other
ln -s "$rheolog" bin/rheolog
PATH=$tmp/bin:$PATH
record() { # record FILE OPTIONS...
    file=$1
    shift
    rheolog run bowling-ball-small --set particles=300 --quiet --force -o "$file" "$@" >said 2>&1 || { cat said; exit 1; }
}
expect() { # expect EXIT_CODE WHAT
    code=0
    sh ./compare.sh >said 2>&1 || code=$?
    [ $code = "$1" ] && [ "$(grep -c ' of its largest value' said)" = 4 ] || { cat said; echo "exit code $code instead of $1: $2"; exit 1; }
}
record golden/drop.rlog --steps 20
cp golden/drop.rlog other
expect 0 "the same recording"
[ "$(grep -c 'at most 0.0e+00' said)" = 4 ] || { cat said; echo "the same recording differs"; exit 1; }
record other/drop.rlog --steps 20 --set fluid.linear_viscosity=4.0001
expect 0 "nearly the same viscosity"
! grep -q 'energy: at most 0.0e+00' said || { cat said; echo "another viscosity shows no difference"; exit 1; }
record other/drop.rlog --steps 20 --set 'gravity=[0, -9.5, 0]'
expect 1 "another gravity"
record other/drop.rlog --steps 11
expect 1 "a run that stopped early"
rheolog run --from golden/drop.rlog@20 --steps 0 --quiet -o late.rlog >said 2>&1
rheolog run --from late.rlog --steps 2 --quiet --force -o later.rlog >said 2>&1
rheolog run --from later.rlog@22 --steps 2 --quiet --force -o other/drop.rlog >said 2>&1
expect 1 "no step in common"
echo "tolerance: near runs pass, others do not"
