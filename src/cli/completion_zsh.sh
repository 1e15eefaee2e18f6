# Read by completion.sh: prints the completion for zsh.

cat <<END
#compdef $name
# Completion of $name for zsh, made by completion.sh from the help texts of the program.
${function}_words() { # ${function}_words SOURCE [OPTIONS OF compadd]...
    local source=\$1 key='' script=$(quoted "$words")
    local -a found
    shift
    if [[ \$source == set ]]; then
        key=\$PREFIX
        if compset -P '*='; then
            source=values key=\${key%%=*}
        else
            set -- -S =
        fi
    elif [[ \$source == *, ]]; then
        compset -P '*,'
        set -- -qS ,
    fi
    found=(\${(f)"\$(sh -c \$script sh \$program \${source%,} "\$key" "\${line[1]-}")"})
    found=(\${found/\$'\\t'/:}) # the meaning of a word stands behind a colon
    _describe -t \${source%%[.,]*} \${source%%[.,]*} found "\$@"
}
${function}_scene() {
    local known=1
    ${function}_words scene && known=0
    _files -g "\${1-*.json}" && known=0
    return known
}
$function() {
    local curcontext=\$curcontext state known=1 program=\${~\${(Q)words[1]}}
    local -a line commands version
    typeset -A opt_args
    commands=(
END
quoted_row() { # quoted_row TEXT: one word of an array, in single quotes
    printf '        %s\n' "$(quoted "$1")"
}
echo "$table" | sed -n "s/^command$tab//p" | while IFS=$tab read -r command purpose; do
    quoted_row "$command:$purpose"
done
quoted_row 'help:print the help of a command'
cat <<END
    )
    [[ \${words[(I)--version]} == 0 ]] || version=('--json[print the version, the build and the libraries as JSON]')
    _arguments -C '(-)'{-h,--help}'[print the help]' '(-h --help 1)--version[print the version and the build]' \$version \\
        '1:command:->command' '*::argument:->arguments' && known=0
    case \$state in
    command) _describe -t commands command commands && known=0 ;;
    arguments)
        curcontext=\${curcontext%:*:*}:$name-\$words[1]:
        case \$words[1] in
        help) _describe -t commands command commands && known=0 ;;
END
action() { # action SOURCE: completes an operand or argument of this source
    case $1 in
    free | -) ;;
    file) echo _files ;;
    folder) echo '_files -/' ;;
    files.*) echo "_files -g \"*.${1#files.}\"" ;;
    scene) echo " ${function}_scene" ;;
    scene_or_recording) echo " ${function}_scene \"*.json *.rlog\"" ;;
    *) echo " ${function}_words $1" ;;
    esac
}
for command in $commands; do
    printf '        %s)\n            _arguments -S' "$command"
    rows option "$command" | while IFS=$tab read -r short long argument source purpose; do
        purpose=$(printf %s "$purpose" | sed 's/[]:\\[]/\\&/g')
        value=
        [ "$argument" = - ] || value=$(printf ':%s:%s' "$(printf %s "$argument" | sed 's/:/\\:/g')" "$(action "$source")")
        many=
        [ "$long" != --set ] || many='*'
        printf ' \\\n                '
        if [ "$short" != - ] && [ "$value" ]; then
            printf %s "$(quoted "($short $long)"){$short+,$long=}$(quoted "[$purpose]$value")"
        elif [ "$short" != - ]; then
            printf %s "$(quoted "($short $long)"){$short,$long}$(quoted "[$purpose]")"
        else
            printf %s "$(quoted "$many$long${value:+=}[$purpose]$value")"
        fi
    done
    operand=$(operand_of "$command")
    [ "$operand" = - ] || printf ' \\\n                %s' "$(quoted "*:${operand%%.*}:$(action "$operand")")"
    printf ' && known=0\n            ;;\n'
done
cat <<END
        esac
        ;;
    esac
    return known
}
$function "\$@"
END
