# Prints a CSV file of `rheolog bench` as the table of the documentation: awk -v table=NAME -f tables.awk FILE (bench/tables.sh).

# Splits a line whose cells may be quoted; returns their number.
function split_cells(line, cell,    n, at) {
    n = 0
    while (1) {
        if (substr(line, 1, 1) == "\"") {
            at = index(substr(line, 2), "\"") + 1
            cell[++n] = substr(line, 2, at - 2)
            line = substr(line, at + 1)
        } else {
            at = index(line ",", ",")
            cell[++n] = substr(line, 1, at - 1)
            line = substr(line, at)
        }
        if (line == "")
            return n
        line = substr(line, 2)
    }
}

# v[line, column] are the cells; lines is the number of lines.
NR == 1 {
    columns = split_cells($0, name)
    next
}
{
    lines++
    split_cells($0, cell)
    for (c = 1; c <= columns; c++)
        v[lines, name[c]] = cell[c]
}

# A cell: a number in a format; nothing is a dash.
function number(format, value) {
    return value == "" ? "–" : sprintf(format, value)
}

# Starts a table with these columns, which have bars between them.
function head(names,    n, i, cell, rule) {
    n = split(names, cell, "|")
    rule = "|"
    for (i = 1; i <= n; i++)
        rule = rule "---|"
    print "| " names " |"
    print rule
}

# Prints a row with the values of a column in all lines.
function across(label, format, column,    l) {
    label = "| " label " |"
    for (l = 1; l <= lines; l++)
        label = label " " number(format, v[l, column]) " |"
    print label
}

# Prints a row of a line: pairs "column format", with semicolons between.
function down(l, pairs,    n, i, pair, words, text) {
    n = split(pairs, pair, ";")
    text = "|"
    for (i = 1; i <= n; i++) {
        split(pair[i], words, " ")
        text = text " " number(words[2], v[l, words[1]]) " |"
    }
    print text
}

# Value of a column in the line of a case.
function of_case(which, column,    l) {
    for (l = 1; l <= lines; l++)
        if (v[l, "case"] == which)
            return v[l, column]
    return ""
}

# The lines of a scene and a scheme, by window.
function windows(label, format, scene, scheme, column, scale,    l, none) {
    label = "| " label " |"
    for (l = 1; l <= lines; l++)
        if (v[l, "case"] == scene && v[l, "scheme"] == scheme) {
            none = v[l, column] == "" || (column ~ /history/ && v[l, "window"] == 0)
            label = label " " number(format, none ? "" : scale * v[l, column]) " |"
        }
    print label
}

function table1(scene,    l, text) {
    text = scene
    for (l = 1; l <= lines; l++)
        if (v[l, "case"] == scene && v[l, "scheme"] == "summed")
            text = text " | " (v[l, "window"] > 0 ? "d = " v[l, "window"] : "none")
    head(text)
    windows("whole step, summed", "%.0f", scene, "summed", "ns_median", 1)
    windows("of which D^q and storing the velocities", "%.0f", scene, "summed", "ns_history_part", 1)
    windows("whole step, sequential", "%.0f", scene, "sequential", "ns_median", 1)
    windows("of which D^q and storing the velocities", "%.0f", scene, "sequential", "ns_history_part", 1)
    windows("memory of the history, MB", "%.0f", scene, "summed", "bytes_history", v[1, "particles"] / 1e6)
    windows("[O]: step without the history", "%d", scene, "sequential", "paper_ns_step", 1)
    windows("[O]: history", "%d", scene, "sequential", "paper_ns_history", 1)
    print ""
}

function features(    fluid, walls) {
    fluid = of_case("fluid", "ns_median")
    walls = of_case("walls", "ns_own")
    head(" | ns per step")
    printf "| fluid alone | %.0f |\n", fluid
    printf "| springs add | %.0f |\n", of_case("springs", "ns_median") - fluid
    printf "| walls add | %.0f |\n", walls
    printf "| a ball adds | %.0f |\n", of_case("ball, walls", "ns_own") - walls
    printf "| vibrators on the floor add | %.0f |\n", of_case("vibrators, walls", "ns_vibrators")
    printf "| outside all stages, in any step | %.0f |\n", of_case("all", "ns_rest")
    printf "\nbytes per particle: fluid alone, state %.0f, library %.0f; with springs and walls, library %.0f\n",
        of_case("fluid", "bytes_state"), of_case("fluid", "bytes_world"), of_case("springs, walls", "bytes_world")
}

function limits(    l, all, limit) {
    head("stage | ns | operations | roots | divisions | bytes | limit, ns | set by")
    for (l = 1; l <= lines; l++) {
        all += v[l, "ns_median"]
        limit += v[l, "ns_limit"]
        down(l, "stage `%s`;ns_median %.1f;operations %.0f;roots %.0f;divisions %.0f;bytes %.0f;ns_limit %.1f;set_by %s")
    }
    printf "| all | %.0f | | | | | %.1f | |\n", all, limit
    printf "\nG/s: operations %s, roots %s, divisions %s; memory, GB/s read: %s\n", v[1, "machine_operations"],
        v[1, "machine_roots"], v[1, "machine_divisions"], v[1, "machine_memory_read"]
}

# Quantities of a scene of the thickening model with their errors.
function thickening(scene, names,    n, i, l, q, text) {
    n = split(names, q, " ")
    text = scene " | substeps per step | µs per particle and time"
    for (i = 1; i <= n; i++)
        text = text " | " q[i]
    head(text)
    for (l = 1; l <= lines; l++) {
        if (v[l, "case"] != scene)
            continue
        text = sprintf("| %s | %.2f | %.1f |", v[l, "setting"], v[l, "substeps"] / v[l, "steps"],
                       v[l, "ns_particle_time"] / 1000)
        for (i = 1; i <= n; i++)
            text = text " " (v[l, q[i]] == "" ? "–" : sprintf("%.3f (%+.1f %%)", v[l, q[i]], 100 * v[l, q[i] "_error"])) " |"
        print text
    }
    print ""
}

function melting(    l) {
    head("setting | substeps | iterations per substep | µs per particle and time | error | hot height")
    for (l = 1; l <= lines; l++)
        if (v[l, "case"] ~ /^melting/)
            printf "| %s | %d | %.1f | %.0f | %.1e | %+.1e |\n", v[l, "setting"], v[l, "substeps"], v[l, "iterations"],
                v[l, "ns_particle_time"] / 1000, v[l, "error"], v[l, "hot_height_error"]
}

# The map of stability: for each solver and step the dip at each ratio, or the step of the first sign of an unstable run, in bold.
# In brackets: springs were softened.
function stability(    l, cells, row, last) {
    for (l = 1; l <= lines && v[l, "solver"] == v[1, "solver"] && v[l, "step"] == v[1, "step"]; l++)
        cells = cells " | " (v[l, "ratio"] + 0)
    head("solver | step" cells)
    for (l = 1; l <= lines; l++) {
        row = v[l, "solver"] " | " (v[l, "step"] + 0)
        if (row != last)
            printf "%s| %s |", (l > 1) ? "\n" : "", row
        last = row
        if (v[l, "stable"] == "no")
            cells = "**" v[l, "bad_step"] "**"
        else if (v[l, "dip"] == "")
            cells = "sinks"
        else
            cells = sprintf((v[l, "softened_springs"] > 0) ? "(%.2f)" : "%.2f", v[l, "dip"])
        printf " %s |", cells
    }
    print ""
}

END {
    if (table == "table1") {
        table1("bowling-ball")
        table1("vibration")
    } else if (table == "history") {
        head("kind | d | whole step | D^q | storing | bytes per particle | error of D^q")
        for (l = 1; l <= lines; l++)
            down(l, "kind %s;window %d;ns_median %.0f;ns_fractional_derivative %.1f;ns_history %.1f;bytes_history %.0f;error %.1e")
    } else if (table == "scaling") {
        text = "particles"
        for (l = 1; l <= lines; l++)
            text = text " | " v[l, "particles"]
        head(text)
        across("whole step, ns", "%.0f", "ns_median")
        across("state, bytes", "%.0f", "bytes_state")
        across("all memory of the library, bytes", "%.0f", "bytes_world")
        across("growth of the process while the scene is made, bytes", "%.0f", "bytes_process")
    } else if (table == "features") {
        features()
    } else if (table == "limits") {
        limits()
    } else if (table == "scenes") {
        head("scene, from step 0 | particles | steps | substeps per step | ns | least | largest")
        for (l = 1; l <= lines; l++)
            down(l, "case %s;particles %d;steps %d;substeps %.1f;ns_median %.0f;ns_least %.0f;ns_largest %.0f")
    } else if (table == "error") {
        thickening("bowling-ball-small", "dip rise depth_5 depth_10 time_1_5")
        thickening("drop", "rebound height_9")
        melting()
    } else if (table == "stability") {
        stability()
    } else if (table == "table2") {
        head("scene | particles | neighbours | substeps per step | iterations per substep")
        for (l = 1; l <= lines; l++)
            down(l, "case %s;particles %d;neighbours %.0f;substeps %.0f;iterations %.1f")
        print ""
        head("scene | all stages | `neighbours` | `momentum` | `viscosity` | `rates` | [P]")
        for (l = 1; l <= lines; l++)
            down(l, "case %s;ns_substep_median %.0f;ns_neighbours %.0f;ns_momentum %.0f;ns_viscosity %.0f;ns_rates %.0f;" \
                    "paper_ns_iteration %d")
    }
    printf "\n%s, %s, %s, simd %s\n\n", v[1, "machine"], v[1, "compiler"], v[1, "real"], v[1, "simd"]
}
