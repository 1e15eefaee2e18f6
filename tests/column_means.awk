# Means of the columns of CSV files of `rheolog experiments` and `rheolog rheometer`: four digits each, and behind them in brackets
# the number of rows with a number if not every row has one. Rows of experiments have a variant, a seed, a step and a time first; the
# means are those of a variant.
FNR == 1 {
    count = split($0, name, ",")
    first = name[1] == "variant" ? 5 : 1
    file = FILENAME
    sub(/.*\//, "", file)
    sub(/\.csv$/, "", file)
    next
}
{
    key = file
    rest = $0
    if (first > 1) {
        match($0, /^"[^"]*"/)
        key = file ", " substr($0, 2, RLENGTH - 2)
        rest = substr($0, RLENGTH + 2)
    }
    if (!(key in rows)) {
        order[++keys] = key
        begin[key] = first
        columns[key] = count
        for (i = first; i <= count; i++)
            title[key, i] = name[i]
    }
    rows[key]++
    split(rest, cell, ",")
    for (i = first; i <= count; i++) {
        value = cell[first > 1 ? i - 1 : i]
        if (value ~ /^-?[0-9]/) {
            sum[key, i] += value
            known[key, i]++
        }
    }
}
END {
    for (k = 1; k <= keys; k++) {
        key = order[k]
        line = key ", " rows[key] " rows:"
        for (i = begin[key]; i <= columns[key]; i++) {
            line = line (i > begin[key] ? ", " : " ") title[key, i]
            if (known[key, i])
                line = line sprintf(" %.4g", sum[key, i] / known[key, i])
            if (known[key, i] + 0 < rows[key])
                line = line " (" known[key, i] + 0 ")"
        }
        print line
    }
}
