# Part of sweeps.sh and slurm.sh, which set $source, $rheolog, $seeds and $tmp: the files and the sweep of docs/sweeps.md.
page_files() { # writes each block of the page whose comment begins with the name of a file
    awk '
        /^```/ { if (on && name) printf "%s", text > name; on = !on; text = ""; name = ""; next }
        on { text = text $0 "\n" }
        on && !name && /^# [A-Za-z.]+( [A-Z ]+)?: / { name = $2; sub(/:$/, "", name) }' "$source/docs/sweeps.md"
    for file in one.sh Snakefile sweep.sbatch; do
        [ -s "$file" ] || { echo "docs/sweeps.md has no $file"; exit 1; }
    done
}
prepare() { # a folder with the files of the page, sweep.txt and the program
    mkdir "$tmp/bin" "$tmp/disturbed"
    # No run begins while there are as many recordings as the file hold says, so that the sweep is not over before it is ended.
    cat >"$tmp/bin/rheolog" <<END
#!/bin/sh
while [ "\$1" = run ] && [ -e $tmp/hold ] && [ "\$(find runs -name '*.rlog' | wc -l)" -ge "\$(cat $tmp/hold)" ]; do
    sleep 0.1
done
exec $rheolog "\$@"
END
    chmod +x "$tmp/bin/rheolog"
    PATH=$tmp/bin:$PATH
    cd "$tmp/disturbed"
    page_files
    sh -c "$(grep '^for order' "$source/docs/sweeps.md" | sed "s/seq 50/seq $seeds/")"
    all=$(wc -l <sweep.txt)
    [ "$all" -eq $((4 * seeds)) ] || { echo "sweep.txt has $all lines"; exit 1; }
}
undisturbed() { # the same runs one by one, in another folder
    mkdir "$tmp/undisturbed"
    (
        cd "$tmp/undisturbed"
        while read -r order seed; do
            sh "$tmp/disturbed/one.sh" "$order" "$seed" >/dev/null 2>"$tmp/said" || { cat "$tmp/said"; exit 1; }
        done <"$tmp/disturbed/sweep.txt"
    )
}
recordings() { # how many there are
    find runs -name '*.rlog' 2>/dev/null | wc -l
}
wait_for_recordings() {
    i=0
    while [ "$(recordings)" -lt "$1" ]; do
        i=$((i + 1))
        [ $i -le 3000 ] || { cat said; echo "there are only $(recordings) recordings"; exit 1; }
        sleep 0.02
    done
}
count_complete() { # recordings with all 20 steps
    rheolog table runs/*.rlog --metrics step 2>/dev/null | grep -c ',complete,20,' || true
}
tear() { # gives two runs that have not begun what a killed run leaves: no end, and not even a whole keyframe
    # An engine does not repeat runs that it has seen complete, so those stay as they are.
    while read -r order seed; do
        [ -e "runs/$order-$seed.rlog" ] || echo "runs/$order-$seed.rlog"
    done <sweep.txt >missing
    [ "$(wc -l <missing)" -ge 2 ] || { echo "there are no two runs that have not begun"; exit 1; }
    whole=$tmp/undisturbed/$(head -n 1 missing)
    head -c $(($(wc -c <"$whole") * 3 / 4)) "$whole" >"$(head -n 1 missing)"
    head -c 100 "$tmp/undisturbed/$(tail -n 1 missing)" >"$(tail -n 1 missing)"
    rheolog table "$(head -n 1 missing)" 2>/dev/null | grep -q ',truncated,1[0-9],' || { echo "the torn run has no steps"; exit 1; }
}
same_bytes() { # same_bytes FOLDER: it has the recordings of the undisturbed sweep, and no others
    diff -r "$1" "$tmp/undisturbed/runs"
}
compare() {
    same_bytes runs || { echo "the recordings differ from those of an undisturbed sweep"; exit 1; }
    [ "$(count_complete)" = "$all" ] || { echo "only $(count_complete) of $all recordings are complete"; exit 1; }
    # Proves that one changed bit is found.
    cp -r runs changed
    file=$(find changed -name '*.rlog' | sort | tail -n 1)
    printf '\001' | dd of="$file" bs=1 seek=5000 conv=notrunc 2>/dev/null
    fails "differ" same_bytes changed
    rm -r changed
}
table_of_page() { # the tables of the page have a row for each recording, with its order and its seed
    grep '^rheolog table' "$source/docs/sweeps.md" >tables
    [ "$(wc -l <tables)" -eq 2 ] || { echo "docs/sweeps.md has other tables"; exit 1; }
    sh -e tables >said || { cat said; echo "the tables of the page fail"; exit 1; }
    [ "$(head -n 1 sweep.csv)" = "file,outcome,steps,history.order,seed,time,max_speed,energy" ] ||
        { head -n 1 sweep.csv; echo "sweep.csv has other columns"; exit 1; }
    awk -F, 'NR > 1 { sub(/.*\//, "", $1); print ($1 == $4 "-" $5 ".rlog" && $2 == "complete" && $3 == 20 && $6 == .33) }' \
        sweep.csv >rows
    [ "$(grep -c '^1$' rows)" = "$all" ] || { cat sweep.csv; echo "sweep.csv has a wrong row"; exit 1; }
    [ "$(wc -l <said)" -eq $((all + 1)) ] || { cat said; echo "the table at an event lacks rows"; exit 1; }
}
