#!/bin/sh
# layers.sh SOURCE: checks that includes follow the order of the folders, and that no files or folders include each other in a
# circle. The order: core < space < thickening, melting, solids < world < record < scenes < view < json < cli. The library for scene
# files (json) includes public headers (rheolog/) and its own only, and the program also those of json. A .c file and the header of
# the same name count as one file. At the end the script proves that it notices each kind of error.
set -eu
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# rank ROOT FOLDER: its place in the order. A folder with stages.def is a model.
rank() {
    case $2 in
    core) echo 1 ;; space) echo 2 ;; solids) echo 3 ;; world) echo 4 ;; record) echo 5 ;;
    scenes) echo 6 ;; view) echo 7 ;; json) echo 8 ;; cli) echo 9 ;; python) echo 10 ;;
    *) [ -e "$1/src/$2/stages.def" ] && echo 3 || echo 0 ;;
    esac
}

# includes ROOT: prints a line "folder/file folder/file" for each include below ROOT/src, except includes of rheolog/.
includes() {
    (cd "$1/src" && grep -r -o --include='*.[ch]' --include='*.def' '^#include "[a-z]*/[a-z0-9_/]*\.[a-z.]*"' .) |
        sed 's/^\.\///; s/:#include "/ /; s/"$//' | grep -v ' rheolog/' | sort -u || true
}

# order ROOT: prints the includes that break the order of the folders.
order() {
    for folder in "$1"/src/*/; do
        [ "$(rank "$1" "$(basename "$folder")")" != 0 ] || echo "$folder has no place in the order"
    done
    includes "$1" | while read -r file header; do
        from=${file%%/*} to=${header%%/*}
        own=$(rank "$1" "$from") its=$(rank "$1" "$to")
        if [ "$its" -gt "$own" ] || { [ "$its" = "$own" ] && [ "$to" != "$from" ]; } ||
            { [ "$own" -ge 8 ] && [ "$its" -lt 8 ]; }; then
            echo "$file includes $header"
        fi
    done
}

# circles ROOT: prints the members of a circle of includes, if there is one.
circles() {
    # space/pairs is the part of space/neighbours that is compiled for each SIMD variant.
    includes "$1" | sed 's/\.[a-z.]* / /; s/\.[a-z.]*$//; s/space\/pairs/space\/neighbours/g' | awk '$1 != $2' >"$scratch/edges_of_files"
    sed 's/\/[^ ]*//g' "$scratch/edges_of_files" | awk '$1 != $2' >"$scratch/edges_of_folders"
    for edges in files folders; do
        tsort "$scratch/edges_of_$edges" 2>&1 >/dev/null | sed "s/^tsort: /$edges: /" || true
    done
}

found=$(order "$1"; circles "$1")
[ -z "$found" ] || { echo "$found"; exit 1; }

proof() { # proof NAME CHECK LINES: the check must print this many lines for the tree on standard input
    mkdir -p "$scratch/$1/src"
    while read -r file header; do
        mkdir -p "$scratch/$1/src/${file%/*}"
        echo "#include \"$header\"" >>"$scratch/$1/src/$file"
    done
    lines=$($2 "$scratch/$1" | wc -l)
    [ "$lines" = "$3" ] || { echo "the check $2 does not notice the errors of $1"; exit 1; }
}
mkdir -p "$scratch/upwards/src/melting"
touch "$scratch/upwards/src/melting/stages.def"
proof upwards order 7 <<'END'
core/a.c world/world.h
solids/a.c melting/melting.h
unknown/a.c core/state.h
cli/a.c record/recording.h
cli/b.c scenes/fill.h
cli/b.c json/json_writer.h
json/a.c core/text.h
END
proof headers circles 3 <<'END'
core/a.h core/b.h
core/b.h core/a.h
END
proof sources circles 3 <<'END'
core/a.c core/b.h
core/b.c core/a.h
END
proof folders circles 3 <<'END'
core/a.h space/b.h
space/c.h core/d.h
END
proof nothing circles 0 <<'END'
core/a.c core/a.h
core/b.c core/a.h
END
echo "layers: correct"
