#!/bin/sh
# The Python module (src/python/rheolog.py) against the program and the library of this build, and the blocks of docs/python.md.
#
#   python.sh SOURCE PROGRAM LIBRARY REAL RECORDER              RECORDER: reference_recordings, which records every kind of command
#   python.sh SOURCE PROGRAM LIBRARY REAL RECORDER --write      makes the outputs and plots of the page again
set -eu
source=$1
. "$source/tests/numpy.sh"
exec "$python" "$source/tests/test_python.py" "$@"
