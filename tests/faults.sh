#!/bin/sh
# faults.sh SOURCE RHEOLOG NAME=PROGRAM... [--write]: plants the faults of docs/faults.md and gives the commands of the page that find
# them. What they print must be what the page says, where "..." stands for any words and lines may be broken elsewhere; the last
# command of a fault must print the words of the column "cause"; and the median number of commands must be at most 3. The time that
# they take is printed. PROGRAM is the build with the fault NAME (plant.sh). With --write, outputs on the page that are no longer
# right are replaced by whole ones, to shorten by hand.
#
# The commands of docs/debugging.md are compared in the same way; there each may use the files of those before it.
#
# In a section of the page, a block ```json becomes the file that the line before it names; a block ```sh is run to plant the fault;
# in a block ```console a command stands behind "$ ", and its output follows it. `./rheolog` is the build with the fault.
set -eu
source=$(realpath "$1") rheolog=$(realpath "$2")
shift 2
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
mkdir "$tmp/bin" "$tmp/faulty"
ln -s "$rheolog" "$tmp/bin/rheolog"
PATH=$tmp/bin:$PATH
write=
for argument; do
    case $argument in
    --write) write=1 ;;
    *) ln -s "$(realpath "${argument#*=}")" "$tmp/faulty/${argument%%=*}" ;;
    esac
done

# matches EXPECTED ACTUAL: whether the words of two files are the same.
matches() {
    awk '
        FNR == NR { for (i = 1; i <= NF; i++) want[++wanted] = $i; next }
        { for (i = 1; i <= NF; i++) have[++had] = $i }
        END {
            w = h = 1
            star = 0
            while (h <= had)
                if (w <= wanted && want[w] == "...") {
                    star = w++
                    again = h
                } else if (w <= wanted && want[w] == have[h]) {
                    w++
                    h++
                } else if (star) {
                    w = star + 1
                    h = ++again
                } else
                    exit 1
            while (w <= wanted && want[w] == "...")
                w++
            exit w <= wanted
        }' "$1" "$2"
}

# row PAGE SECTION COLUMN: a cell of the table of faults.
row() {
    awk -F ' *[|] *' -v link="](#$2)" -v column="$3" 'index($2, link) { print $column }' "$1" | sed 's/`//g'
}

wrong=0
complain() {
    wrong=1
    echo "faults: $section: $1"
}

# Compares the output of the last command, and copies what the page has to have.
end_command() {
    [ -n "$command" ] || return 0
    sed -i 's/; builds: .*(this build)$//' "$tmp/said" # which are named only if they differ
    if matches "$tmp/expected" "$tmp/said"; then
        cat "$tmp/expected" >>"$tmp/page"
        command=
        return
    fi
    complain "another output of: $command"
    [ -n "$write" ] || diff "$tmp/expected" "$tmp/said" || true
    cat "$tmp/said" >>"$tmp/page"
    command=
}

end_section() {
    [ -n "$section" ] && [ $commands -gt 0 ] && [ -z "$whole" ] || return 0
    [ "$(row "$page" "$section" 4)" = "$commands" ] || complain "the table has another number of commands than $commands"
    cause=$(row "$page" "$section" 5)
    [ -n "$cause" ] || complain "the table names no cause"
    tr -s ' \n' '  ' <"$tmp/said" | grep -qF -- "$cause" || complain "the last command does not print \"$cause\""
    printf '%-16s %d %5d\n' "$section" $commands $((took / 1000000)) >>"$tmp/found"
}

# Gives the commands of a page with faults, or only of a section of it.
find_causes() { # PAGE [SECTION]
    page=$1 only=${2-} whole=''
    give_commands
}

# Gives the commands of a page in which each may use the files of those before it.
give_all() { # PAGE
    page=$1 only='' whole=${1##*/}
    give_commands
}

give_commands() {
    section=$whole block='' before='' command='' commands=0 took=0
    rm -rf "$tmp/work"
    mkdir "$tmp/work"
    ln -s "$source/replays" "$tmp/work/replays"
    : >"$tmp/page"
    : >"$tmp/found"
    while IFS= read -r line; do
        case $block$line in
        '### '*)
            end_section
            [ -z "$whole" ] || { printf '%s\n' "$line" >>"$tmp/page"; continue; }
            section=$(echo "${line#\#\#\# }" | tr 'A-Z ' 'a-z-') commands=0 took=0
            rm -f "$tmp/work/rheolog"
            [ ! -e "$tmp/faulty/$section" ] || ln -s "$tmp/faulty/$section" "$tmp/work/rheolog"
            [ -z "$only" ] || [ "$only" = "$section" ] || section=
            ;;
        '```'*)
            block=${line#\`\`\`}
            file=${before#\`} file=${file%\`:}
            [ "$block" != json ] || [ -z "$section" ] || : >"$tmp/work/$file"
            ;;
        *'```')
            end_command
            block=
            ;;
        json*) [ -z "$section" ] || printf '%s\n' "$line" >>"$tmp/work/$file" ;;
        sh*)
            code=0
            [ -z "$section" ] || (cd "$tmp/work" && sh -c "$line" >"$tmp/said" 2>&1 </dev/null) || code=$?
            [ $code -le 1 ] || { cat "$tmp/said"; complain "exit code $code of: $line"; }
            ;;
        console'$ '*)
            end_command
            if [ -n "$section" ]; then
                command=${line#\$ } commands=$((commands + 1))
                : >"$tmp/expected"
                start=$(date +%s%N)
                (cd "$tmp/work" && sh -c "$command" >"$tmp/said" 2>&1 </dev/null) || true
                took=$((took + $(date +%s%N) - start))
            fi
            ;;
        console*)
            if [ -n "$command" ]; then
                printf '%s\n' "$line" >>"$tmp/expected"
                before=$line
                continue
            fi
            ;;
        esac
        printf '%s\n' "$line" >>"$tmp/page"
        [ -z "$line" ] || before=$line
    done <"$page"
    end_section
}

give_all "$source/docs/debugging.md"
[ -z "$write" ] || cat "$tmp/page" >"$page"
find_causes "$source/docs/faults.md"
[ -z "$write" ] || { cat "$tmp/page" >"$page"; exit; }
[ "$(grep -c '](#' "$page")" = "$(wc -l <"$tmp/found")" ] || { section=table && complain "its rows are not the sections"; }
[ $wrong = 0 ] || { echo "after an intended change: sh tests/faults.sh SOURCE RHEOLOG NAME=PROGRAM... --write"; exit 1; }
median() { sort -n -k "$1,$1" "$tmp/found" | awk -v c="$1" '{ v[NR] = $c } END { print v[int((NR + 1) / 2)] }'; }
echo 'fault         commands    ms'
cat "$tmp/found"
echo "median           $(median 2)  $(median 3)"
most=3 some=12
[ "$(wc -l <"$tmp/found")" -ge $some ] || { echo "there are fewer than $some faults"; exit 1; }
[ "$(median 2)" -le $most ] || { echo "the median number of commands is more than $most"; exit 1; }

# Proves that a wrong word of an output, a wrong number of commands and a cause that is not printed are noticed.
notices() { # WHAT SED
    sed "$2" "$source/docs/faults.md" >"$tmp/changed.md"
    wrong=0
    find_causes "$tmp/changed.md" turned-normal >"$tmp/noticed"
    [ $wrong = 1 ] || { echo "faults.sh does not notice $1"; exit 1; }
}
wrong=0
find_causes "$source/docs/faults.md" turned-normal
[ $wrong = 0 ] || exit 1
notices "another output" 's/^refused: all [0-9]* particles/refused: all 1 particles/'
notices "another number of commands" 's/\(](#turned-normal) .*|\) 1 |/\1 2 |/'
notices "a cause that is not printed" 's/\(](#turned-normal) .*\)wall 2/\1wall 3/'
