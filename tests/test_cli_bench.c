/* `rheolog bench` from outside. */
#define _POSIX_C_SOURCE 200809L
#include "cli_support.h"

#include <signal.h>
#include <sys/stat.h>

/* ---- bench ---- */

/* Small enough to run fast; the timings are meaningless. */
#define TINY "--particles 500 --settle 5 --steps 2 --repetitions 1 --quiet"
#define TWICE "--particles 500 --settle 5 --steps 2 --repetitions 2 --quiet"

static size_t lines_of(const char *text)
{
    size_t lines = 0;
    for (; *text; text++)
        lines += *text == '\n';
    return lines;
}

/* Splits a line of the CSV in `out` into cells, which may be quoted; returns their number. */
static size_t split_line(size_t line, char cell[][260], size_t most)
{
    const char *at = out;
    while (line-- > 0)
        at = strchr(at, '\n') + 1;
    for (size_t n = 1;; n++) {
        const char *end = *at == '"' ? strchr(at + 1, '"') + 1 : at + strcspn(at, ",\n");
        const size_t length = (size_t)(end - at);
        assert_true(n <= most);
        snprintf(cell[n - 1], 260, "%.*s", (int)length, at);
        if (at[length] == '\n')
            return n;
        at += length + 1;
    }
}

/* Returns a cell of the CSV in `out`. */
static const char *cell_of(size_t line, const char *name)
{
    static char names[96][260], cells[96][260];
    const size_t count = split_line(0, names, 96);
    assert_int_equal(split_line(line, cells, 96), count);
    for (size_t i = 0; i < count; i++)
        if (strcmp(names[i], name) == 0)
            return cells[i];
    fail_msg("no column %s", name);
    return NULL;
}

static double number_of(size_t line, const char *name)
{
    const char *text = cell_of(line, name);
    assert_true(*text != 0);
    return strtod(text, NULL);
}

static void bench_has_its_columns(void **state)
{
    (void)state;
    assert_code(0, run("bench table1 --windows 0,5 " TWICE " --csv"));
    assert_string_equal(err, "");
    assert_int_equal(lines_of(out), 1 + 8);
    for (size_t line = 1; line <= 8; line++) {
        const bool history = line % 2 == 0, ball = line <= 4, summed = (line - 1) / 2 % 2 == 0;
        assert_string_equal(cell_of(line, "case"), ball ? "bowling-ball" : "vibration");
        assert_string_equal(cell_of(line, "scheme"), summed ? "summed" : "sequential");
        assert_in(history ? "5" : "0", cell_of(line, "window"));
        assert_string_equal(cell_of(line, "kind"), history ? "window" : "");
        assert_true(number_of(line, "particles") > 400 && number_of(line, "particles") < 600);
        assert_true(number_of(line, "ns_least") > 0);
        assert_true(number_of(line, "ns_least") <= number_of(line, "ns_median"));
        assert_true(number_of(line, "ns_median") <= number_of(line, "ns_largest"));
        assert_true((*cell_of(line, "ns_densities") != 0) == summed);
        assert_true((*cell_of(line, "ns_spring_displacement") != 0) == !summed);
        assert_true((*cell_of(line, "ns_fractional_derivative") != 0) == history);
        assert_true((*cell_of(line, "ns_vibrators") != 0) == !ball);
        assert_true((*cell_of(line, "ns_ball") != 0) == ball);
        assert_true((*cell_of(line, "paper_ns_step") != 0) == !history); /* the paper has no d = 5 */
        assert_true(number_of(line, "bytes_history") == (history ? 6. * 3 * sizeof(rheo_real) : 0));
        assert_true(number_of(line, "bytes_world") > number_of(line, "bytes_state"));
        assert_int_equal(strlen(cell_of(line, "hash")), 16);
        assert_true(number_of(line, "steps") == 2 && number_of(line, "repetitions") == 2);
        assert_in(cell_of(line, "compiler"), rheo_build());
        assert_string_equal(cell_of(line, "simd"), rheo_simd());
    }
    assert_true(number_of(1, "paper_ns_step") == 61300);
    /* Another run has the same hashes, with any SIMD variant. */
    char hash[32];
    snprintf(hash, sizeof hash, "%s", cell_of(2, "hash"));
    assert_code(0, run("bench table1 --windows 5 --scheme summed --simd scalar " TINY " --csv"));
    assert_int_equal(lines_of(out), 1 + 2);
    assert_string_equal(cell_of(1, "simd"), "scalar");
    assert_string_equal(cell_of(1, "hash"), hash);
}

static void bench_json_has_the_names_of_csv(void **state)
{
    (void)state;
    static char names[96][260];
    assert_code(0, run("bench history --windows 5 " TINY " --csv"));
    const size_t count = split_line(0, names, 96), lines = lines_of(out);
    /*
     * Every kind of history is listed. The exact window has rounding errors only, the others the error of their fit.
     */
    static const char *const kinds[] = {"window", "window-fast", "full", "tempered"};
    assert_int_equal(lines, 1 + sizeof kinds / sizeof *kinds);
    for (size_t line = 1; line < lines; line++) {
        const double error = number_of(line, "error");
        assert_string_equal(cell_of(line, "kind"), kinds[line - 1]);
        assert_true(error >= 0 && error < (line == 1 ? 1e-5 : 5e-3));
        assert_true(number_of(line, "bytes_history") > 0);
    }
    assert_code(0, run("bench history --windows 5 " TINY " --json"));
    assert_int_equal(lines_of(out), lines - 1);
    for (size_t i = 0; i < count; i++) {
        const char *const keys[] = {names[i], NULL};
        for (const char *line = out; *line; line = strchr(line, '\n') + 1)
            assert_keys(line, keys);
    }
    assert_string_equal(value_of("case"), "\"bowling-ball\"");
    assert_string_equal(value_of("kind"), "\"window\"");
    assert_string_equal(value_of("window"), "5");
}

static void bench_prints_tables(void **state)
{
    (void)state;
    assert_code(0, run("bench table1 --windows 5 --scheme sequential " TINY));
    assert_in("scene", out);
    assert_in("scheme sequential, d = 5", out);
    assert_in("vibration ", out);
    assert_in("this machine at best", out);
    assert_in("fractional_derivative ", out);
    assert_in("set by", out);
    assert_code(0, run("bench history --windows 5 " TINY));
    assert_in("bytes/part.", out);
    assert_code(0, run("bench scaling " TINY));
    assert_in("ratio", out);
    assert_in(" 1.00 ", out);
    assert_code(0, run("bench scenes --scenes melting-box,bowling-ball-small --settle 1 --steps 1 --repetitions 1"));
    assert_in("melting-box, 2000 particles, steps 0 to 1,", out);
    assert_in("bowling-ball-small, scheme summed, 5760 particles, steps 0 to 1,", out);
    assert_code(0, run("bench features --particles 500 --settle 5 --steps 2 --repetitions 1"));
    assert_in("springs, walls", out);
    assert_in("+viscosity; +predicted_acceleration\n", out);
    assert_in("recorded: the recording grows by ", out);
}

static void bench_limits_have_a_line_per_stage(void **state)
{
    (void)state;
    assert_code(0, run("bench limits " TINY " --csv"));
    assert_string_equal(cell_of(1, "scheme"), "summed");
    assert_int_equal(strlen(cell_of(1, "hash")), 16);
    assert_string_equal(cell_of(1, "stage"), "neighbours");
    assert_true(number_of(1, "machine_operations") > 0 && number_of(1, "machine_roots") > 0);
    assert_true(number_of(1, "machine_divisions") > 0 && number_of(1, "machine_memory_read") > 0);
    assert_true(number_of(3, "ns_limit") > 0);
    assert_string_equal(cell_of(lines_of(out) - 1, "stage"), "rest");
}

static void bench_features_have_their_stages(void **state)
{
    (void)state;
    assert_code(0, run("bench features " TINY " --csv"));
    assert_string_equal(cell_of(1, "case"), "fluid");
    assert_true(number_of(1, "ns_own") == 0);
    assert_true(number_of(1, "bytes_history") == 0);
    assert_string_equal(cell_of(1, "ns_fractional_derivative"), "");
    size_t last = 1;
    while (strcmp(cell_of(last, "case"), "all") != 0)
        last++;
    assert_true(number_of(last, "ns_own") > 0);
    static const char *const own[] = {"ns_fractional_derivative", "ns_ball", "ns_walls", "ns_vibrators"};
    for (size_t i = 0; i < sizeof own / sizeof *own; i++)
        assert_true(number_of(last, own[i]) > 0);
    /* The columns add up to the total. */
    const double sum = number_of(last, "ns_common") + number_of(last, "ns_own") + number_of(last, "ns_rest");
    assert_true(sum > .999 * number_of(last, "ns_median") - .1 && sum < 1.001 * number_of(last, "ns_median") + .1);
    /* A part is compared with the scene without it. */
    size_t line = 1;
    while (strcmp(cell_of(line, "case"), "\"melting, viscosity\"") != 0)
        line++;
    assert_string_equal(cell_of(line, "base"), "melting");
    assert_string_equal(cell_of(line, "stages"), "+viscosity");
    assert_string_equal(cell_of(line, "fields"), "+predicted_acceleration");
    const double more = number_of(line, "more_bytes_state");
    assert_true(more == 12 || more == 24); /* three numbers, in float or double */
    for (line = 1; strcmp(cell_of(line, "case"), "recorded") != 0; line++)
        assert_true(number_of(line, "bytes_recorded") == 0);
    assert_true(number_of(line, "bytes_recorded") > 0 && number_of(line, "more_bytes_state") == 0);
    assert_code(0, run("bench scaling " TINY " --csv"));
    assert_int_equal(lines_of(out), 2);
    assert_true(number_of(1, "ratio") == 1);
    assert_true(number_of(1, "window") == 4);
}

/* A quick run ends before any quantity is measured; whole runs take minutes. */
static void bench_error_has_a_line_per_point(void **state)
{
    (void)state;
    assert_code(0, run("bench error --study steps --scenes ball,drop --settle 5 --steps 2 --csv --quiet"));
    assert_string_equal(err, "");
    assert_int_equal(
        strncmp(out,
                "study,model,scene,setting,series,refinement,quantity,value,reference,error,ns_step,us_time,bytes,"
                "substeps,iterations,particles,steps,hash,order,front,machine,compiler,real,simd\n",
                strcspn(out, "\n") + 1),
        0);
    const size_t lines = lines_of(out), settings = (lines - 1) / 8; /* 5 quantities of the ball, 3 of the drop */
    assert_true(settings > 10 && lines == 1 + 8 * settings);
    for (size_t line = 1; line < lines; line++) {
        assert_string_equal(cell_of(line, "study"), "steps");
        assert_in(line <= 5 * settings ? "ball" : "drop", cell_of(line, "scene"));
        assert_true(number_of(line, "ns_step") > 0);
        assert_true(number_of(line, "us_time") > 1e-3 * number_of(line, "ns_step"));
        assert_string_equal(cell_of(line, "value"), "");
        assert_string_equal(cell_of(line, "front"), "0");
    }
    assert_string_equal(cell_of(1, "setting"), "\"summed, step/16\"");
    assert_true(number_of(1, "steps") == 32 && number_of(1, "substeps") >= 64);
    assert_code(0, run("bench error --study steps --scenes drop --settle 5 --steps 1 --quiet"));
    assert_in("\n  sequential, step/2 ", out);
    assert_in("limit step -> 0", out);
}

static void bench_error_writes_files(void **state)
{
    (void)state;
    assert_code(0, run("bench error --study bunny --particles 300 --steps 1 --json --quiet -o errors"));
    assert_string_equal(value_of("scene"), "\"bunny\"");
    assert_string_equal(value_of("quantity"), "\"hot height\"");
    static char text[1 << 16];
    read_file("errors/error-bunny-bunny-hot-height.svg", text, sizeof text);
    assert_in("cost, µs per particle and unit of time", text);
    assert_in(">front<", text);
    read_file("errors/error-bunny.csv", text, sizeof text);
    assert_in("\nbunny,melting,bunny,courant 0.1,courant,", text);
    assert_int_equal(lines_of(text), lines_of(out) + 1);
    assert_code(2, run("bench error --study bunny --csv -o errors/error-bunny.csv"));
    assert_code(2, run("bench table1 -o errors"));
    assert_in("table1 takes no --output; error, stability and predictor do", err);
}

static void bench_error_refuses_unknown_studies(void **state)
{
    (void)state;
    assert_code(2, run("bench error --study steps,drag"));
    assert_in("there is no study \"drag\"; there are ", err);
    assert_in("steps", err);
    assert_code(2, run("bench error --study step"));
    assert_code(2, run("bench error --study \"\""));
    assert_code(2, run("bench error --study bunny --model thickening"));
    assert_in("no study of --study bunny is of the model thickening", err);
    assert_code(2, run("bench table1 --study steps"));
    assert_in("table1 takes no --study; error does", err);
    assert_code(2, run("bench error --model drag"));
    assert_in("--model is thickening or melting; got \"drag\"", err);
    assert_code(2, run("bench table1 --model melting"));
    assert_in("table1 takes no --model; error does", err);
    assert_code(2, run("bench error --steps 0"));
    assert_in("--steps must be at least 1", err);
}

/* ---- Another program as baseline ---- */

/*
 * Writes a program that passes for rheolog, and does with the measurements what `how` says. The measurement is
 * scaling, which has one case.
 */
static void write_baseline(const char *how)
{
    char text[2048];
    snprintf(text, sizeof text,
             "#!/bin/sh\n"
             "case \"$*\" in\n"
             "--version) printf 'rheolog 0.0.1\\nrheolog 0.0.1, a compiler\\nkernels: x (in use: x)\\n'; exit ;;\n"
             "*--help | *--parameters) \"$RHEOLOG\" \"$@\"; exit ;;\n"
             "esac\n%s\n",
             how);
    write_file("old", text, strlen(text));
    assert_int_equal(chmod("old", 0755), 0);
}

#define COMPARE "bench scaling --baseline ./old --settle 1 --steps 1 --particles 200 --quiet"

static void bench_compares_with_an_older_program(void **state)
{
    (void)state;
    /* It has another stage, no schemes and other cases, and takes ages. */
    write_baseline(
        "echo '{\"case\": \"bowling-ball\", \"particles\": 200, \"window\": 4, \"ns_median\": 1e12,"
        " \"ns_density\": 2e11, \"ns_gravity\": 1e9, \"ns_common\": 7, \"ns_walls\": null, \"ns_rest\": 5e8,"
        " \"hash\": \"0123456789abcdef\"}'\n"
        "echo '{\"case\": \"tilted\", \"ns_median\": 3}'");
    assert_code(0, run(COMPARE));
    assert_in("baseline  rheolog 0.0.1, a compiler, simd x\n          ./old\n", out);
    assert_in("OTHER RESULTS", out);
    assert_in("only here\n", out);
    assert_in("only baseline\n", out);
    assert_in("  faster\n", out);
    assert_in("cases only in the baseline: tilted\n", out);
    assert_code(0, run(COMPARE " --csv"));
    assert_string_equal(err, "");
    static const char *const stages[] = {"density", "forces", "gravity", "rest", "all"};
    size_t seen = 0;
    for (size_t line = 1; line < lines_of(out); line++) {
        const char *stage = cell_of(line, "stage");
        for (size_t s = 0; s < 5; s++)
            if (strcmp(stage, stages[s]) == 0) {
                seen |= (size_t)1 << s;
                assert_true((*cell_of(line, "ns_median") != 0) == (s != 0));
                assert_true((*cell_of(line, "baseline_ns_median") != 0) == (s != 1));
                assert_string_equal(cell_of(line, "change"), s < 2 ? "" : "faster");
            }
        if (strcmp(stage, "all") == 0) {
            assert_true(number_of(line, "baseline_ns_median") == 1e12);
            assert_true(number_of(line, "ratio") < 1e-4);
            assert_true(number_of(line, "rounds") == 5);
        }
        assert_string_not_equal(stage, "common");
        assert_string_not_equal(stage, "walls_");
        assert_string_equal(cell_of(line, "results"), "other");
        assert_string_equal(cell_of(line, "baseline_hash"), "0123456789abcdef");
    }
    assert_true(seen == 31);
}

/* A program against itself has the same results; two rounds cannot tell that it is faster. */
static void bench_compares_a_program_with_itself(void **state)
{
    (void)state;
    assert_code(0,
                run("bench scaling --baseline \"$RHEOLOG\" --settle 1 --steps 1 --particles 200 --rounds 2 --quiet"));
    assert_in("same results, hash ", out);
    assert_in("too few rounds", out);
    assert_null(strstr(out, "only "));
    assert_code(0,
                run("bench scenes --scenes melting-box --baseline \"$RHEOLOG\" --steps 1 --rounds 1 --json --quiet"));
    assert_string_equal(value_of("results"), "\"same\"");
    assert_string_equal(value_of("particles"), "2000");
    assert_in("\"stage\": \"viscosity\"", out);
    /* An option that an older program calls by another name. */
    write_baseline(
        "case \"$*\" in *'--kernels scalar'*) exec \"$RHEOLOG\" bench scaling --settle 1 --steps 1 --particles 200 "
        "--simd scalar --repetitions 1 --json ;; esac");
    write_file("help.txt", "--kernels --settle\n", 19);
    assert_code(0, run("bench scaling --help >/dev/null"));
    assert_code(0, system("sed -i 's/^\\*--help.*$/*--help | *--parameters) cat help.txt; exit ;;/' old"));
    assert_code(0, run(COMPARE " --rounds 1 --simd scalar --json"));
    assert_string_equal(value_of("results"), "\"same\"");
    write_file("help.txt", "--settle\n", 9);
    assert_code(2, run(COMPARE " --rounds 1 --simd scalar --json"));
    assert_one_message("the baseline ./old has no option --simd");
}

static void refuse_baseline(const char *how, const char *message)
{
    write_baseline(how);
    assert_code(2, run(COMPARE " --rounds 2 --timeout %d", strstr(how, "sleep") ? 2 : 300));
    assert_one_message(message);
}

static void bench_refuses_a_bad_baseline(void **state)
{
    (void)state;
    refuse_baseline("echo rubbish", "prints \"rubbish\", which is no result");
    refuse_baseline("echo '{\"case\": \"bowling-ball\", \"ns_median\": 1'", "which is no result");
    refuse_baseline("echo '{\"case\": \"bowling-ball\"}'", "which is no result");
    refuse_baseline("echo '[[[[[[[[[[[[]]]]]]]]]]]]'", "which is no result");
    refuse_baseline(":", "prints \"nothing\", which is no result");
    refuse_baseline("head -c 20000000 /dev/zero | tr '\\0' '\\n'", "prints more than 16777216 bytes");
    refuse_baseline("echo 'rheolog bench: there is no measurement' >&2; exit 2",
                    "ended with exit code 2: rheolog bench: there is no measurement");
    refuse_baseline("exit 7", "ended with exit code 7 and no message");
    refuse_baseline("kill -11 $$", "was ended by signal 11");
    refuse_baseline("echo '{\"case\": \"tilted\", \"ns_median\": 3}'", "has none of the cases of bench scaling");
    refuse_baseline("echo '{\"case\": \"bowling-ball\", \"ns_median\": 3, \"hash\": \"'$$'\"}'",
                    "a build whose results change cannot be measured");
    refuse_baseline("[ -e once ] && echo '{\"case\": \"tilted\", \"ns_median\": 3}' || "
                    "{ touch once; echo '{\"case\": \"bowling-ball\", \"ns_median\": 3}'; }",
                    "measured other cases in round 2");
    assert_code(2, run("bench limits --baseline /bin/echo"));
    assert_one_message("the baseline /bin/echo is not rheolog: its --version prints");
    assert_code(2, run("bench limits --baseline ./none"));
    assert_one_message("the baseline ./none --version cannot be run: No such file or directory");
    write_file("old", "#!/bin/sh\n", 10);
    assert_int_equal(chmod("old", 0644), 0);
    assert_code(2, run(COMPARE));
    assert_one_message("cannot be run: Permission denied");
}

/* A program that hangs is ended, with those that it started. */
static void bench_ends_a_baseline_that_hangs(void **state)
{
    (void)state;
    char number[32];
    refuse_baseline("sleep 100 & echo $! >sleeper; wait", "did not end within 2 s");
    read_file("sleeper", number, sizeof number);
    for (int tries = 0; kill((pid_t)atoi(number), 0) == 0 && tries < 100; tries++)
        assert_code(0, system("sleep 0.05"));
    assert_int_equal(kill((pid_t)atoi(number), 0), -1);
    refuse_baseline("exec >/dev/null 2>&1; sleep 100", "did not end within 2 s");
}

/* An event of a trace, which has its own line. */
typedef struct span {
    char name[64], category[16];
    double begin, end, step, substep; /* substep 0: none */
} span;

/* Reads the next event of a category; false: there is no more. */
static bool next_span(const char **at, const char *category, span *s)
{
    char wanted[64];
    snprintf(wanted, sizeof wanted, "\"cat\": \"%s\"", category);
    const char *found = strstr(*at, wanted);
    if (!found)
        return false;
    const char *line = found;
    while (line[-1] != '\n')
        line--;
    *s = (span){.substep = 0};
    assert_int_equal(sscanf(line, " {\"name\": \"%63[^\"]\"", s->name), 1);
    *at = found;
    s->begin = number_after(at, "ts");
    s->end = s->begin + number_after(at, "dur");
    s->step = number_after(at, "step");
    const char *end = strchr(*at, '\n'), *substep = strstr(*at, "\"substep\"");
    if (substep && substep < end)
        s->substep = number_after(at, "substep");
    *at = end;
    return true;
}

/* Ten steps in order; every stage lies in its step and its substep, and none overlaps the one before it. */
static void a_trace_has_the_stages_of_steps(void **state)
{
    (void)state;
    static char text[1 << 18];
    assert_code(0, run("bench history --windows 5 " TINY " --trace trace.json --csv"));
    assert_true(lines_of(out) == 5);
    assert_true(file_size("trace.json") < (long)sizeof text - 1);
    read_file("trace.json", text, sizeof text);
    assert_in("\"traceEvents\": [", text);
    assert_in("\"name\": \"process_name\", \"ph\": \"M\", \"pid\": 4, ", text);
    assert_in("bowling-ball, summed, window-fast, d = 5", text);
    const char *in_steps = text, *in_substeps = text, *in_stages = text;
    span step = {.end = -1}, substep = {.step = -1}, stage, before = {.end = -1};
    int stages = 0, steps = 0, substeps = 0, of_substeps = 0;
    while (next_span(&in_stages, "stage", &stage)) {
        if (stage.begin >= step.end) {
            span last = step;
            assert_true(next_span(&in_steps, "step", &step));
            assert_true(step.begin >= last.end && (steps % 10 == 0 || step.step == last.step + 1));
            steps++;
        }
        if (stage.substep > 0 && (stage.step != substep.step || stage.substep != substep.substep)) {
            assert_true(next_span(&in_substeps, "substep", &substep));
            substeps++;
        }
        const double rounding = 2e-3;
        assert_true(stage.begin >= step.begin - rounding && stage.end <= step.end + rounding &&
                    stage.step == step.step);
        assert_true(stage.end >= stage.begin && stage.begin >= before.end - rounding);
        if (stage.substep > 0) {
            assert_true(stage.begin >= substep.begin - rounding && stage.end <= substep.end + rounding);
            assert_true(strcmp(stage.name, "neighbours") != 0 && strcmp(stage.name, "history") != 0);
            of_substeps += strcmp(stage.name, "forces") == 0;
        }
        before = stage;
        stages++;
    }
    assert_int_equal(steps, 40); /* of four kinds */
    assert_int_equal(substeps, 80);
    assert_int_equal(of_substeps, 80);
    assert_true(stages > 12 * steps && strcmp(before.name, "history") == 0);
    assert_false(next_span(&in_steps, "step", &step) || next_span(&in_substeps, "substep", &substep));
    /* Nothing is measured for a file that cannot be written. */
    assert_code(2, run("bench history --windows 5 " TINY " --trace no/such/trace.json"));
    assert_one_message("no/such");
    assert_code(2, run("bench error --trace trace.json"));
    assert_one_message("error takes no --trace");
    assert_code(2, run("bench limits --trace trace.json --baseline rheolog"));
    assert_one_message("does not go with --baseline");
}

static void bench_refuses_bad_options(void **state)
{
    (void)state;
    assert_code(2, run("bench scaling --rounds 3"));
    assert_one_message("--rounds needs --baseline PROGRAM");
    assert_code(2, run("bench scaling --timeout 3"));
    assert_one_message("--timeout needs --baseline PROGRAM");
    assert_code(2, run("bench scaling --baseline ./old --rounds 0"));
    assert_one_message("--rounds must be from 1 to 1000");
    assert_code(2, run("bench scaling --baseline ./old --timeout 0"));
    assert_one_message("--timeout must be at least 1");
    assert_code(2, run("bench scenes --baseline ./old --repetitions 2"));
    assert_one_message("scenes has one repetition per round with --baseline; use --rounds");
    assert_code(2, run("bench table1 --scheme fast"));
    assert_one_message("summed");
    assert_code(2, run("bench table2 --scheme summed"));
    assert_one_message("table2 takes no --scheme");
    assert_code(2, run("bench scenes --scenes melting-box,tilted"));
    assert_one_message("there is no built-in scene \"tilted\"");
    assert_code(2, run("bench scenes --scenes ''"));
    assert_one_message("--scenes needs names of scenes");
    assert_code(2, run("bench limits --scenes melting-box"));
    assert_one_message("limits takes no --scenes; error and scenes do");
    assert_code(2, run("bench scenes --particles 1000"));
    assert_one_message("scenes takes no --particles");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bench_has_its_columns),
        cmocka_unit_test(bench_json_has_the_names_of_csv),
        cmocka_unit_test(bench_prints_tables),
        cmocka_unit_test(bench_limits_have_a_line_per_stage),
        cmocka_unit_test(bench_features_have_their_stages),
        cmocka_unit_test(bench_error_has_a_line_per_point),
        cmocka_unit_test(bench_error_writes_files),
        cmocka_unit_test(bench_error_refuses_unknown_studies),
        cmocka_unit_test(bench_compares_with_an_older_program),
        cmocka_unit_test(bench_compares_a_program_with_itself),
        cmocka_unit_test(bench_refuses_a_bad_baseline),
        cmocka_unit_test(bench_ends_a_baseline_that_hangs),
        cmocka_unit_test(a_trace_has_the_stages_of_steps),
        cmocka_unit_test(bench_refuses_bad_options),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
