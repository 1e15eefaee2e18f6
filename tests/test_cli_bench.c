/* `rheolog bench` from outside. */
#include "cli_support.h"

/* ---- bench ---- */

/* Small enough to run fast; the timings are meaningless. */
#define SMALL "--particles 1000 --steps 2 --repetitions 2 --quiet"

static size_t lines_of(const char *text)
{
    size_t lines = 0;
    for (; *text; text++)
        lines += *text == '\n';
    return lines;
}

/* Splits a line of the CSV in `out` into cells, which may be quoted; returns their number. */
static size_t split_line(size_t line, char cell[][64], size_t most)
{
    const char *at = out;
    while (line-- > 0)
        at = strchr(at, '\n') + 1;
    for (size_t n = 1;; n++) {
        const char *end = *at == '"' ? strchr(at + 1, '"') + 1 : at + strcspn(at, ",\n");
        const size_t length = (size_t)(end - at);
        assert_true(n <= most);
        snprintf(cell[n - 1], 64, "%.*s", (int)length, at);
        if (at[length] == '\n')
            return n;
        at += length + 1;
    }
}

/* Returns a cell of the CSV in `out`. */
static const char *cell_of(size_t line, const char *name)
{
    static char names[96][64], cells[96][64];
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
    assert_code(0, run("bench table1 --windows 0,5 " SMALL " --csv"));
    assert_string_equal(err, "");
    assert_int_equal(lines_of(out), 1 + 4);
    static const char *const scenes[] = {"bowling-ball", "bowling-ball", "vibration", "vibration"};
    for (size_t line = 1; line <= 4; line++) {
        const bool history = line % 2 == 0;
        assert_string_equal(cell_of(line, "case"), scenes[line - 1]);
        assert_in(history ? "5" : "0", cell_of(line, "window"));
        assert_string_equal(cell_of(line, "kind"), history ? "window" : "");
        assert_true(number_of(line, "particles") > 900 && number_of(line, "particles") < 1100);
        assert_true(number_of(line, "ns_least") > 0);
        assert_true(number_of(line, "ns_least") <= number_of(line, "ns_median"));
        assert_true(number_of(line, "ns_median") <= number_of(line, "ns_largest"));
        assert_true(number_of(line, "ns_densities") > 0);
        assert_true((*cell_of(line, "ns_fractional_derivative") != 0) == history);
        assert_true((*cell_of(line, "ns_vibrators") != 0) == (line > 2));
        assert_true((*cell_of(line, "ns_ball") != 0) == (line <= 2));
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
    assert_code(0, run("bench table1 --windows 5 --simd scalar " SMALL " --csv"));
    assert_string_equal(cell_of(1, "simd"), "scalar");
    assert_string_equal(cell_of(1, "hash"), hash);
}

static void bench_json_has_the_names_of_csv(void **state)
{
    (void)state;
    static char names[96][64];
    assert_code(0, run("bench history --windows 5 " SMALL " --csv"));
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
    assert_code(0, run("bench history --windows 5 " SMALL " --json"));
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
    assert_code(0, run("bench table1 --windows 0,5 " SMALL));
    assert_in("scene", out);
    assert_in("vibration ", out);
    assert_in("this machine at best", out);
    assert_in("fractional_derivative ", out);
    assert_in("set by", out);
    assert_code(0, run("bench history --windows 5 " SMALL));
    assert_in("bytes/part.", out);
    assert_code(0, run("bench scaling " SMALL));
    assert_in("ratio", out);
    assert_in(" 1.00 ", out);
    assert_code(0, run("bench features --particles 1000 --steps 2 --repetitions 1"));
    assert_in("springs, walls", out);
    assert_in("neighbours viscosity substeps gravity prediction densities forces.", out);
}

static void bench_limits_have_a_line_per_stage(void **state)
{
    (void)state;
    assert_code(0, run("bench limits " SMALL " --csv"));
    assert_string_equal(cell_of(1, "stage"), "neighbours");
    assert_true(number_of(1, "machine_operations") > 0 && number_of(1, "machine_roots") > 0);
    assert_true(number_of(1, "machine_divisions") > 0 && number_of(1, "machine_memory_read") > 0);
    assert_true(number_of(3, "ns_limit") > 0);
    assert_string_equal(cell_of(lines_of(out) - 1, "stage"), "rest");
}

static void bench_features_have_their_stages(void **state)
{
    (void)state;
    assert_code(0, run("bench features --particles 1000 --steps 2 --repetitions 1 --csv --quiet"));
    assert_string_equal(cell_of(1, "case"), "fluid");
    assert_true(number_of(1, "ns_own") == 0);
    assert_true(number_of(1, "bytes_history") == 0);
    assert_string_equal(cell_of(1, "ns_stiffness"), "");
    const size_t last = lines_of(out) - 1;
    assert_string_equal(cell_of(last, "case"), "all");
    assert_true(number_of(last, "ns_own") > 0);
    static const char *const own[] = {"ns_stiffness", "ns_fractional_derivative", "ns_ball", "ns_walls",
                                      "ns_vibrators"};
    for (size_t i = 0; i < sizeof own / sizeof *own; i++)
        assert_true(number_of(last, own[i]) > 0);
    /* The columns add up to the total. */
    const double sum = number_of(last, "ns_common") + number_of(last, "ns_own") + number_of(last, "ns_rest");
    assert_true(sum > .999 * number_of(last, "ns_median") - .1 && sum < 1.001 * number_of(last, "ns_median") + .1);
    assert_code(0, run("bench scaling " SMALL " --csv"));
    assert_int_equal(lines_of(out), 2);
    assert_true(number_of(1, "ratio") == 1);
    assert_true(number_of(1, "window") == 4);
}

/* A quick run ends before any quantity is measured; whole runs take minutes. */
static void bench_error_has_a_line_per_setting(void **state)
{
    (void)state;
    assert_code(0, run("bench error --model thickening --steps 2 --csv --quiet"));
    assert_string_equal(err, "");
    const size_t lines = lines_of(out);
    assert_true(lines > 20 && lines % 2 == 1); /* two scenes */
    for (size_t line = 1; line < lines; line++) {
        assert_string_equal(cell_of(line, "case"), line <= lines / 2 ? "bowling-ball-small" : "drop");
        assert_true(number_of(line, "ns_particle_step") > 0);
        assert_true(number_of(line, "ns_particle_time") > number_of(line, "ns_particle_step"));
        assert_string_equal(cell_of(line, "dip"), "");
        assert_string_equal(cell_of(line, "hot_height_error"), "");
    }
    assert_string_equal(cell_of(1, "setting"), "step/8");
    assert_true(number_of(1, "steps") == 16 && number_of(1, "substeps") >= 32);
    assert_code(0, run("bench error --model thickening --steps 1 --quiet"));
    assert_in("sequential, step/2 ", out);
    assert_in("limit step -> 0", out);
    assert_code(0, run("bench error --model melting --steps 1 --json --quiet"));
    assert_string_equal(value_of("case"), "\"melting-bunny-small\"");
    assert_string_equal(value_of("dip"), "null");
    assert_code(2, run("bench error --model drag"));
    assert_in("--model is thickening or melting; got \"drag\"", err);
    assert_code(2, run("bench table1 --model melting"));
    assert_in("table1 takes no --model; error does", err);
    assert_code(2, run("bench error --steps 0"));
    assert_in("--steps must be at least 1", err);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bench_has_its_columns),
        cmocka_unit_test(bench_json_has_the_names_of_csv),
        cmocka_unit_test(bench_prints_tables),
        cmocka_unit_test(bench_limits_have_a_line_per_stage),
        cmocka_unit_test(bench_features_have_their_stages),
        cmocka_unit_test(bench_error_has_a_line_per_setting),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
