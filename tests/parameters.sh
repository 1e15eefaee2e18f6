#!/bin/sh
# parameters.sh PROGRAM SOURCE: checks that docs/parameters.md equals the output of the program, and that the JSON schema of
# scene files has every parameter. If python3 has jsonschema, the schema must also accept the scenes and refuse bad ones.
set -eu
program=$1 source=$2
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
"$program" scenes --markdown | diff "$source/docs/parameters.md" - || {
    echo "docs/parameters.md is out of date: rheolog scenes --markdown > docs/parameters.md"
    exit 1
}
"$program" schema >"$scratch/schema.json"
"$program" scenes --parameters --json >"$scratch/parameters"
if ! command -v python3 >/dev/null; then
    echo "no python3 here: the schema is not checked"
    exit 0
fi
python3 "$source/tests/schema.py" "$program" "$scratch" "$source"/replays/scenes/*.json
