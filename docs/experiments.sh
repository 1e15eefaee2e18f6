#!/bin/sh
# experiments.sh RHEOLOG [--write] [COMMAND]: runs every command of docs/experiments.md and docs/rheometer.md, or only those of
# `rheolog COMMAND`, and compares what they print, and the pictures that they write, with the pages and the pictures beside them. With
# --write it replaces those. In a page, a command stands in a block ```console behind "$ rheolog", and its output follows it. Pictures
# in PNG are made by hand.
set -eu
rheolog=$(realpath "$1") write=
shift
[ "${1-}" != --write ] || { write=--write; shift; }
only=${1-}
cd "$(dirname "$0")"
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
mkdir "$tmp/experiments"
pages='experiments.md rheometer.md'

# made PAGE: prints it with new outputs.
made() {
    inside=0 output=0
    while IFS= read -r line; do
        case $inside$line in
        0'```console') inside=1 output=0 ;;
        1'```') inside=0 output=0 ;;
        1"\$ rheolog $only"*)
            output=1
            printf '%s\n' "$line"
            echo "experiments: ${line#\$ }" >&2
            # shellcheck disable=SC2086 # words
            (cd "$tmp" && "$rheolog" ${line#\$ rheolog} </dev/null >output) ||
                { cat "$tmp/output" >&2; echo "failed: ${line#\$ }" >&2; return 1; }
            cat "$tmp/output"
            continue
            ;;
        1'$ rheolog '*) output=0 ;; # the old output stays
        esac
        [ $output = 1 ] || printf '%s\n' "$line"
    done <"$1"
}
for page in $pages; do
    made "$page" >"$tmp/$page"
done

if [ "$write" = --write ]; then
    [ -n "$only" ] || rm -f experiments/*.svg
    find "$tmp/experiments" -name '*.svg' -exec cp {} experiments/ ';'
    for page in $pages; do
        cat "$tmp/$page" >"$page"
    done
    exit
fi
status=0
for page in $pages; do
    diff "$page" "$tmp/$page" || status=1
done
for picture in experiments/*; do
    # shellcheck disable=SC2086 # words
    grep -q "]($picture)" $pages || { echo "$picture is in none of $pages"; status=1; }
    [ "${picture%.png}" = "$picture" ] || continue # the bytes depend on the version of libpng
    made=$tmp/$picture
    [ -e "$made" ] || [ -n "$only" ] || { echo "nothing makes $picture"; status=1; }
    [ ! -e "$made" ] || cmp "$picture" "$made" || status=1
done
for picture in "$tmp"/experiments/*.svg; do
    [ ! -e "$picture" ] || [ -e "experiments/${picture##*/}" ] || { echo "${picture##*/} is not stored"; status=1; }
done
[ $status = 0 ] || echo "the pages in docs are not what the program prints now: sh docs/experiments.sh RHEOLOG --write"
exit $status
