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

# A rate in per cent.
function rate(value) {
    return value == "" ? "–" : sprintf("%.0f %%", 100 * value)
}

function predictor(    l, m) {
    head("scenes | measure | kind | bound | below | of them blew up | below, others in range | of them blew up | above | " \
         "of them blew up | false alarms | misses | least that blew up | most that stayed well | lead, steps")
    for (l = 1; l <= lines; l++) {
        m = v[l, "measure"]
        if (v[l, "below"] + v[l, "above"] == 0) # no scene has it
            continue
        printf "| %s | %s | %s | %s | %d | %d | %d | %d | %d | %d | %s | %s | %s | %s | %s |\n", v[l, "group"],
            v[l, "kind"] ~ /doctor|signs/ ? (m == "unhealthy" ? "unhealthy" : "any condition or precursor") : "`" m "`",
            v[l, "kind"] ~ /doctor|signs/ ? "–" : v[l, "kind"], number("%.3g", v[l, "bound"]), v[l, "below"],
            v[l, "below_blew_up"], v[l, "alone"], v[l, "alone_blew_up"], v[l, "above"], v[l, "above_blew_up"],
            rate(v[l, "false_alarms"]), rate(v[l, "misses"]), number("%.3g", v[l, "least_blew_up"]),
            number("%.3g", v[l, "most_well"]), number("%.1f", v[l, "lead"])
    }
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
    } else if (table == "predictor") {
        predictor()
        exit
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
