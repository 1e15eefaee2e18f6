# Read by completion.sh: prints the completion for bash.

cat <<END
# Completion of $name for bash, made by completion.sh from the help texts of the program.
$function() {
    local word=\$2 before=\$3 command='' options='' sources='' operand='' source='' prefix='' assigned='' endings='' found i
    local script=$(quoted "$words")
    COMPREPLY=()
    for ((i = 1; i < COMP_CWORD; i++)); do
        [[ \${COMP_WORDS[i]} == -* ]] || { command=\${COMP_WORDS[i]}; break; }
    done
    case \$command in
END
for command in $commands; do
    # Options, and behind the options that have an argument its source.
    rows option "$command" | awk -F '\t' -v command="$command" -v operand="$(operand_of "$command")" '
        {
            for (i = 1; i <= 2; i++)
                if ($i != "-") {
                    options = options " " $i
                    if ($4 != "-")
                        sources = sources " " $i "=" $4
                }
        }
        END {
            printf "    %s)\n        options=\047%s\047\n        sources=\047%s\047 operand=%s\n        ;;\n", command, substr(options, 2),
                sources " ", operand == "-" ? "" : operand
        }'
done
cat <<END
    '' | help)
        operand=one.$(echo $commands help | tr ' ' .)
        [[ \$command ]] || options='-h --help --version'
        [[ \$before != --version ]] || operand=one.--json options=--json
        ;;
    esac
    # Words are split at =, so KEY=VALUE is three of them, and --option=VALUE, too.
    [[ \$before == = ]] && before=\${COMP_WORDS[COMP_CWORD - 2]} assigned=yes
    [[ \$word == = ]] && word='' assigned=yes
    [[ \$assigned && \$before != -* ]] && source=values
    if [[ \$source ]]; then
        :
    elif [[ \$sources == *" \$before="* ]]; then
        source=\${sources##*" \$before="}
        source=\${source%% *}
    elif [[ \$word == -* ]]; then
        mapfile -t COMPREPLY < <(compgen -W "\$options" -- "\$word")
        return
    else
        source=\$operand
    fi
    [[ \$source == *, ]] && prefix=\${word%"\${word##*,}"} # the words before the last comma
    case \$source in
    '' | free) ;;
    file) endings='*' ;;
    folder) endings=' ' ;;
    files.*) endings=\${source#files.} ;;
    *)
        found=\$(sh -c "\$script" sh "\$1" "\${source%,}" "\$([[ \$source == values ]] && echo "\$before" || echo "\$word")" \\
            "\${COMP_WORDS[i + 1]-}" | cut -f 1)
        [[ \$source == set ]] && found=\$(sed 's/\$/=/' <<<"\$found")
        [[ ! \$prefix ]] || found=\$(while read -r i; do echo "\$prefix\$i"; done <<<"\$found")
        mapfile -t COMPREPLY < <(compgen -W "\$found" -- "\$word")
        [[ \$source == set || \$source == *, ]] && compopt -o nospace
        [[ \$source == scene* ]] && endings=json
        [[ \$source == scene_or_recording ]] && endings='json rlog'
        ;;
    esac
    if [[ \$endings ]]; then
        mapfile -t found < <(compgen -f -- "\$word" | while read -r i; do
            [[ ! -d \$i && (\$endings == '*' || " \$endings " == *" \${i##*.} "*) ]] && printf '%s\n' "\$i"
        done; compgen -d -- "\$word")
        COMPREPLY+=("\${found[@]}")
        compopt -o filenames
    fi
    return 0
}
complete -F $function $name
END
