#!/bin/sh
# scenes_page.sh PROGRAM SOURCE: the tables of docs/scenes.md are those of the program; each scene on the page is free of warnings, or
# has the one that the comment before it names; and the commands on the page succeed, in their order. If python3 has jsonschema, the
# schema must accept every scene, too.
set -eu
program=$(realpath "$1") source=$(realpath "$2")
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
sh "$source/docs/scenes.sh" "$program"
mkdir "$scratch/bin" "$scratch/docs"
ln -s "$program" "$scratch/bin/rheolog"
PATH=$scratch/bin:$PATH
cd "$scratch"

# Proves that a table that is out of date is found.
cp "$source/docs/scenes.sh" docs
sed 's/lowest corner/lowest edge/' "$source/docs/scenes.md" >docs/scenes.md
if sh docs/scenes.sh "$program" >said; then
    echo "docs/scenes.sh does not notice a changed table"
    exit 1
fi
sh docs/scenes.sh "$program" --write
cmp docs/scenes.md "$source/docs/scenes.md"

# N.json is scene number N, N.warning the kind of its warning.
awk '/^<!-- check: / { kind = $3 }
    /^```json$/ { n++; on = 1; print kind >(n ".warning"); kind = ""; next }
    /^```$/ { on = 0 }
    on { print >(n ".json") }' "$source/docs/scenes.md"
[ -e 20.json ] || { echo "docs/scenes.md has fewer scenes than expected"; exit 1; }
rheolog run 1.json --write-scene >said 2>&1 || {
    grep -q "without JSON" said || { cat said; exit 1; }
    echo "a build without scene files: only the tables are checked"
    exit 0
}
status=0
for scene in *.json; do
    kind=$(cat "${scene%.json}.warning")
    code=0
    rheolog check "$scene" --json --quiet >said 2>error || code=$?
    kinds=$(grep -o '"kind": *"[a-z-]*"' said | sed 's/.*"\([a-z-]*\)"/\1/' | sort -u | tr '\n' ' ')
    if [ "${kind:-none}" != "$(echo ${kinds:-none})" ] || [ $code != $([ -z "$kind" ] && echo 0 || echo 1) ]; then
        echo "this scene should have the warning ${kind:-none}, exit code $([ -z "$kind" ] && echo 0 || echo 1); it has ${kinds:-none}, $code:"
        cat "$scene" error
        status=1
    fi
done
awk '/^```console$/ { on = 1; next } /^```$/ { on = 0 } on && sub(/^\$ /, "")' "$source/docs/scenes.md" >commands
[ "$(wc -l <commands)" -ge 6 ]
if rheolog render none.rlog -o none.png 2>&1 | grep -q "without pictures"; then
    sed -i '/rheolog render/d' commands
fi
sh -ex commands >said 2>&1 || { cat said; exit 1; }
if python3 -c 'import jsonschema' 2>/dev/null; then
    python3 - <<'END' || status=1
import glob, json, jsonschema
validator = jsonschema.Draft202012Validator(json.load(open("scene.schema.json")))
for name in glob.glob("[0-9]*.json") + ["my.json"]:
    validator.validate(json.load(open(name)))
END
fi
[ $status != 0 ] || echo "scenes_page: tables, scenes and commands are right"
exit $status
