#!/bin/sh
# debugging.sh SOURCE RHEOLOG: gives every command of docs/debugging.md, in order and as printed, and compares what it says with the
# page, where "..." stands for any words. A command without output on the page must not be refused. The session of `rheolog debug` is that of test_cli_debug.
set -eu
source=$(realpath "$1") rheolog=$(realpath "$2")
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
cd "$tmp"
mkdir bin blocks
ln -s "$rheolog" bin/rheolog
PATH=$tmp/bin:$PATH
failed=0

# blocks/N: a command, and what follows it on the page.
awk '/^```/ { inside = !inside; open = 0; next }
    inside && /^\$ / { open = 1; file = sprintf("blocks/%03d", ++n) }
    inside && open { print > file }' "$source/docs/debugging.md"
[ "$(find blocks -type f | wc -l)" -ge 15 ] || { echo "the page has hardly any commands"; exit 1; }

for block in blocks/*; do
    command=$(sed -n '1s/^\$ //p' "$block")
    case $command in
    'rheolog debug '*) continue ;;
    esac
    sed 1d "$block" >expected
    status=0
    sh -c "$command" >said 2>&1 </dev/null || status=$?
    if [ $status -gt 1 ]; then
        echo "$command: exit code $status"
        cat said
        failed=1
        continue
    fi
    # Words are compared, because the page has shorter lines. The build is that of the machine of the page, and progress that of this
    # one.
    grep -Ev '^(build  |step [0-9]+ of |the recording will have |simulating, |settling, |searching, )' said >words || true
    grep -v '^build  ' expected | awk '
        FILENAME == "words" { for (i = 1; i <= NF; i++) said = said " " $i; next }
        { for (i = 1; i <= NF; i++) page = page " " $i }
        END {
            said = said " "
            if (page == "") exit
            count = split(page " ", part, / \.\.\./)
            for (k = 1; k <= count; k++) {
                text = part[k] == "" ? " " : part[k]
                at = k == count && count > 1 ? length(said) - length(text) + 1 : index(said, text)
                if (at < 1 || substr(said, at, length(text)) != text || (k == 1 && at > 1) || (count == 1 && said != text)) {
                    print "the page says:" text
                    exit 1
                }
                said = substr(said, at + length(text) - 1)
            }
        }' words - || {
        echo "after: $command"
        echo "it says:"
        cat said
        failed=1
    }
done
exit $failed
