#!/bin/sh
# completion_words.sh: prints the body of a shell script PROGRAM SOURCE [WORD [SCENE]], which the completions of all shells contain. It
# prints the words that an operand or argument of this SOURCE (option_table.sh) can be, one a line, some with a tab and their meaning.
# WORD is what was typed so far. The program itself names scenes, their materials, parameters and their words, experiments, metrics
# and SIMD variants; formats, colours and others follow from tables in the sources.
set -eu
cd "$(dirname "$0")"
first_of() { # first_of FILE BEGIN: the first text of each row of a table, which ends with };
    sed -n "/$2/,/};/p" "$1" | sed -n 's/^ *{"\([a-z0-9-]*\)".*/\1/p' | tr '\n' ' '
}
formats=$(sed -n '/names\[\] = {/,/};/p' ../view/export.c | grep -o '"[a-z]*"' | tr -d '"' | tr '\n' ' ')
colours=$(sed -n 's/^ *RHEO__QUANTITY(\([a-z_]*\),.*/\1/p' ../world/query_*.c | sort -u | tr '\n' ' ')'material none'
stages=$(sed -n 's/^[A-Z_]*STAGE("\([a-z_]*\)".*/\1/p' ../*/stages.def | sort -u | tr '\n' ' ')
models=$(sed -n 's/^#define RHEO__MODELS(X) //p' ../world/model_list.h | grep -o 'X([a-z_]*)' | sed 's/X(\(.*\))/\1/' | tr '\n' ' ')
rungs=$(sed -n 's/.*NAMES\[\] = {"unknown", \(.*\)};/\1/p' ../record/same.c | tr -d '",')
studies=$(first_of bench_error.c 'STUDY\[\] = {')
solvers=$(first_of bench_stability.c 'SOLVERS\[\] = {')
for table in "$formats" "$colours" "$stages" "$models" "$rungs" "$studies" "$solvers"; do
    case $table in
    *[a-z]*' '*[a-z]*) ;;
    *) echo "completion_words.sh: a table of the sources is not found" >&2 && exit 1 ;;
    esac
done
tab=$(printf '\t') # only some versions of sed know another name for it
cat <<END
program=\$1 key= scene=\${4-}
parameters() { # the paths of all parameters, with their meaning
    "\$program" scenes --parameters 2>/dev/null | sed -n '/^[a-zA-Z_.]* = /{ s/ = .*//; N; s/\\n */$tab/; p; }'
}
choices() { # the words that a parameter can have
    "\$program" scenes --parameters "\$1" 2>/dev/null | sed -n 's/^    one of: //p' | tr ' ' '\\n'
}
case \$2 in
scene | scene_or_recording | scenes)
    "\$program" scenes 2>/dev/null | sed -n 's/^\\([^ ]*\\) *[0-9]* particles *\\(.*\\)/\\1$tab\\2/p'
    ;;
experiments) "\$program" experiments --list 2>/dev/null | sed -n 's/^\\([a-z][a-z0-9-]*\\)  *\\(.*\\)/\\1$tab\\2/p' ;;
metrics) "\$program" metrics --list 2>/dev/null | sed -n '/^[a-z][a-z_0-9]*  /{ s/ .*//; N; s/\\n */$tab/; p; }' | sort -u -t "$tab" -k 1,1 ;;
set)
    parameters | grep -v '[.]NAME[.]'
    case \$3 in
    materials*)
        for name in \$("\$program" run "\$scene" --write-scene 2>/dev/null | sed -n 's/^ *"name": "\\([^"]*\\)".*/\\1/p'); do
            parameters | sed -n "s/[.]NAME[.]/.\$name./p"
        done
        ;;
    esac
    ;;
values) choices "\$3" ;;
kind | weights) choices "history.\$2" ;;
scheme) choices scheme ;;
set_columns)
    printf '%s\\n' differing changed none scene
    parameters | grep -v '[.]NAME[.]'
    ;;
simd) "\$program" --version 2>/dev/null | sed -n 's/^simd: \\(.*\\) (.*/\\1/p' | tr ' ' '\\n' ;;
format) printf '%s\\n' $formats ;;
color) printf '%s\\n' $colours ;;
stage) printf '%s\\n' $stages ;;
model) printf '%s\\n' $models ;;
at_least) printf '%s\\n' $rungs ;;
study) printf '%s\\n' $studies ;;
solvers) printf '%s\\n' $solvers ;;
one.*) echo "\${2#one.}" | tr . '\\n' ;;
esac
END
