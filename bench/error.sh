#!/bin/sh
# Makes the tables of docs/error.md: runs the studies of `rheolog bench error` one after the other, keeps the points in
# bench/results/error-STUDY-MACHINE.csv, and puts their tables into the page, between the lines "<!-- error-STUDY -->" and
# "<!-- end -->".
#
#   bench/error.sh [--print | --check] [--machine NAME] [--folder FOLDER] [--page FILE] [--plots FOLDER] [PROGRAM [DOUBLE]] [STUDY...]
#   --print    measure nothing; put the tables of the results that exist into the page
#   --check    measure nothing; say whether the page has the tables of the results that exist
#   --machine  name of the results, instead of that of this machine (x86_64)
#   --folder   where the results are; default: bench/results
#   --page     default: docs/error.md
#   --plots    also write the plots of the studies into this folder
#
# PROGRAM: default build/rheolog. DOUBLE: a program with double (build option `real`), for study number, which compares the two.
# Studies: default all. Times are good only if nothing else runs on the machine.
#
# exit codes: 0 done; 1 a measurement failed, or --check found a difference; 2 bad usage
set -eu
here=$(dirname "$0")
studies="history steps spacing number sweeps springs heat channel column bunny"
what=measure machine=$(uname -m) plots= program= double= asked=
folder=$here/results page=$here/../docs/error.md
while [ $# -gt 0 ]; do
    case $1 in
    --print | --check) what=${1#--} ;;
    --machine | --folder | --page | --plots)
        [ $# -gt 1 ] || { echo "error: $1 needs a value" >&2; exit 2; }
        case $1 in
        --machine) machine=$2 ;;
        --folder) folder=$2 ;;
        --page) page=$2 ;;
        --plots) plots=$2 ;;
        esac
        shift
        ;;
    -*) echo "error: unknown option $1; there are --print, --check, --machine, --folder, --page and --plots" >&2; exit 2 ;;
    */*) if [ -z "$program" ]; then program=$1; else double=$1; fi ;;
    *)
        case " $studies " in *" $1 "*) ;; *) echo "error: there is no study $1; there are $studies" >&2; exit 2 ;; esac
        asked="$asked $1"
        ;;
    esac
    shift
done
program=${program:-build/rheolog}
if [ $what = measure ]; then
    for each in "$program" $double; do
        [ -x "$each" ] || { echo "error: there is no program $each" >&2; exit 2; }
    done
fi

# Measures a study with a program; the points follow those that the file has.
measure() { # measure PROGRAM STUDY FILE
    set -- "$1" "$2" "$3" "$(mktemp)"
    if ! "$1" bench error --study "$2" --csv ${plots:+--output "$plots"} >"$4"; then
        rm -f "$4" "$3"
        echo "error: $2 failed" >&2
        exit 1
    fi
    if [ -s "$3" ]; then sed 1d "$4" >>"$3"; else cat "$4" >"$3"; fi
    rm -f "$4"
}

# Prints the page with the tables of a study between its two marks.
with_table() { # with_table STUDY
    ERROR_TABLE=$(sh "$here/tables.sh" --print --folder "$folder" --machine "$machine" "error-$1" | sed 1,2d) LC_ALL=C awk -v study="$1" '
        $0 == "<!-- error-" study " -->" { print; print ""; print ENVIRON["ERROR_TABLE"]; print ""; inside = found = 1; next }
        $0 == "<!-- end -->" { inside = 0 }
        !inside
        END { if (!found) { print "error: the page has no place for the tables of " study > "/dev/stderr"; exit 1 } }'
}

new=$(mktemp)
trap 'rm -f "$new" "$new.next"' EXIT
cat "$page" >"$new"
number=0
for study in ${asked:-$studies}; do
    results=$folder/error-$study-$machine.csv
    number=$((number + 1))
    if [ $what = measure ]; then
        echo "error: $study ($number of $(echo ${asked:-$studies} | wc -w))" >&2
        rm -f "$results.new"
        measure "$program" "$study" "$results.new"
        if [ "$study" = number ] && [ "$double" ]; then measure "$double" "$study" "$results.new"; fi
        mv "$results.new" "$results"
    fi
    [ -s "$results" ] || { [ "$asked" ] || continue; echo "error: there are no results $results" >&2; exit 2; }
    with_table "$study" <"$new" >"$new.next"
    cat "$new.next" >"$new"
done
if [ $what = check ]; then
    diff "$page" "$new"
else
    cat "$new" >"$page"
fi
