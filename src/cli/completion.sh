#!/bin/sh
# completion.sh NAME: prints the completion of the program for bash from commands.def, the help texts and the tables of formats,
# stages and quantities, so that nothing is written twice. The program itself names scenes, their materials, parameters and their
# words, experiments, metrics and SIMD variants while one types.
set -eu
cd "$(dirname "$0")"
name=$1
commands=$(sed -n 's/^CLI_COMMAND(\([a-z0-9_]*\),.*/\1/p' commands.def | tr '_\n' '- ')
function=_$(printf %s "$name" | tr - _)
formats=$(sed -n '/names\[\] = {/,/};/p' ../view/export.c | grep -o '"[a-z]*"' | tr -d '"' | tr '\n' ' ')
colours=$(sed -n 's/^ *RHEO__QUANTITY(\([a-z_]*\),.*/\1/p' ../world/query_*.c | sort -u | tr '\n' ' ')'material none'
stages=$(sed -n 's/^[A-Z_]*STAGE("\([a-z_]*\)".*/\1/p' ../*/stages.def | sort -u | tr '\n' ' ')

cat <<END
# Completion of $name for bash, made by completion.sh from the help texts of the program.
$function() {
    local word=\$2 before=\$3 command='' options='' paths='' values='' words='' files='' names='' i key=''
    COMPREPLY=()
    for ((i = 1; i < COMP_CWORD; i++)); do
        [[ \${COMP_WORDS[i]} == -* ]] || { command=\${COMP_WORDS[i]}; break; }
    done
    case \$command in
END
for command in $commands; do
    # The usage says what the operands are. The text of an option begins after two blanks; a name in front of it is its argument.
    awk -v command="$command" '
        NR == 1 { usage = 1 }
        /^$/ { usage = 0 }
        usage { used = used " " $0 }
        /^[a-z]/ { section = $0 }
        section == "options:" && /^  -/ {
            sub(/^  /, "")
            sub(/  .*/, "")
            argument = ""
            n = split($0, part, /,? /)
            if (part[n] !~ /^-/)
                argument = part[n--]
            for (i = 1; i <= n; i++) {
                options = options " " part[i]
                if (argument ~ /[.]rlog|^(FILE|DIR|PROGRAM)$/)
                    paths = paths " " part[i]
                else if (argument)
                    values = values " " part[i]
            }
        }
        END {
            names = used ~ / \[NAME\.\.\.\]/ ? "list" : ""
            files = used ~ / SCENE/ ? "json" : used ~ /[.]rlog/ ? "rlog" : ""
            gsub(/[|] +/, "|", used) # a list may go on in the next line
            if (!files && match(used, /[a-z0-9]+[|][a-z0-9|]+/)) {
                words = substr(used, RSTART, RLENGTH)
                gsub(/[|]/, " ", words)
            }
            q = "\047"
            printf "    %s)\n        options=%s paths=%s values=%s\n        words=%s files=%s names=%s\n        ;;\n", command,
                q substr(options, 2) q, q substr(paths, 2) q, q substr(values, 2) q, q words q, q files q, q names q
        }' "help/$(echo "$command" | tr - _).txt"
done
cat <<END
    '' | help)
        words='${commands}help'
        [[ \$command ]] || options='-h --help --version'
        [[ \$before != --version ]] || words=--json options=--json
        ;;
    esac
    # Words are split at =, so KEY=VALUE is three of them.
    [[ \$word == = ]] && key=\$before word=''
    [[ \$before == = ]] && key=\${COMP_WORDS[COMP_CWORD - 2]}
    if [[ \$key ]]; then
        words=\$("\$1" scenes --parameters "\$key" 2>/dev/null | sed -n 's/^    one of: //p') files=''
    elif [[ " \$paths " == *" \$before "* ]]; then
        mapfile -t COMPREPLY < <(compgen -f -- "\$word")
        compopt -o filenames
        return
    elif [[ " \$values " == *" \$before "* ]]; then
        case \$before in
        --set)
            local paths_of_all name scene=\${COMP_WORDS[i + 1]}
            paths_of_all=\$("\$1" scenes --parameters 2>/dev/null | sed -n 's/^\([a-zA-Z_.]*\) = .*/\1=/p')
            words=\$(grep -v '[.]NAME[.]' <<<"\$paths_of_all")
            [[ \$word == materials* ]] &&
                for name in \$("\$1" run "\$scene" --write-scene 2>/dev/null | sed -n 's/^ *"name": "\([^"]*\)".*/\1/p'); do
                    words+=" \$(sed -n "s/[.]NAME[.]/.\$name./p" <<<"\$paths_of_all")"
                done
            compopt -o nospace
            ;;
        --kind | --weights)
            words=\$("\$1" scenes --parameters history.\${before#--} 2>/dev/null | sed -n 's/^    one of: //p')
            [[ \$before == --weights ]] || local list=\${word%"\${word##*,}"} # the names before the last comma
            words=\$(printf "\${list//%/%%}%s\n" \$words)
            ;;
        --color) words='$colours' ;;
        --format | --columns | --metrics)
            [[ \$before == --format ]] && words='$formats' ||
                words=\$("\$1" metrics --list 2>/dev/null | sed -n 's/^\([a-z][a-z_0-9]*\)  .*/\1/p' | sort -u)
            local list=\${word%"\${word##*,}"} # the names before the last comma
            words=\$(printf "\${list//%/%%}%s\n" \$words)
            compopt -o nospace
            ;;
        --set-columns)
            local list=\${word%"\${word##*,}"}
            words="differing changed none scene \$("\$1" scenes --parameters 2>/dev/null | sed -n 's/^\([a-zA-Z_.]*\) = .*/\1/p' |
                grep -v '[.]NAME[.]')"
            words=\$(printf "\${list//%/%%}%s\n" \$words)
            compopt -o nospace
            ;;
        --stage) words='$stages' ;;
        --up) words='y z' ;;
        --simd) words=\$("\$1" --version 2>/dev/null | sed -n 's/^simd: \(.*\) (.*/\1/p') ;;
        *) words='' ;;
        esac
        files=''
    elif [[ \$word == -* ]]; then
        words=\$options files=''
    elif [[ \$names ]]; then
        words=\$("\$1" "\$command" --list 2>/dev/null | sed -n 's/^\([a-z][a-z0-9-]*\)  .*/\1/p')
    elif [[ \$files == json ]]; then
        words=\$("\$1" scenes 2>/dev/null | sed 's/ .*//')
    fi
    mapfile -t COMPREPLY < <(compgen -W "\$words" -- "\$word")
    if [[ \$files ]]; then
        local found
        mapfile -t found < <(compgen -f -X "!*.\$files" -- "\$word"; compgen -d -- "\$word")
        COMPREPLY+=("\${found[@]}")
        compopt -o filenames
    fi
}
complete -F $function $name
END
