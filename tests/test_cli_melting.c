/* The commands with worlds of the melting model, from outside. */
#include "cli_support.h"

#include <math.h>

static void melting_runs_are_shown(void **state)
{
    (void)state;
    static const char *const keys[] = {"scene",
                                       "model",
                                       "outcome",
                                       "particles",
                                       "steps",
                                       "step",
                                       "time",
                                       "hash",
                                       "ns_per_particle_step",
                                       "neighbours",
                                       "springs",
                                       "history_bytes",
                                       "creation_seconds",
                                       "loop_seconds",
                                       "simd",
                                       "file",
                                       "stages",
                                       "substeps",
                                       "iterations",
                                       "ns_per_particle_substep",
                                       NULL};
    record_melting("m.rlog", "");
    assert_keys(out, keys);
    assert_string_equal(value_of("model"), "\"melting\"");
    char hash[32];
    snprintf(hash, sizeof hash, "%s", value_of("hash"));
    const double substeps = atof(value_of("substeps")), iterations = atof(value_of("iterations"));
    assert_true(substeps >= 8 && iterations >= substeps);
    const double of_substeps = substeps * atof(value_of("ns_per_particle_substep")),
                 of_steps = atof(value_of("steps")) * atof(value_of("ns_per_particle_step"));
    assert_true(of_steps > 0 && fabs(of_substeps - of_steps) < .001 * substeps); /* three decimals */

    assert_code(0, run("run melting-box --set fluid.spacing=0.12 --steps 4"));
    assert_in("substeps    ", out);
    assert_in("solver iterations per substep", out);
    assert_null(strstr(out, "springs"));
    assert_null(strstr(out, "history"));
    assert_code(0, run("run melting-box --set fluid.spacing=0.12 --steps 0"));
    assert_null(strstr(out, "substeps    ")); /* no step has any */

    assert_code(0, run("metrics m.rlog"));
    static const char *const columns[] = {"heat",       "hot_height",        "cold_height",
                                          "hot_spread", "cold_displacement", "max_density_error",
                                          "substeps",   "iterations"};
    assert_memory_equal(out, "step,time,", 10);
    for (size_t i = 0; i < sizeof columns / sizeof columns[0]; i++) {
        char column[32];
        snprintf(column, sizeof column, ",%s", columns[i]);
        assert_in(column, out);
    }
    /* The metrics of all steps add up to the totals of `run`. */
    double sum = 0;
    size_t column = 0;
    for (const char *c = out; strncmp(c, "substeps", 8) != 0; c++)
        column += *c == ',';
    for (const char *line = strchr(out, '\n') + 1; *line; line += strcspn(line, "\n") + 1) {
        const char *at = line;
        for (size_t n = 0; n < column; n++)
            at += strcspn(at, ",") + 1;
        sum += atof(at);
    }
    assert_true(sum == substeps);

    assert_code(0, run("info m.rlog"));
    assert_in("melting.viscosity", out);
    assert_in("yield", out);
    assert_code(0, run("doctor m.rlog"));
    assert_in("healthy", out);
    assert_code(0, run("verify m.rlog --json"));
    assert_string_equal(value_of("verdict"), "\"same\"");
    assert_string_equal(value_of("hash"), hash);
}

static void melting_states_are_inspected(void **state)
{
    (void)state;
    record_melting("m.rlog", "");
    assert_code(0, run("inspect m.rlog --json --particle 7 --top 2"));
    static const char *const keys[] = {
        "file",        "scene",       "model",      "hash",      "metrics",        "densest",
        "fastest",     "hottest",     "furthest",   "particle",  "summed_density", "pressure",
        "temperature", "jump_number", "shear_rate", "viscosity", "start_position", "displacement",
        "neighbours",  "distance",    "weight",     NULL};
    assert_keys(out, keys);
    static const char *const absent[] = {"stiffest", "near_density", "derivative", "history\"", "modes", "kappa"};
    for (size_t i = 0; i < sizeof absent / sizeof absent[0]; i++)
        assert_null(strstr(out, absent[i]));
    char before[32], after[32], middle[32];
    snprintf(after, sizeof after, "%s", value_of("hash"));
    assert_code(0, run("inspect m.rlog --json --step 3"));
    snprintf(before, sizeof before, "%s", value_of("hash"));
    assert_code(0, run("inspect m.rlog --json --step 4 --stage momentum@2"));
    assert_string_equal(value_of("stage"), "\"momentum@2\"");
    snprintf(middle, sizeof middle, "%s", value_of("hash"));
    assert_string_not_equal(middle, before);
    assert_string_not_equal(middle, after);
    assert_code(0, run("inspect m.rlog --json --step 4 --stage momentum"));
    assert_string_equal(value_of("stage"), "\"momentum@1\"");
    assert_string_not_equal(value_of("hash"), middle);
    assert_code(0, run("inspect m.rlog --step 4 --stage momentum@2 --particle 7"));
    static const char *const words[] = {
        "after stage momentum@2, ", "jump number",       "shear rate", "apparent", "temperature",
        "start position",           "metrics of step 3", "iterations", "W, 1/L^3"};
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++)
        assert_in(words[i], out);
    static const char *const not_there[] = {"springs", "history", "derivative", "stiffness"};
    for (size_t i = 0; i < sizeof not_there / sizeof not_there[0]; i++)
        assert_null(strstr(out, not_there[i]));
    assert_null(strstr(out, " \n"));
    static const char *const cases[][2] = {
        {"--spring 1:2", "the model melting has no springs"},
        {"--step 4 --stage momentun@2", "did you mean \"momentum\"? Its stages: substeps, "},
        {"--step 4 --stage momentum@99", "there is no momentum@99 in it"},
        {"--step 4 --stage momentum@0", "number of a substep"},
        {"--step 4 --stage momentum@two", "number of a substep"},
        {"--step 4 --stage substeps@2", "made once in a step"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        assert_code(2, run("inspect m.rlog %s", cases[i][0]));
        assert_one_message(cases[i][1]);
    }
}

/* A difference is reported with its substep and a refused step with its reason, in text and as JSON. */
static void melting_differences_and_failures_are_reported(void **state)
{
    (void)state;
    record_melting("m.rlog", "");
    record_melting("n.rlog", "--set melting.xsph=0.4");
    assert_code(1, run("diff m.rlog n.rlog --json"));
    assert_string_equal(value_of("stage"), "\"integration@1\"");
    assert_string_equal(value_of("field"), "\"position\"");
    assert_code(1, run("diff m.rlog n.rlog"));
    assert_in("integration@1", out);
    assert_code(0, run("run --from m.rlog@2 --steps 2 --json -o later.rlog --force"));
    assert_code(0, run("diff --common m.rlog later.rlog"));
    assert_code(0, run("checkpoint m.rlog --step 2 -o c.rlog --force"));
    assert_code(0, run("run --from c.rlog --steps 2 --json -o later.rlog --force"));
    assert_code(0, run("diff --common m.rlog later.rlog"));
    assert_code(2, run("run --from m.rlog --steps 1 --set fluid.stiffness=3"));
    assert_one_message("fluid.stiffness is a parameter of the model thickening; the model here is melting");
    assert_code(1, run("run --from m.rlog --steps 1 --set melting.max_substeps=1 -o bad.rlog --force"));
    assert_in("melting.max_substeps is 1", err);
    assert_code(0, run("verify bad.rlog"));
    assert_code(1, run("doctor bad.rlog"));
    assert_in("stage substeps cannot go on because of velocity", out);
    assert_in("--set melting.max_substeps=", out);
    assert_code(1, run("doctor bad.rlog --json"));
    assert_string_equal(value_of("stage"), "\"substeps\"");
    assert_in("\"reason\": \"substeps-for-sound\", \"required\": ", out);
    assert_in(", \"limit\": 1}", out);
    assert_code(0, run("inspect bad.rlog --json"));
    assert_in("melting.max_substeps is 1", out);
    assert_code(0, run("info bad.rlog --json"));
    assert_in("\"limit\": 1, \"message\": \"step ", out);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(melting_runs_are_shown),
        cmocka_unit_test(melting_states_are_inspected),
        cmocka_unit_test(melting_differences_and_failures_are_reported),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
