#!/bin/sh
# report.sh SOURCE RHEOLOG [PROPERTY...]: opens pages that `rheolog report` made in Chromium, uses them as a reader does, and compares what they show
# with `rheolog inspect`. Skipped without Chromium.
set -eu
source=$(realpath "$1") rheolog=$(realpath "$2")
PYTHONDONTWRITEBYTECODE=1
export PYTHONDONTWRITEBYTECODE
python3 -c "import sys; sys.path.insert(0, '$source/tests'); import browser; sys.exit(browser.program() is None)" ||
    { echo "report: skipped, because it needs Chromium (Debian: chromium)"; exit 77; }
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
cd "$tmp"
scene='bowling-ball-small --set scheme=sequential --set particles=600'
# shellcheck disable=SC2086
{
    "$rheolog" run $scene --steps 30 -o base.rlog --quiet
    "$rheolog" run $scene --set history.order=0.52 --steps 30 -o other.rlog --quiet
    "$rheolog" run --from base.rlog@15 --set history.stiffness=5000 --steps 20 -o bad.rlog --quiet || [ $? = 1 ]
} >/dev/null 2>&1
"$rheolog" report bad.rlog -o bad.html --quiet >/dev/null
"$rheolog" report base.rlog other.rlog -o both.html --quiet --max-size 2M >/dev/null
shift 2
python3 "$source/tests/report_page.py" "$rheolog" "$@"
