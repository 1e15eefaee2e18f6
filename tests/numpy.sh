# Sourced: sets $python to a python3 that has numpy, and lets it find src/python of $source. Without one, the test is skipped.
for python in python3 /usr/bin/python3 none; do
    [ "$python" = none ] || ! "$python" -c 'import numpy' 2>/dev/null || break
done
if [ "$python" = none ]; then
    echo "skipped, because it needs Python with numpy (Debian: python3-numpy)"
    exit 77
fi
export PYTHONDONTWRITEBYTECODE=1 PYTHONPATH="$source/src/python${PYTHONPATH:+:$PYTHONPATH}"
