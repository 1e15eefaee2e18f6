#!/bin/sh
# help.sh SOURCE: checks that every option of a command is in its help text, and that every option in the text exists.
set -eu
cd "$1/src/cli"
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# compare COMMAND TEXT: prints the options that only one of the two has.
compare() {
    {
        grep -o '{"--[a-z-]*"' "$1.c" | grep -o -- '--[a-z-]*' || true
        printf '%s\n' --help --quiet # options.c
    } | sort >"$scratch/code"
    sed -n 's/^  \(-[a-z], \)\{0,1\}\(--[a-z-]*\).*/\2/p' "$2" | sort >"$scratch/text"
    diff "$scratch/code" "$scratch/text"
}

status=0
commands=$(sed -n 's/^CLI_COMMAND(\([a-z0-9_]*\),.*/\1/p' commands.def)
for command in $commands; do
    compare "$command" "help/$command.txt" || { echo "$command: code (<) and help (>) differ" && status=1; }
done
[ "$(echo "$commands" | wc -l)" -ge 12 ] || { echo "help.sh: too few commands found" && status=1; }

# Proves that the check notices a missing option.
grep -v -e '--steps N' help/run.txt >"$scratch/run.txt"
if compare run "$scratch/run.txt" >/dev/null; then
    echo "help.sh: does not notice a missing option" && status=1
fi
exit $status
