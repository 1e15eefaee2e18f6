# Part of scripts that have a folder $tmp.
fails() { # fails TEXT COMMAND...: the command must fail and print the text
    said=$1
    shift
    if "$@" >"$tmp/said" 2>&1; then
        echo "passes: $*, which should fail with: $said"
        exit 1
    fi
    grep -q "$said" "$tmp/said" || { cat "$tmp/said"; echo "does not say: $said"; exit 1; }
}
