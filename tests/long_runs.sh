#!/bin/sh
# long_runs.sh SOURCE RHEOLOG: gives every command of docs/long-runs.md, in order and as printed, for a small scene, and compares the
# exit codes with what the page says.
set -eu
source=$(realpath "$1") rheolog=$(realpath "$2")
tmp=$(mktemp -d)
cd "$tmp"
trap '[ ! -e night.pid ] || kill -9 "$(cat night.pid)" 2>/dev/null || true; rm -rf "$tmp"' EXIT
mkdir bin
# The program of the page has another scene: with some particles, and so many steps that it does not end before it is stopped.
cat >bin/rheolog <<END
#!/bin/bash
arguments=()
for a in "\$@"; do
    case \$a in
    bowling-ball) arguments+=(bowling-ball-small --set particles=300) ;;
    1000000) arguments+=(100000000) ;;
    20000) arguments+=(700) ;;
    *) arguments+=("\$a") ;;
    esac
done
exec "$rheolog" "\${arguments[@]}"
END
command -v bash >/dev/null || { echo "there is no bash"; exit 77; }
chmod +x bin/rheolog
PATH=$tmp/bin:$PATH
fail() {
    echo "$1"
    cat said 2>/dev/null || true
    exit 1
}

# Each command is one line; one that ends in a backslash continues.
awk '/^```sh$/ { on = 1; next } /^```$/ { on = 0 } on' "$source/docs/long-runs.md" |
    awk '{ line = line $0 } sub(/\\$/, "", line) { next } { print line; line = "" }' >commands
[ "$(wc -l <commands)" -ge 20 ] || fail "there are only $(wc -l <commands) commands on the page"

wait_for_steps() { # until the run that was started has begun to write, or has gone on with what was there
    size=$(stat -c %s night.rlog 2>/dev/null || echo 0)
    i=0
    while [ "$(stat -c %s night.rlog 2>/dev/null || echo 0)" -le $((size + 100000)) ]; do
        i=$((i + 1))
        if [ $i -gt 600 ] || ! kill -0 "$(cat night.pid)" 2>/dev/null; then
            fail "the run does not begin or go on: $(cat night.txt)"
        fi
        sleep 0.1
    done
}
wait_for_end() { # until the run that was started has ended
    i=0
    while kill -0 "$(cat night.pid)" 2>/dev/null; do
        i=$((i + 1))
        [ $i -le 600 ] || fail "the run does not end"
        sleep 0.1
    done
}

state=none # of night.rlog: growing, complete or truncated
while read -r command; do
    expected=0
    before=$command
    case $command in
    *'metrics --follow'*)
        expected=4
        command="timeout --preserve-status -s INT 2 $command"
        ;;
    'rheolog doctor night'* | 'rheolog metrics night'*) [ $state = complete ] || expected=2 ;;
    *watched.rlog*) # first what is not on the page: a scene that goes bad
        sh -c "$command --set scheme=sequential --set fluid.stiffness=900 --force" >said 2>&1 && fail "an ill run does not end"
        grep -q 'unhealthy since step' said || fail "an ill run does not say so"
        rheolog info watched.rlog | grep -q '^complete *yes' || fail "an ill run leaves no complete recording"
        rm watched.rlog
        ;;
    esac
    code=0
    sh -c "$command" >said 2>&1 || code=$?
    [ $code -eq $expected ] || fail "exit code $code instead of $expected: $before"
    case $command in
    nohup*)
        wait_for_steps
        state=growing
        ;;
    'kill -9'*)
        wait_for_end
        state=truncated
        ;;
    kill*)
        wait_for_end
        state=complete
        grep -q 'the same command with --continue goes on' night.txt || fail "the run does not end in good order: $(cat night.txt)"
        ;;
    'rheolog info night'*)
        case $state in
        growing) word='no: being written' ;;
        complete) word=yes ;;
        *) word='no: truncated' ;;
        esac
        grep -q "^complete *$word" said || fail "the recording is not $state"
        ;;
    esac
done <commands

# What the page says of a run that was killed and continued, and of one whose end became zeros.
kill "$(cat night.pid)"
wait_for_end
rheolog verify night.rlog >said 2>&1 || fail "the continued run does not verify"
size=$(stat -c %s night.rlog)
head -c $((size - 4000)) night.rlog >zeros.rlog
head -c 3000 /dev/zero >>zeros.rlog
code=0
timeout --preserve-status -s TERM 5 rheolog run bowling-ball --steps 1000000 --keyframes 20000 -o zeros.rlog --continue --quiet >said 2>&1 ||
    code=$?
[ $code = 4 ] || fail "a recording with zeros at its end is not continued: $code"
rheolog verify zeros.rlog >said 2>&1 || fail "a recording with zeros at its end that was continued does not verify"
echo "long-runs: $(wc -l <commands) commands do what the page says"
