#!/bin/sh
# completion.sh NAME bash|zsh|fish: prints the completion of the program for a shell, from option_table.sh and completion_words.sh, so that
# nothing is written twice.
set -eu
cd "$(dirname "$0")"
name=$1 shell=$2
table=$(sh option_table.sh)
words=$(sh completion_words.sh)
function=_$(printf %s "$name" | tr - _)
tab=$(printf '\t')
commands=$(echo "$table" | sed -n "s/^command$tab\([^$tab]*\)$tab.*/\1/p")
# rows KIND COMMAND: prints the other columns of these rows of the table
rows() {
    echo "$table" | sed -n "s/^$1$tab$2$tab//p"
}
operand_of() {
    rows operand "$1"
}
quoted() { # quoted TEXT: as bash, zsh and sh read it
    printf "'%s'" "$(printf %s "$1" | sed "s/'/'\\\\''/g")"
}
. "./completion_$shell.sh"
