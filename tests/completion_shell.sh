#!/bin/sh
# completion_shell.sh SOURCE RHEOLOG zsh|fish: completes lines in this shell with the completion that completion.sh prints for it:
# commands, every option of every help text, and words, files and lists for their arguments; commands, options, scenes and parameters
# come with their meaning. Skipped without the shell.
set -eu
source=$(realpath "$1") rheolog=$(realpath "$2") shell=$3
command -v "$shell" >/dev/null || { echo "there is no $shell"; exit 77; }
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
mkdir "$scratch/bin" "$scratch/functions" "$scratch/here" "$scratch/here/folder" "$scratch/home"
ln -s "$rheolog" "$scratch/bin/rheolog"
PATH=$scratch/bin:$PATH HOME=$scratch/home LC_ALL=C.UTF-8
export PATH HOME LC_ALL
unset XDG_CONFIG_HOME XDG_DATA_HOME XDG_CONFIG_DIRS ZDOTDIR
case $shell in
zsh) file=$scratch/functions/_rheolog ;;
fish) file=$scratch/functions/rheolog.fish ;;
esac
sh "$source/src/cli/completion.sh" rheolog "$shell" >"$file"
"$shell" -n "$file"
# A name with a hyphen is none of a function.
sh "$source/src/cli/completion.sh" rheolog-double "$shell" >"$scratch/double"
"$shell" -n "$scratch/double"
cd "$scratch/here"
touch a.rlog b.rlog mine.json other.txt

# complete_lines FILE <LINES: prints LINE, a tab, a word, a tab and its meaning for each word that can complete a line. Words are
# without `--option=` in front, and without the = that may follow.
complete_lines() {
    case $shell in
    zsh)
        # shellcheck disable=SC2016
        zsh -f "$source/tests/completion.zsh" "$(dirname "$1")" | awk -F '\t' -v OFS='\t' '
            NF == 1 { line = $0; next }
            { sub(/^[^ ]* *-- /, "", $2); print line, $1, $2 }'
        ;;
    fish)
        # shellcheck disable=SC2016
        fish --no-config -c '
            source $argv[1]
            while read -l line
                for found in (complete -C $line)
                    string join \t -- $line $found
                end
            end' "$1"
        ;;
    esac | sed 's/\(\t\)--[a-z-]*=/\1/; s/=\(\t[^\t]*\)$/\1/; s/=$//'
}
options_of() { # options_of COMMAND: prints those of its help text with two hyphens
    sed -n '/^options:/,/^$/s/^  \(-.*\)/\1/p' "$source/src/cli/help/$(echo "$1" | tr - _).txt" | sed 's/   .*//' | tr -s ', ' '\n' |
        grep '^--' | sort | tr '\n' ' '
}
commands=$(sed -n 's/^CLI_COMMAND(\([a-z0-9_]*\),.*/\1/p' "$source/src/cli/commands.def" | tr _ -)
scenes=$("$rheolog" scenes | sed 's/ .*//')

# Each line ends at the sign |, and the words behind it are those that are expected, in order.
{
    echo "rheolog |$(printf '%s\nhelp\n' "$commands" | sort | tr '\n' ' ')"
    for command in $commands; do
        echo "rheolog $command --|$(options_of "$command")"
    done
    for command in run check; do
        echo "rheolog $command |$(printf '%s\nfolder\nmine.json\n' "$scenes" | sort | tr '\n' ' ')"
    done
    for command in verify diff bless doctor info log inspect when track debug checkpoint metrics table export render rerecord same; do
        echo "rheolog $command |a.rlog b.rlog folder "
    done
    for simd in $("$rheolog" --version | sed -n 's/^simd: \(.*\) (.*/\1/p'); do
        echo "rheolog run --simd $simd|$simd "
    done
    cat <<'LIST'
rheolog met|metrics 
rheolog help why|why why-not 
rheolog --version --js|--json 
rheolog run --unt|--until-unhealthy 
rheolog run bowling-ball --unt|--until-unhealthy 
rheolog check --json bowling-ball-s|bowling-ball-si bowling-ball-small 
rheolog run --set fluid.s|fluid.spacing fluid.stiffness fluid.support 
rheolog run --set=fluid.s|fluid.spacing fluid.stiffness fluid.support 
rheolog run --set history.kind=|history.kind=full history.kind=tempered history.kind=window history.kind=window-fast 
rheolog run --set history.kind=window-|history.kind=window-fast 
rheolog run --set=history.kind=window-|history.kind=window-fast 
rheolog run --set fluid.support=|
rheolog run drop-pair --set materials.cornstarch.springs.s|materials.cornstarch.springs.stiffness 
rheolog run drop --steps |
rheolog run -o a|a.rlog 
rheolog run --output=a|a.rlog 
rheolog run --from |a.rlog b.rlog folder 
rheolog export a.rlog -o |folder 
rheolog export a.rlog --from |
rheolog export a.rlog --format |csv obj ply pov solids springs surface vtp 
rheolog export a.rlog --format vtp,csv,so|vtp,csv,solids 
rheolog render a.rlog --color sp|speed 
rheolog render b.rlog --compare |a.rlog b.rlog folder 
rheolog verify --junit |a.rlog b.rlog folder mine.json other.txt 
rheolog metrics a.rlog --columns step,time,hot_h|step,time,hot_height 
rheolog metrics a.rlog --columns max_spr|max_spring_displacement max_spring_displacement_id 
rheolog table a.rlog --set-columns ch|changed 
rheolog table a.rlog --set-columns scene,see|scene,seed 
rheolog inspect a.rlog --stage spr|spring_displacement springs 
rheolog curves |impact steady weights 
rheolog curves weights --kind tempered,w|tempered,window tempered,window-fast 
rheolog curves weights --weights |l1 paper 
rheolog experiments drop|drop drop-pair 
rheolog rheometer cha|chair 
rheolog rheometer a|a.rlog 
rheolog same a.rlog --at-least st|statistics step 
rheolog bench ta|table1 table2 
rheolog bench scenes --scenes drop,drop-|drop,drop-pair 
rheolog bench error --study h|heat history 
rheolog bench error --model m|melting 
rheolog bench table1 --scheme s|sequential summed 
rheolog bench stability --solvers p|passive positions 
LIST
} >"$scratch/wanted"
# differences FILE: prints the lines that this completion completes otherwise
differences() {
    sed 's/|.*//' "$scratch/wanted" | complete_lines "$1" >"$scratch/found"
    while IFS='|' read -r line expected; do
        found=$(awk -F '\t' -v line="$line" '$1 == line { sub(/\/$/, "", $2); print $2 }' "$scratch/found" | sort -u | tr '\n' ' ')
        [ "$found" = "$expected" ] || echo "$line is completed to: $found; instead of: $expected"
    done <"$scratch/wanted"
}
different=$(differences "$file")
[ -z "$different" ] || { echo "$different"; exit 1; }
bare=$(awk -F '\t' '($1 == "rheolog " || $1 ~ /(--|run|fluid\.s)$/ && $2 !~ /^(mine|folder)/) && $3 == ""' "$scratch/found")
[ -z "$bare" ] || { echo "without a meaning: $bare"; exit 1; }
grep -q 'rheolog run --	--force	replace the file of -o if it exists$' "$scratch/found" || { echo "another meaning of --force"; exit 1; }

# Proves that the check notices a missing option.
echo "completion of $shell: $(wc -l <"$scratch/wanted") lines"
sed -i '/^rheolog run --|/!d' "$scratch/wanted"
mkdir "$scratch/damaged"
sed '/replace the file of -o/d' "$file" >"$scratch/damaged/$(basename "$file")"
differences "$scratch/damaged/$(basename "$file")" | grep -q '^rheolog run -- is completed' ||
    { echo "completion_shell.sh does not notice a missing option"; exit 1; }
