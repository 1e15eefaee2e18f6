#!/bin/sh
# manual.sh SOURCE: makes the man page, and checks that every word of the help texts is in it, that every line fits 80 columns, and
# that groff and mandoc have nothing to warn of, as far as they are installed.
set -eu
cli=$(realpath "$1")/src/cli
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
fail() {
    echo "$1"
    exit 1
}
version=$(sed -n "s/^  version: '\(.*\)',$/\1/p" "$cli/../../meson.build")
date=$(sed -n 's/^date-released: //p' "$cli/../../CITATION.cff")
sh "$cli/manual.sh" rheolog "$version" >"$scratch/rheolog.1"
grep -qxF ".TH RHEOLOG 1 \"$date\" \"rheolog $version\" \"User Commands\"" "$scratch/rheolog.1" || fail "the page has no title, version or date"
sh "$cli/manual.sh" rheolog-double "$version" | grep -q '^rheolog\\-double \\- ' || fail "the page for double has another name"

words() { # words TEXT: one on each line; the headings of sections are in capitals
    tr -s ' ' '\n' <"$1" | tr '[:upper:]' '[:lower:]' | sed 's/:$//; /^$/d'
}
missing_from() { # missing_from PAGE: prints the words of the help texts that are missing, in the order of the texts
    sed '/^\.\\"/d; s/^\.[A-Z][A-Z]* *//; s/^\.[a-z][a-z]*.*//; s/\\&//g; s/\\-/-/g; s/\\(aq/'\''/g; s/\\(ga/`/g; s/\\(ha/^/g
        s/\\(ti/~/g; s/\\e/\\/g' "$1" >"$scratch/page.txt"
    words "$scratch/page.txt" >"$scratch/page"
    for text in "$cli"/help/*.txt; do
        # The page has headings in their place.
        sed 's/^usage: //; s/^exit codes:/exit/' "$text" >"$scratch/text.txt"
        words "$scratch/text.txt"
    done | sort >"$scratch/wanted"
    sort "$scratch/page" | comm -23 "$scratch/wanted" -
}
missing=$(missing_from "$scratch/rheolog.1")
[ -z "$missing" ] || fail "words of the help texts that the man page does not have: $missing"
for command in $(sed -n 's/^CLI_COMMAND(\([a-z0-9_]*\),.*/\1/p' "$cli/commands.def" | tr _ -); do
    grep -qi "^\.SH RHEOLOG $command\$" "$scratch/rheolog.1" || fail "the man page has no section on $command"
done

tools=
if command -v groff >/dev/null && groff -man -Tascii "$scratch/rheolog.1" >"$scratch/plain" 2>/dev/null; then
    groff -ww -man -Tascii -rLL=80n -P-cbou "$scratch/rheolog.1" >"$scratch/plain" 2>"$scratch/said"
    [ ! -s "$scratch/said" ] || fail "groff warns: $(cat "$scratch/said")"
    long=$(awk 'length > 80' "$scratch/plain")
    [ -z "$long" ] || fail "lines of more than 80 columns: $long"
    grep -q '^  -o, --output F.rlog     record the run' "$scratch/plain" || fail "groff does not print the options in columns"
    tools=" groff"
fi
if command -v mandoc >/dev/null; then
    mandoc -T lint "$scratch/rheolog.1" >"$scratch/said" || true
    [ ! -s "$scratch/said" ] || fail "mandoc warns: $(cat "$scratch/said")"
    tools="$tools mandoc"
fi

# Regression: lines of a paragraph that end with a colon became headings.
heading=$(awk '/^\.SS/ && before !~ /^\.(in|fi|nf|PP|SH)/ && before !~ /[.:;)]$/ { print before; print } { before = $0 }' "$scratch/rheolog.1")
[ -z "$heading" ] || fail "a heading in the middle of a sentence: $heading"

# Proves that the check notices a missing line.
grep -v 'until\\-unhealthy' "$scratch/rheolog.1" >"$scratch/less.1"
[ -n "$(missing_from "$scratch/less.1")" ] || fail "manual.sh does not notice a missing option"
echo "manual: complete; read by:${tools:- no tool}"
