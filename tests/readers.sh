#!/bin/sh
# readers.sh SOURCE PROGRAM: the files of `rheolog export` and the trace of `rheolog bench`, as VTK, meshio and ParaView read them
# (readers.py). Skipped without VTK and meshio; ParaView is asked if there is a pvpython.
set -eu
for python in python3 /usr/bin/python3 none; do
    [ "$python" = none ] || ! "$python" -c 'import vtkmodules.vtkIOXML, meshio' 2>/dev/null || break
done
if [ "$python" = none ]; then
    echo "skipped, because it needs Python with VTK and meshio (Debian: python3-vtk9, python3-meshio)"
    exit 77
fi
PYTHONDONTWRITEBYTECODE=1 exec "$python" "$1/tests/readers.py" "$2"
