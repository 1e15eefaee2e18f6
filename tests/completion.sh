#!/bin/sh
# completion.sh SOURCE RHEOLOG: makes the completion for bash and completes words with it: commands, every option of every help
# text, scenes, parameters and files. Skipped without bash.
set -eu
source=$(realpath "$1") rheolog=$(realpath "$2")
command -v bash >/dev/null || { echo "there is no bash"; exit 77; }
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
sh "$source/src/cli/completion.sh" rheolog bash >"$scratch/rheolog"
cd "$scratch"
mkdir folder
touch a.rlog b.rlog mine.json other.txt

# completions WORDS...: prints how the last word can be completed, one possibility a line. COMPREPLY is filled as bash does it, but for
# `compopt`, which works only while one types.
completions() {
    bash -c '
        file=$1 program=$2
        shift 2
        complete() { registered=$*; }
        compopt() { :; }
        . "$file"
        [[ $registered == "-F _rheolog rheolog" ]] || { echo "registered: $registered"; exit; }
        COMP_WORDS=(rheolog "$@")
        COMP_CWORD=$#
        _rheolog "$program" "${COMP_WORDS[COMP_CWORD]}" "${COMP_WORDS[COMP_CWORD - 1]}"
        [[ ${#COMPREPLY[@]} == 0 ]] || printf "%s\n" "${COMPREPLY[@]}"' bash "${file:-./rheolog}" "$rheolog" "$@" | sort
}
expect() { # expect POSSIBILITIES WORDS...: one a line, in order
    wanted=$1
    shift
    found=$(completions "$@")
    [ "$found" = "$wanted" ] || { echo "rheolog $*: completed to: $found; instead of: $wanted"; exit 1; }
}
options_of() { # options_of COMMAND: prints those of its help text, long and short
    sed -n '/^options:/,/^$/s/^  \(-.*\)/\1/p' "$source/src/cli/help/$(echo "$1" | tr - _).txt" | sed 's/   .*//' | tr -s ', ' '\n' | grep '^-' | sort
}

commands=$(sed -n 's/^CLI_COMMAND(\([a-z0-9_]*\),.*/\1/p' "$source/src/cli/commands.def" | tr _ -)
expect "$(printf '%s\nhelp\n' "$commands" | sort)" ""
expect "$(printf '%s\nhelp\n' "$commands" | sort)" help ""
expect "metrics" met
expect "--json" --version --
for command in $commands; do
    expect "$(options_of "$command")" "$command" -
done
[ "$(options_of run | wc -l)" -ge 15 ] || { echo "completion.sh finds too few options in run.txt"; exit 1; }
expect "--until-unhealthy" run bowling-ball --unt
scenes=$("$rheolog" scenes | sed 's/ .*//')
for command in run check; do
    expect "$(printf '%s\nfolder\nmine.json\n' "$scenes" | sort)" "$command" ""
    expect "bowling-ball
bowling-ball-long
bowling-ball-si
bowling-ball-small
bowling-balls" "$command" --json bow
done
expect "fluid.spacing=
fluid.stiffness=
fluid.support=" run bowling-ball --set fluid.s
expect "" run bowling-ball --steps ""
expect "" run bowling-ball --set fluid.support = 4
# Regression: these had no values.
expect "full
tempered
window
window-fast" run bowling-ball --set history.kind =
expect "window
window-fast" run bowling-ball --set history.kind = w
expect "materials.cornstarch.springs.plasticity=
materials.cornstarch.springs.stiffness=
materials.cornstarch.springs.yield_ratio=" run drop-pair --set materials.cornstarch.s
expect "" run drop --set materials.
expect "drop
drop-pair" experiments --small dr
expect "$("$rheolog" experiments --list | sed 's/ .*//' | sort)" experiments ""
expect "full
tempered
window
window-fast" curves weights --kind ""
expect "tempered,window
tempered,window-fast" curves weights --kind tempered,w
expect "l1
paper" curves weights --weights ""
for scene in drop melting-drop; do # the command says which colours there are, where it draws
    "$rheolog" run "$scene" --set particles=100 --steps 1 -o colours.rlog --quiet >/dev/null 2>&1
    for colour in $("$rheolog" render colours.rlog -o colours.png --color hue 2>&1 | sed -n 's/.* there are: //p' | tr -d ,); do
        completions render colours.rlog --color "$colour" | grep -qx "$colour" || { echo "no colour: $colour"; exit 1; }
    done
    rm colours.rlog
done
expect "shear_rate
speed
start_position
stiffness
summed_density" render a.rlog --color s
# Regression: these options had no values. A list is completed after its last comma.
expect "$(printf 'csv\nobj\nply\npov\nsolids\nsprings\nsurface\nvtp')" export a.rlog --format ""
expect "vtp,csv,solids
vtp,csv,springs
vtp,csv,surface" export a.rlog --format vtp,csv,s
for format in $(completions export --format ""); do # and the command knows each of them
    "$rheolog" export none.rlog -o out --format "$format" 2>&1 | grep -q "cannot read none.rlog" || { echo "no format: $format"; exit 1; }
done
expect "max_spring_displacement
max_spring_displacement_id" metrics a.rlog --columns max_spr
expect "step,time,hot_height" metrics a.rlog --columns step,time,hot_h
expect "step,time,hot_height" table a.rlog --metrics step,time,hot_h
expect "changed" table a.rlog --set-columns ch
expect "scene,seed" table a.rlog --set-columns scene,see
[ "$(completions metrics --columns "")" = "$("$rheolog" metrics --list | sed -n 's/^\([a-z][a-z_0-9]*\)  .*/\1/p' | sort -u)" ]
expect "spring_displacement
springs" inspect a.rlog --stage spr
for model in thickening melting; do
    for stage in $(sed -n 's/.*STAGE("\([a-z_0-9]*\)".*/\1/p' "$source/src/$model/stages.def"); do
        completions inspect a.rlog --stage "$stage" | grep -qx "$stage" || { echo "no stage: $stage"; exit 1; }
    done
done
for simd in $("$rheolog" --version | sed -n 's/^simd: \(.*\) (.*/\1/p'); do
    expect "$simd" run --simd "$simd"
done
for command in verify diff bless doctor info log inspect when track debug checkpoint metrics table export render rerecord same; do
    expect "a.rlog
b.rlog
folder" "$command" ""
done
for option in -o --output --from; do
    expect "a.rlog" run "$option" a
done
expect "folder" export a.rlog -o f
expect "folder" render a.rlog -o f
expect "a.rlog" render b.rlog --compare a
expect "" export a.rlog --from "" # here it is a step
expect "table1
table2" bench ta

# Proves that the check notices a missing option.
sed 's/ --full / /' rheolog >damaged
! (file=./damaged expect "$(options_of run)" run -) >/dev/null || { echo "completion.sh does not notice a missing option"; exit 1; }
echo "completion: commands, options, scenes, experiments, parameters, materials, kinds, colours, formats, metrics, stages and files"
