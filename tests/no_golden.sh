#!/bin/sh
# Proves that missing golden recordings are a failure: an empty folder, no folder, an empty command line. So are files
# that are no recordings, and none of them hides the others.
#
#   no_golden.sh EXAMPLE_GOLDEN RHEOLOG
set -eu
example=$1 rheolog=$2
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
. "$(dirname "$0")/fails.sh"
mkdir "$tmp/empty"
fails "no golden recordings in" env GOLDEN="$tmp/empty" "$example"
fails "there is no folder" env GOLDEN="$tmp/none" "$example"
fails "nothing was verified" "$rheolog" verify
fails "No such file" "$rheolog" verify "$tmp/empty/*.rlog"
mkdir -p "$tmp/bad/folder.rlog"
: >"$tmp/bad/empty.rlog"
printf 'version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 1\n' >"$tmp/bad/lfs.rlog"
printf '\211RLOG\r\r\n\032' >"$tmp/bad/crlf.rlog"
printf '\211RLOG\n\032' >"$tmp/bad/lf.rlog"
for text in "folder.rlog: is a folder" "empty.rlog: .*empty.*restore it" "git lfs pull" "crlf.rlog: .*line ends" "lf.rlog: .*line ends"; do
    fails "$text" env GOLDEN="$tmp/bad" "$example"
done
if grep "bless" "$tmp/said"; then
    echo "a damaged file must not be blessed away"
    exit 1
fi
fails "empty.rlog: unreadable" "$rheolog" verify "$tmp"/bad/*.rlog
grep -q "lfs.rlog: unreadable: .*git lfs pull" "$tmp/said"
if grep "git-lfs.*restore it" "$tmp/said"; then
    echo "version control has only the pointer"
    exit 1
fi
echo "no_golden: missing recordings are failures"
