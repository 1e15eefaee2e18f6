#!/bin/sh
# scenes.sh RHEOLOG [--write]: compares the tables of docs/scenes.md with those that the program prints. With --write it replaces
# them. A table stands behind the line <!-- rheolog schema --markdown KEY --> and ends with <!-- end -->.
set -eu
rheolog=$(realpath "$1")
cd "$(dirname "$0")"
made=$(mktemp)
trap 'rm -f "$made"' EXIT
old=0
while IFS= read -r line; do
    case $line in
    '<!-- end -->') old=0 ;;
    esac
    [ $old = 1 ] || printf '%s\n' "$line"
    case $line in
    '<!-- rheolog schema --markdown '*)
        command=${line#<!-- rheolog }
        # shellcheck disable=SC2086 # words
        "$rheolog" ${command% -->}
        old=1
        ;;
    esac
done <scenes.md >"$made"
if [ "${2-}" = --write ]; then
    cat "$made" >scenes.md
    exit
fi
diff scenes.md "$made" || {
    echo "docs/scenes.md is out of date: sh docs/scenes.sh RHEOLOG --write"
    exit 1
}
