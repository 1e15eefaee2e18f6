#!/bin/sh
# commit_titles.sh RANGE: checks that every commit of the range has a title `area: verb ...` of at most 72 characters, and a
# body that says why. Merges are skipped. Run it on new commits, by hand or in CI:
#
#   sh tests/commit_titles.sh origin/main..HEAD
#   sh tests/commit_titles.sh --self-check      proves that the script notices bad titles
set -eu

judge() { # judge TITLE BODY: prints the fault, if there is one
    if ! echo "$1" | grep -qE '^[a-z0-9][a-zA-Z0-9_./,+ -]*: [a-z]'; then
        echo "not of the form \`area: verb ...\`: $1"
    elif [ "$(printf %s "$1" | wc -m)" -gt 72 ]; then
        echo "longer than 72 characters: $1"
    elif [ -z "$2" ]; then
        echo "no body that says why: $1"
    fi
}

if [ "${1:?usage: commit_titles.sh RANGE}" = --self-check ]; then
    [ -z "$(judge 'world: check a definition once' 'Why.')" ] || { echo "a good title is refused"; exit 1; }
    for title in 'Fix things' 'world: Check' 'world:check' "world: check $(printf '%070d' 0)"; do
        [ -n "$(judge "$title" 'Why.')" ] || { echo "not noticed: $title"; exit 1; }
    done
    [ -n "$(judge 'world: check a definition once' '')" ] || { echo "a missing body is not noticed"; exit 1; }
    echo "commit_titles: notices bad titles"
    exit
fi

faults=$(git rev-list --no-merges "$1" | while read -r commit; do
    fault=$(judge "$(git log -1 --format=%s "$commit")" "$(git log -1 --format=%b "$commit")")
    [ -z "$fault" ] || echo "$(git log -1 --format=%h "$commit") $fault"
done)
[ -z "$faults" ] || { echo "$faults"; exit 1; }
echo "commit_titles: all good"
