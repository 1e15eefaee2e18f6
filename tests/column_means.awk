# Means of the columns of NAME.csv files of `rheolog experiments`, over the steps of each variant: four digits each, and behind
# them in brackets the number of steps if the column has not a number in every step.
FNR == 1 {
    count = split($0, name, ",")
    file = FILENAME
    sub(/.*\//, "", file)
    sub(/\.csv$/, "", file)
    next
}
{
    match($0, /^"[^"]*"/)
    key = file ", " substr($0, 2, RLENGTH - 2)
    if (!(key in rows)) {
        order[++keys] = key
        columns[key] = count
        for (i = 5; i <= count; i++)
            title[key, i] = name[i]
    }
    rows[key]++
    split(substr($0, RLENGTH + 2), cell, ",")
    for (i = 5; i <= count; i++)
        if (cell[i - 1] ~ /^-?[0-9]/) {
            sum[key, i] += cell[i - 1]
            known[key, i]++
        }
}
END {
    for (k = 1; k <= keys; k++) {
        key = order[k]
        line = key ", " rows[key] " steps:"
        for (i = 5; i <= columns[key]; i++) {
            line = line (i > 5 ? ", " : " ") title[key, i]
            if (known[key, i])
                line = line sprintf(" %.4g", sum[key, i] / known[key, i])
            if (known[key, i] + 0 < rows[key])
                line = line " (" known[key, i] + 0 ")"
        }
        print line
    }
}
