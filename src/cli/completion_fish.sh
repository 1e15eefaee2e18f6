# Read by completion.sh: prints the completion for fish.

text() { # text TEXT: in single quotes, as fish reads it
    printf "'%s'" "$(printf %s "$1" | sed "s/[\\\\']/\\\\&/g")"
}
cat <<END
# Completion of $name for fish, made by completion.sh from the help texts of the program.
function _$function
    set -l operands
    for word in (commandline -opc)[2..]
        string match -q -- '-*' \$word; or set -a operands \$word
    end
    printf '%s\n' \$operands
end
function _${function}_is
    set -l command (_$function)[1]
    test "\$command" = "\$argv[1]"
end
function _${function}_words # _${function}_words SOURCE: the rest of a word may stand behind a comma or =
    set -l word (commandline -ct | string replace -r -- '^--[a-z-]*=' '')
    set -l source (string trim -r -c , -- \$argv[1])
    set -l before ''
    set -l after ''
    set -l typed \$word
    if test \$source != \$argv[1]
        set before (string match -r -- '^.*,' \$word)
    else if test \$source = set
        set after =
        if string match -q -- '*=*' \$word
            set before (string match -r -- '^[^=]*=' \$word)
            set after ''
            set source values
            set typed (string replace -r -- '=.*' '' \$word)
        end
    end
    sh -c $(text "$words") sh (commandline -opc)[1] \$source "\$typed" (_$function)[2] | string replace -r -- '^([^\t]*)' "\$before\\\$1\$after"
end
function _${function}_files # _${function}_files ENDING: files with it, and folders
    complete -C "__fish_command_without_completions "(commandline -ct | string replace -r -- '^--[a-z-]*=' '') |
        string match -r -- "^.*(?:/|[.]\$argv[1])(?:\t.*)?\\\$"
end
complete -c $name -f
complete -c $name -n '_${function}_is ""' -s h -l help -d 'print the help'
complete -c $name -n '_${function}_is ""' -l version -d 'print the version and the build'
complete -c $name -n 'contains -- --version (commandline -opc)' -l json -d 'print the version, the build and the libraries as JSON'
END
echo "$table" | sed -n "s/^command$tab//p" | while IFS=$tab read -r command purpose; do
    printf 'complete -c %s -n %s -a %s -d %s\n' "$name" "'_${function}_is \"\"; or _${function}_is help'" "$command" "$(text "$purpose")"
done
printf 'complete -c %s -n %s -a help -d %s\n' "$name" "'_${function}_is \"\"'" "'print the help of a command'"
action() { # action SOURCE: the options of `complete` for an operand or argument of this source
    case $1 in
    free) echo -x ;;
    -) ;;
    file) echo -r -F ;;
    folder) echo "-x -a '(__fish_complete_directories (commandline -ct))'" ;;
    files.*) echo "-x -a '(_${function}_files ${1#files.})'" ;;
    scene) echo "-x -a '(_${function}_words scene; _${function}_files json)'" ;;
    scene_or_recording) echo "-x -a '(_${function}_words scene; _${function}_files json; _${function}_files rlog)'" ;;
    *) echo "-x -a '(_${function}_words $1)'" ;;
    esac
}
for command in $commands; do
    rows option "$command" | while IFS=$tab read -r short long argument source purpose; do
        printf 'complete -c %s -n %s' "$name" "'_${function}_is $command'"
        [ "$short" = - ] || printf ' -s %s' "${short#-}"
        printf ' -l %s %s -d %s\n' "${long#--}" "$(action "$source")" "$(text "$purpose")"
    done
    operand=$(operand_of "$command")
    [ "$operand" = - ] || printf 'complete -c %s -n %s %s\n' "$name" "'_${function}_is $command'" "$(action "$operand")"
done
