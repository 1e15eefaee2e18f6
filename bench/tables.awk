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

function features(    l) {
    head("scene with | is added to | ns more | its stages, ns | bytes of state more | stages and fields")
    for (l = 1; l <= lines; l++) {
        if (v[l, "base"] == "")
            printf "| %s | | %.0f in all | | %.0f in all | |\n", v[l, "case"], v[l, "ns_least"], v[l, "bytes_state"]
        else
            printf "| %s | %s | %+.0f | %.0f | %+.0f | %s |\n", v[l, "case"], v[l, "base"], v[l, "more_ns"],
                v[l, "ns_own"], v[l, "more_bytes_state"], names(v[l, "stages"], v[l, "fields"])
    }
    printf "\nbytes per particle: fluid alone, state %.0f, library %.0f; with springs and walls, library %.0f\n",
        of_case("fluid", "bytes_state"), of_case("fluid", "bytes_world"), of_case("springs, walls", "bytes_world")
}

# Lists of stages and of fields, in which many words have a sign.
function names(stages, fields) {
    return stages (stages != "" && fields != "" ? "; " : "") fields
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

# A study of `rheolog bench error`: a table per scene, with a row per setting and a column per quantity. Points on the front are
# bold.
function study(    l, k, scenes, scene, settings, setting, quantities, quantity, at, timed, text, n, i, q) {
    for (l = 1; l <= lines; l++)
        if (!((v[l, "scene"]) in at))
            at[scene[++scenes] = v[l, "scene"]] = 1
    for (n = 1; n <= scenes; n++) {
        split("", at)
        settings = quantities = timed = 0
        for (l = 1; l <= lines; l++) {
            if (v[l, "scene"] != scene[n])
                continue
            if (!(("setting", v[l, "setting"]) in at))
                at["setting", setting[++settings] = v[l, "setting"]] = l
            if (!(("quantity", v[l, "quantity"]) in at))
                at["quantity", quantity[++quantities] = v[l, "quantity"]] = 1
            at[v[l, "setting"], v[l, "quantity"]] = l
            timed = timed || v[l, "us_time"] != ""
        }
        text = scene[n] " | " (timed ? "µs per particle and time" : "ns per particle and step")
        for (q = 1; q <= quantities; q++)
            text = text " | " quantity[q]
        head(text)
        for (i = 1; i <= settings; i++) {
            l = at["setting", setting[i]]
            text = "| " setting[i] " | " (timed ? number("%.1f", v[l, "us_time"]) : number("%.0f", v[l, "ns_step"])) " |"
            for (q = 1; q <= quantities; q++) {
                k = at[setting[i], quantity[q]]
                text = text " " (k ? error_of(k) : "") " |"
            }
            print text
        }
        print ""
    }
}

# The values of a scene of a study, by step, for schemes that match a pattern.
function values(scene, schemes,    l, k, settings, setting, quantities, quantity, at, text, i, q) {
    for (l = 1; l <= lines; l++) {
        if (v[l, "scene"] != scene || v[l, "setting"] !~ "^(" schemes "), step")
            continue
        if (!(("setting", v[l, "setting"]) in at))
            at["setting", setting[++settings] = v[l, "setting"]] = 1
        if (!(("quantity", v[l, "quantity"]) in at))
            at["quantity", quantity[++quantities] = v[l, "quantity"]] = 1
        at[v[l, "setting"], v[l, "quantity"]] = l
    }
    if (!settings)
        return
    text = scene
    for (q = 1; q <= quantities; q++)
        text = text " | " quantity[q]
    head(text)
    for (i = 1; i <= settings; i++) {
        text = "| " setting[i] " |"
        for (q = 1; q <= quantities; q++) {
            k = at[setting[i], quantity[q]]
            text = text " " number("%.3f", k ? v[k, "value"] : "") " |"
        }
        print text
    }
    print ""
}

# An error in percent if it is large enough, with its order.
function error_of(l,    error, text) {
    if (v[l, "error"] == "")
        return "–"
    error = v[l, "error"] + 0
    text = error == 0 ? "0" : error < 0.001 && error > -0.001 ? sprintf("%+.1e", error) : sprintf("%+.1f %%", 100 * error)
    if (v[l, "order"] != "")
        text = text " (" sprintf("%.1f", v[l, "order"]) ")"
    return v[l, "front"] == 1 ? "**" text "**" : text
}

# The line of a scene, a setting and a quantity; 0: none. Builds an index once.
function line_of(scene, setting, quantity,    l) {
    if (!indexed)
        for (l = indexed = 1; l <= lines; l++)
            line_at[v[l, "scene"], v[l, "setting"], v[l, "quantity"]] = l
    return (scene, setting, quantity) in line_at ? line_at[scene, setting, quantity] : 0
}

# Lists the distinct settings of a quantity, in their order; returns their number.
function settings_of(quantity, setting,    l, n, seen) {
    for (l = 1; l <= lines; l++)
        if (v[l, "quantity"] == quantity && !((v[l, "setting"]) in seen)) {
            seen[v[l, "setting"]] = 1
            setting[++n] = v[l, "setting"]
        }
    return n
}

# Errors of a quantity in several scenes: a row per setting, which begins with these columns ("column format;...") if there are any.
function across_scenes(first, heads, pairs, quantity, scenes,    n, i, k, l, m, setting, scene, text, count, pair, words, x) {
    n = split(scenes, scene, "|")
    text = first
    if (heads != "")
        text = text " | " heads
    for (k = 1; k <= n; k++)
        text = text " | " scene[k]
    head(text)
    m = settings_of(quantity, setting)
    count = split(pairs, pair, ";")
    for (i = 1; i <= m; i++) {
        text = "| " setting[i] " |"
        l = line_of(scene[1], setting[i], quantity)
        for (k = 1; k <= count; k++) {
            split(pair[k], words, " ")
            text = text " " number(words[2], v[l, words[1]]) " |"
        }
        for (k = 1; k <= n; k++) {
            x = line_of(scene[k], setting[i], quantity)
            text = text " " (x ? error_of(x) : "–") " |"
        }
        print text
    }
    print ""
}

# The largest error of a quantity in all scenes, by q.
function largest_by_order(quantity,    l, n, i, k, setting, largest, text, q, x) {
    split(".2 .5 .8", q, " ")
    for (l = 1; l <= lines; l++)
        for (k = 1; k <= 3; k++)
            if (v[l, "quantity"] == quantity && substr(v[l, "scene"], length(v[l, "scene"]) - 5) == "q = " q[k]) {
                x = v[l, "error"] + 0
                if (x > largest[v[l, "setting"], k])
                    largest[v[l, "setting"], k] = x
            }
    head("setting | q = .2 | q = .5 | q = .8")
    n = settings_of(quantity, setting)
    for (i = 1; i <= n; i++) {
        text = "| " setting[i] " |"
        for (k = 1; k <= 3; k++)
            text = text " " sprintf("%.1e", largest[setting[i], k]) " |"
        print text
    }
    print ""
}

function history(    l, n, i, k, setting, text, q) {
    across_scenes("memory", "ns | bytes", "ns_step %.0f;bytes %.0f", "D^q",
                  "t^2, q = .5|t^3, q = .5|sine, q = .5|exp, q = .5|impact, q = .5|steady, q = .5|steady, q = .2|steady, q = .8")
    across_scenes("rule", "", "", "D^q, all steps", "t^2, q = .5|t^3, q = .5|sine, q = .5|exp, q = .5|impact, q = .5|sine, q = .2|sine, q = .8")
    largest_by_order("D^q of kind window")
    split(".2 .5 .8", q, " ")
    head("lags | exponentials | q = .2 | q = .5 | q = .8")
    n = settings_of("exponentials", setting)
    for (i = 1; i <= n; i++) {
        text = "| " setting[i] " | " sprintf("%d", v[line_of("fit, q = .5", setting[i], "exponentials"), "value"]) " |"
        for (k = 1; k <= 3; k++)
            text = text " " sprintf("%.0e", v[line_of("fit, q = " q[k], setting[i], "exponentials"), "error"]) " |"
        print text
    }
    print ""
}

# Growth of an ulp: float, double, and an ulp of float in double.
function number_study(    l, n, i, k, scene, seen, text, cell, words, setting, x) {
    for (l = 1; l <= lines; l++)
        if (!((v[l, "scene"]) in seen)) {
            seen[v[l, "scene"]] = 1
            scene[++n] = v[l, "scene"]
        }
    head("scene | particles | float: after 1 step | 30 | 100 | 300 | T, float | T, double | double: 1 | 100 | an ulp of float in double: 100 | ns, float | ns, double")
    setting["f"] = "float"
    setting["d"] = "double"
    setting["u"] = "double, an ulp of float"
    for (i = 1; i <= n; i++) {
        l = line_of(scene[i], "float", "difference at step 1")
        text = "| " scene[i] " | " v[l, "particles"] " |"
        k = split("f 1;f 30;f 100;f 300;f T;d T;d 1;d 100;u 100;f ns;d ns", cell, ";")
        for (l = 1; l <= k; l++) {
            split(cell[l], words, " ")
            x = line_of(scene[i], setting[words[1]], words[2] == "T" ? "Lyapunov time" : "difference at step " (words[2] == "ns" ? 1 : words[2]))
            text = text " " (!x ? "–" : words[2] == "ns" ? number("%.0f", v[x, "ns_step"]) : number(words[2] == "T" ? "%.2f" : "%.0e", v[x, "value"])) " |"
        }
        print text
    }
    print ""
}

# Values of a scene by spacing: error and order, and how far seeds are from their mean.
function spacing(scene,    l, n, i, k, setting, quantities, quantity, text, x, seen) {
    text = scene " | particles | µs per time and particle of resolution 1"
    for (l = 1; l <= lines; l++)
        if (v[l, "scene"] == scene && v[l, "quantity"] !~ / by seed$/ && !((v[l, "quantity"]) in seen)) {
            seen[v[l, "quantity"]] = 1
            quantity[++quantities] = v[l, "quantity"]
            text = text " | " v[l, "quantity"]
        }
    if (!quantities)
        return
    head(text)
    n = settings_of(quantity[1], setting)
    for (i = 1; i <= n; i++) {
        l = line_of(scene, setting[i], quantity[1])
        text = "| " setting[i] " | " v[l, "particles"] " | " number("%.0f", v[l, "us_time"]) " |"
        for (k = 1; k <= quantities; k++) {
            l = line_of(scene, setting[i], quantity[k])
            x = v[line_of(scene, setting[i], quantity[k] " by seed"), "value"]
            text = text " " number("%.3f", v[l, "value"]) (x == "" ? "" : sprintf(" ± %.3f", x * v[l, "value"])) ": " error_of(l) " |"
        }
        print text
    }
    print ""
}

# A value with its order; bold on the front.
function value_of(l,    text) {
    if (!l || v[l, "value"] == "")
        return "–"
    text = sprintf("%.1e", v[l, "value"])
    if (v[l, "order"] != "")
        text = text " (" sprintf("%.1f", v[l, "order"]) ")"
    return v[l, "front"] == 1 ? "**" text "**" : text
}

# Differences of images, spin of a drop and pressure of a pool: a row per setting.
function sweeps(    i, n, l, m, k, setting, column, words, text) {
    m = split("image mirrored_1;image mirrored;image rotated_1;image rotated;image renumbered_1;image renumbered;free-drop spin", column, ";")
    head("setting | µs per particle and time | mirrored, 1 step | 3.3 T | rotated, 1 step | 3.3 T | renumbered, 1 step | 3.3 T | spin | pressure")
    n = settings_of("mirrored_1", setting)
    for (i = 1; i <= n; i++) {
        text = "| " setting[i] " | " number("%.1f", v[line_of("image", setting[i], "mirrored_1"), "us_time"]) " |"
        for (k = 1; k <= m; k++) {
            split(column[k], words, " ")
            text = text " " value_of(line_of(words[1], setting[i], words[2])) " |"
        }
        l = line_of("hydrostatics", setting[i], "pressure")
        print text " " (l ? error_of(l) : "–") " |"
    }
    print ""
}

# Errors by stiffness, and the largest stiffness that each setting holds.
function springs(    i, n, l, setting, scenes) {
    scenes = "ball-10|ball-30|ball-100|ball-300|ball-1000|ball-3000|ball-10000"
    across_scenes("dip", "µs at 10", "us_time %.1f", "dip", scenes)
    across_scenes("depth after 3 T, in R", "", "", "depth_3", scenes)
    head("setting | k_hist/k_min reached | µs per particle and time, there")
    n = settings_of("ratio_reached", setting)
    for (i = 1; i <= n; i++) {
        l = line_of("ball", setting[i], "ratio_reached")
        print "| " setting[i] " | " number("%d", v[l, "value"]) " | " number("%.1f", v[l, "us_time"]) " |"
    }
    print ""
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
    } else if (table == "error-history") {
        history()
    } else if (table == "error-number") {
        number_study()
    } else if (table == "error-spacing") {
        spacing("ball")
        spacing("drop")
    } else if (table == "error-sweeps") {
        sweeps()
    } else if (table == "error-springs") {
        springs()
    } else if (table ~ /^error-/) {
        study()
        if (table == "error-steps") {
            values("ball", "summed|sequential")
            values("drop", "summed|sequential")
        }
    } else if (table == "stability") {
        stability()
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
