#!/bin/sh
# make.sh SOURCE OUTPUT: makes the reference of the C library in the folder OUTPUT, as HTML and XML. Fails if a public declaration is not
# documented.
set -eu
source=$(realpath "$1")
mkdir -p "$2"
output=$(realpath "$2")
command -v doxygen >/dev/null || { echo "doxygen is needed for the reference" >&2; exit 77; }
api=$source/docs/api
main=$output/main.md
{
    # The example of docs/library.md, which a test compiles.
    sed '/^@EXAMPLE@$/,$d' "$api/main.md.in"
    awk '/^```c$/ { on = 1; next } /^```$/ && on { exit } on' "$source/docs/library.md"
    sed '1,/^@EXAMPLE@$/d' "$api/main.md.in"
} >"$main"
{
    cat "$api/Doxyfile"
    cat <<END
PROJECT_NUMBER = $(sed -n "s/^  version: '\(.*\)',$/\1/p" "$source/meson.build")
INPUT = "$main" "$source/include/rheolog"
USE_MDFILE_AS_MAINPAGE = "$main"
STRIP_FROM_PATH = "$source/include" "$output"
STRIP_FROM_INC_PATH = "$source/include"
FILTER_PATTERNS = "*.h=awk -f \"$api/filter.awk\""
LAYOUT_FILE = "$api/layout.xml"
HTML_EXTRA_STYLESHEET = "$api/style.css"
OUTPUT_DIRECTORY = "$output"
END
} | doxygen -
rm "$main" "$output"/functions*.html
