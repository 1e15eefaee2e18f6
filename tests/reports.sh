#!/bin/sh
# reports.sh PROGRAM SOURCE: checks the reports of `verify` and `diff` with the XML parser of Python and with a parser of TAP
# (reports.py): every file is in every report, with its verdict, whatever its name is.
set -eu
if ! command -v python3 >/dev/null; then
    echo "no python3 here: the reports are not checked"
    exit 77
fi
exec python3 "$2/tests/reports.py" "$1"
