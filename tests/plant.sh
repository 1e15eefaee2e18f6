#!/bin/sh
# plant.sh PAGE NAME SOURCE: prints a source file with a fault: the lines of the block ```diff in the section NAME of docs/faults.md are
# exchanged. A line that begins with "-" must be in the source once; the line that begins with "+" replaces it.
set -eu
awk -v name="$2" '
    function slug(title) {
        title = tolower(substr(title, 5))
        gsub(/ /, "-", title)
        return title
    }
    FNR == NR && /^### / { inside = slug($0) == name; next }
    FNR == NR && /^```/ { diff = $0 == "```diff"; next }
    FNR == NR && inside && diff && /^-/ { old = substr($0, 2); next }
    FNR == NR && inside && diff && /^[+]/ { new = substr($0, 2); next }
    FNR == NR { next }
    $0 == old && old != "" { found++; print new; next }
    { print }
    END {
        if (found == 1)
            exit 0
        printf "plant: the line of the fault %s is %d times in the source: \"%s\"\n", name, found, old >"/dev/stderr"
        exit 1
    }' "$1" "$3"
