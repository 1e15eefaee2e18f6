#!/bin/sh
# manual.sh NAME VERSION: prints the man page of the program from commands.def and the help texts, so that nothing is written twice. Its
# date is that of the version in CHANGELOG.md.
set -eu
cd "$(dirname "$0")"
name=$(printf %s "$1" | sed 's/-/\\-/g') version=$2
date=$(sed -n "s/^## $version - //p" ../../CHANGELOG.md)

# A help text has a usage, paragraphs, and sections `options:`, `examples:` and so on, in columns that must stay.
# shellcheck disable=SC2016
roff='
function plain(text) { # as roff prints it unchanged
    gsub(/\\/, "\\e", text)
    gsub(/-/, "\\-", text)
    gsub(/\047/, "\\(aq", text)
    gsub(/`/, "\\(ga", text)
    gsub(/\^/, "\\(ha", text)
    gsub(/~/, "\\(ti", text)
    if (text ~ /^[.]/)
        text = "\\&" text
    while (!inside && !usage && match(text, /[^\n]*$/) && RLENGTH > 80) { # longer lines are bad style where lines are filled
        for (at = RSTART + 80; substr(text, at, 1) != " " && at > RSTART;)
            at--
        if (at == RSTART)
            break
        text = substr(text, 1, at - 1) "\n" substr(text, at + 1)
    }
    return text
}
function block(wanted) { # columns stay inside of a block; it begins further left, so that 80 columns are enough
    if (wanted != inside)
        print wanted ? ".in -5n\n.nf" : ".fi\n.in"
    inside = wanted
}
function paragraph(text) {
    if (gap)
        print ".PP"
    gap = 0
    if (sub(/^  /, "", text))
        block(1)
    print plain(text)
}
'
{
    printf '.\\" Made by manual.sh from the help texts of the program.\n'
    printf '.TH %s 1 "%s" "rheolog %s" "User Commands"\n' "$(printf %s "$name" | tr '[:lower:]' '[:upper:]')" "$date" "$version"
    printf '.nh\n.ad l\n.SH NAME\n'
    printf '%s \\- simulate, record and verify history\\-dependent particle fluids\n' "$name"
    printf '.SH SYNOPSIS\n'
    sed -n 's/^usage: //p' help/main.txt | awk "$roff"'{ print plain($0) }'
    printf '.SH DESCRIPTION\n'
    # The commands stand where `rheolog --help` has them.
    list=$(sed -n 's/^CLI_COMMAND(\([a-z0-9_]*\), "\(.*\)")$/\1 \2/p' commands.def | sed 's/^\([a-z]*\)_/\1-/')
    awk -v list="$list" "$roff"'
        /^usage: / { skip = 1; next }
        skip && /^$/ { skip = 0; next }
        /^commands:$/ {
            block(0)
            print ".SH COMMANDS"
            n = split(list, line, "\n")
            for (i = 1; i <= n; i++) {
                space = index(line[i], " ")
                if (i == 2)
                    print ".PD 0"
                printf ".TP 14\n.B %s\n%s\n", plain(substr(line[i], 1, space - 1)), plain(substr(line[i], space + 1))
            }
            print ".PD"
            gap = 1
            next
        }
        /^$/ { block(0); gap = 1; next }
        /^[a-z][a-z ,]*:$/ { sub(/:$/, ""); print ".SH " toupper(plain($0)); gap = 0; next }
        /^exit codes:/ { sub(/^exit codes: */, ""); print ".SH EXIT STATUS"; gap = 0 }
        { paragraph($0) }
        END { block(0) }' help/main.txt
    for command in $(echo "$list" | sed 's/ .*//'); do
        awk -v command="$command" "$roff"'
            NR == 1 { printf ".SH RHEOLOG %s\n.nf\n", toupper(command) }
            NR == 1 && sub(/^usage: /, "") { usage = 1 }
            usage && /^$/ { usage = 0; print ".fi"; gap = 1; next }
            usage { sub(/^       /, ""); print plain($0); next }
            /^$/ { block(0); gap = 1; next }
            gap && /^[-a-z][-a-z ,]*:$/ { block(0); sub(/:$/, ""); print ".SS " plain($0); gap = 0; next }
            gap && /^[-a-z][-a-z ,]*:/ && /^(exit codes|--json)/ {
                block(0)
                title = $0
                sub(/:.*/, "", title)
                print ".SS " plain(title)
                sub(/^[^:]*: */, "")
                gap = 0
            }
            !/^ / { block(0) }
            { paragraph($0) }
            END { block(0) }' "help/$(echo "$command" | tr - _).txt"
    done
}
