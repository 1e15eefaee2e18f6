#!/bin/sh
# option_table.sh: prints the commands and options of the program as a table, from commands.def and the help texts, which a test
# compares with the options that the program takes. The completions are made from it. Columns are separated by tabs; - is nothing:
#
#   command  NAME  PURPOSE
#   operand  COMMAND  SOURCE
#   option   COMMAND  SHORT  LONG  ARGUMENT  SOURCE  PURPOSE
#
# SOURCE says what the operand or argument can be: `file`, `folder`, `files.ENDING`, `scene` (a scene, or a file that ends with
# .json), `one.A.B.C` (one of these words), `free`, or a name of completion_words.sh. It ends with a comma if a list is possible.
set -eu
cd "$(dirname "$0")"
sed -n 's/^CLI_COMMAND(\([a-z0-9_]*\), "\(.*\)")$/\1 \2/p' commands.def | while read -r name purpose; do
    command=$(echo "$name" | tr _ -)
    printf 'command\t%s\t%s\n' "$command" "$purpose"
    awk -v command="$command" '
        function finish() { # the purpose of an option is the beginning of its text, up to an end of a sentence or clause
            if (!long)
                return
            sub(/[.;] .*/, "", text)
            sub(/[.;]$/, "", text)
            while (length(text) > 76 && match(text, /(,|:| \()[^,:(]*$/))
                text = substr(text, 1, RSTART - 1)
            if (gsub(/\(/, "(", text) > gsub(/\)/, ")", text))
                sub(/,? *\([^(]*$/, "", text)
            printf "option\t%s\t%s\t%s\t%s\t%s\t%s\n", command, short, long, argument, source(), text
            long = ""
        }
        function source(name, list) {
            if (argument == "-")
                return "-"
            list = argument ~ /,|NAMES/ ? "," : ""
            if (argument ~ /[.]rlog/)
                return "files.rlog"
            if (argument ~ /^(FILE|PROGRAM)$/)
                return "file"
            if (argument ~ /^(DIR|FOLDER)$/)
                return "folder"
            name = long
            sub(/^--/, "", name)
            gsub(/-/, "_", name)
            if (name == "columns")
                name = "metrics"
            if (name == "up")
                return "one.y.z"
            if (name !~ /^(set|kind|weights|color|format|metrics|set_columns|stage|simd|scheme|scenes|model|study|solvers|at_least)$/)
                return "free"
            return name list
        }
        NR == 1 { usage = 1 }
        /^$/ { usage = 0 }
        usage { used = used " " $0 }
        /^[a-z]/ { finish(); section = $0 }
        section != "options:" { next }
        /^  -/ {
            finish()
            line = substr($0, 3)
            text = ""
            if (match(line, /   */)) {
                text = substr(line, RSTART + RLENGTH)
                line = substr(line, 1, RSTART - 1)
            } else if (match(line, /[.][.][.] /)) { # a long argument has one blank behind it
                text = substr(line, RSTART + 4)
                line = substr(line, 1, RSTART + 2)
            }
            short = argument = "-"
            n = split(line, part, /,? /)
            for (i = 1; i <= n; i++)
                if (part[i] ~ /^--/)
                    long = part[i]
                else if (part[i] ~ /^-/)
                    short = part[i]
                else
                    argument = part[i]
            next
        }
        /^ / {
            sub(/^ */, "")
            text = text (text == "" ? "" : " ") $0
        }
        END {
            finish()
            gsub(/[|] +/, "|", used) # a list may go on in the next line
            operand = used ~ /[.]rlog/ ? "files.rlog" : "-"
            if (used ~ / SCENE/)
                operand = used ~ /SCENE[|]F[.]rlog/ ? "scene_or_recording" : "scene"
            if (used ~ / \[NAME\.\.\.\]/)
                operand = "experiments"
            if (operand == "-" && match(used, /[a-z0-9]+[|][a-z0-9|]+/)) {
                operand = "one." substr(used, RSTART, RLENGTH)
                gsub(/[|]/, ".", operand)
            }
            printf "operand\t%s\t%s\n", command, operand
        }' "help/$name.txt"
done
