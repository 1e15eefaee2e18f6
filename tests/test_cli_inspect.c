/* `rheolog inspect` from outside. */
#include "cli_support.h"

#include <math.h>

/* ---- inspect ---- */

static void inspect_has_its_keys(void **state)
{
    (void)state;
    record("a.rlog");
    char hash[32];
    snprintf(hash, sizeof hash, "%s", value_of("hash"));
    static const char *const keys[] = {"file",    "scene",    "step",      "stage", "time",    "hash",   "springs",
                                       "failure", "bodies",   "particles", "spin",  "metrics", "energy", "densest",
                                       "fastest", "stiffest", "density",   "kappa", "speed",   "mass",   NULL};
    assert_code(0, run("inspect a.rlog --json"));
    assert_string_equal(err, "");
    assert_keys(out, keys);
    assert_string_equal(value_of("step"), "8"); /* the last one */
    assert_string_equal(value_of("stage"), "null");
    assert_string_equal(value_of("failure"), "null");
    assert_string_equal(value_of("time"), "0.264");
    assert_string_equal(value_of("hash"), hash);
    assert_null(strstr(out, "\"particle\""));
    assert_null(strstr(out, "\"spring\""));
    size_t entries = 0;
    for (const char *c = strstr(out, "densest"); (c = strstr(c, "\"id\"")) != NULL; c++)
        entries++;
    assert_int_equal(entries, 15);
    assert_string_equal(value_of("speed"), value_of("max_speed")); /* the fastest particle, which is first */
    assert_code(0, run("inspect a.rlog --json --top 18446744073709551615")); /* all of them, if more are requested */
    entries = 0;
    for (const char *c = out, *end = strstr(out, "\"fastest\""); (c = strstr(c, "\"density\"")) != NULL && c < end;
         c++)
        entries++;
    assert_int_equal(entries, atoi(value_of("particles")));
    assert_code(0, run("inspect a.rlog --json --top 2 --particle 4"));
    static const char *const particle[] = {"particle",    "position",      "velocity",   "speed",     "near_density",
                                           "pressure",    "near_pressure", "derivative", "distance",  "partner",
                                           "rest_length", "length",        "stretch",    "stiffness", "history",
                                           "lag",         "weight",        NULL};
    assert_keys(out, particle);
    entries = 0;
    for (const char *c = strstr(out, "densest"); (c = strstr(c, "\"density\"")) != NULL; c++)
        entries++;
    assert_int_equal(entries, 3); /* two in the list, one of the particle */
    assert_code(0, run("inspect a.rlog --json --particle 4"));
    assert_null(strstr(out, "densest"));

    /* The state at a step is that of a checkpoint there. */
    assert_code(0, run("inspect a.rlog --json --step 3"));
    snprintf(hash, sizeof hash, "%s", value_of("hash"));
    assert_string_equal(value_of("step"), "3");
    assert_code(0, run("checkpoint a.rlog --step 3 -o c3.rlog --force"));
    hash[17] = 0;
    assert_in(hash + 1, out);
    assert_code(0, run("inspect c3.rlog --json"));
    assert_in(hash + 1, value_of("hash"));
    assert_string_equal(value_of("step"), "3");

    assert_code(0, run("inspect a.rlog --step 3"));
    static const char *const words[] = {"after stage", "stiffest", "metrics of step 3", "max_speed", "ball", NULL};
    assert_in(hash + 1, out);
    assert_null(strstr(out, words[0]));
    for (size_t i = 1; words[i]; i++)
        assert_in(words[i], out);
    assert_null(strstr(out, " \n"));
    assert_code(0, run("inspect a.rlog --step 3 --particle 4"));
    assert_in("neighbours:", out);
    assert_null(strstr(out, "stiffest"));
}

/* The vectors of the ball, component by component, in the text as in the library. */
static void the_text_has_the_vectors_of_the_ball(void **state)
{
    (void)state;
    record("a.rlog");
    rheo_world *world = checkpoint_at("a.rlog", 8);
    rheo_body body;
    assert_int_equal(rheo_world_body(world, 0, &body), RHEO_OK);
    const struct {
        const char *label, *unit;
        const double *value;
    } LINES[] = {{"ball", "L", body.position}, {"  velocity", "L/T", body.velocity}, {"  spin", "1/T", body.spin}};
    assert_code(0, run("inspect a.rlog --step 8"));
    for (size_t i = 0; i < sizeof LINES / sizeof *LINES; i++) {
        char line[128];
        const double *v = LINES[i].value;
        snprintf(line, sizeof line, "%-14s%.6g, %.6g, %.6g %s\n", LINES[i].label, v[0], v[1], v[2], LINES[i].unit);
        assert_in(line, out);
    }
    assert_true(body.position[0] != body.position[1] && body.velocity[1] != body.velocity[2]);
    rheo_world_destroy(world);
}

static void inspect_shows_states_between_stages(void **state)
{
    (void)state;
    record("a.rlog");
    char before[32], after[32];
    assert_code(0, run("inspect a.rlog --json --step 4"));
    snprintf(before, sizeof before, "%s", value_of("hash"));
    assert_code(0, run("inspect a.rlog --json --step 5"));
    snprintf(after, sizeof after, "%s", value_of("hash"));
    assert_code(0, run("inspect a.rlog --json --step 5 --stage forces@2 --particle 7"));
    assert_string_equal(value_of("step"), "5");
    assert_string_equal(value_of("stage"), "\"forces@2\"");
    assert_string_equal(value_of("time"), "0.132");
    assert_string_not_equal(value_of("hash"), before);
    assert_string_not_equal(value_of("hash"), after);
    assert_in("\"metrics\": {\"step\": 4, ", out);
    assert_in("\"lag\": 0, \"step\": 4, ", out);
    /* Numbers are numbers, and vectors are lists of three. */
    const char *density = strstr(out, "\"density\": "), *velocity = strstr(out, "\"velocity\": [");
    assert_true(density && velocity);
    double v[3], parsed;
    assert_int_equal(sscanf(density, "\"density\": %lf", &parsed), 1);
    assert_int_equal(sscanf(velocity, "\"velocity\": [%lf, %lf, %lf]", &v[0], &v[1], &v[2]), 3);
    assert_code(0, run("inspect a.rlog --json --step 5 --stage history"));
    assert_string_equal(value_of("hash"), after); /* the state after the last stage is that of the step */
    assert_string_equal(value_of("stage"), "null");
    assert_code(0, run("inspect a.rlog --step 5 --stage forces@2"));
    assert_in("5, after stage forces@2, ", out);

    static const char *const cases[][2] = {
        {"--step 5 --stage densitis",
         "did you mean \"densities\"? Its stages: neighbours, fractional_derivative, viscosity, "},
        {"--step 0 --stage forces", "steps 1 to 8; --step 0"},
        {"--step 9 --stage forces", "steps 1 to 8; --step 9"},
        {"--step 9", "steps 0 to 8; --step 9"},
        {"--particle 4294967296", "no particle 4294967296 at step 8; ids go from 0 to "},
        {"--particle 99999999", "no particle 99999999"},
        {"--spring 1:99999999", "no particle 99999999"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        assert_code(2, run("inspect a.rlog %s", cases[i][0]));
        assert_one_message(cases[i][1]);
    }
    assert_code(0, run("checkpoint a.rlog --step 3 -o c3.rlog --force"));
    assert_code(2, run("inspect c3.rlog --stage forces"));
    assert_one_message("no steps");
}

static void histories_are_those_of_the_library(void **state)
{
    (void)state;
    record("a.rlog");
    static const int steps[] = {0, 5, 8}; /* no history, some, a full window of 6 */
    for (size_t s = 0; s < 3; s++) {
        rheo_world *world = checkpoint_at("a.rlog", steps[s]);
        const uint32_t rows = rheo_world_history_rows(world);
        assert_int_equal(rows, steps[s] < 7 ? steps[s] : 7);
        rheo_spring spring[100];
        if (rheo_world_spring_count(world) == 0) { /* not settled: the first step makes the springs */
            rheo_world_destroy(world);
            continue;
        }
        assert_true(rheo_world_spring_count(world) > 100);
        assert_int_equal(rheo_world_springs(world, spring, 100), RHEO_OK);
        const rheo_spring *which = &spring[99];
        rheo_real own[7 * 3], difference[7 * 3];
        assert_int_equal(rheo_world_particle_history(world, which->b, own), RHEO_OK);
        assert_int_equal(rheo_world_spring_history(world, which->a, which->b, difference), RHEO_OK);
        rheo_spring_state expected;
        assert_int_equal(rheo_world_spring(world, which->a, which->b, &expected, NULL), RHEO_OK);
        rheo_particle_state particle;
        assert_int_equal(rheo_world_particle(world, which->b, &particle, NULL), RHEO_OK);
        assert_code(0, run("inspect a.rlog --step %d --json --particle %u --spring %u:%u", steps[s], which->b,
                           which->b, which->a));
        double weight[7];
        rheo_history_weights(.5, 7, weight);
        if (rows < 7)
            weight[rows - 1] = rheo_history_first_weight(.5, rows - 1);

        rheo_body ball;
        assert_int_equal(rheo_world_body(world, 0, &ball), RHEO_OK);
        const char *at = strstr(out, "\"bodies\": [");
        assert_non_null(at);
        assert_vector(&at, "position", ball.position);
        assert_vector(&at, "velocity", ball.velocity);
        assert_vector(&at, "spin", ball.spin);
        assert_true(number_after(&at, "mass") == ball.mass);
        at = strstr(out, "\"particle\": {");
        assert_non_null(at);
        assert_true(number_after(&at, "id") == which->b);
        assert_true(number_after(&at, "speed") == particle.speed);
        assert_true(number_after(&at, "density") == particle.density);
        assert_true(number_after(&at, "near_pressure") == particle.near_pressure);
        assert_true(number_after(&at, "derivative") == particle.derivative[0]);
        const char *list = at, *springs = strstr(at, "\"springs\": [");
        const double w = 1 - number_after(&list, "distance") / 4;
        assert_true(number_after(&list, "weight") == w);
        list = at;
        size_t neighbours = 0, partners = 0;
        for (; (list = strstr(list, "\"id\"")) != NULL && list < springs; list++)
            neighbours++;
        for (list = springs; (list = strstr(list, "\"partner\"")) != NULL; list++)
            partners++;
        assert_true(neighbours == particle.neighbours && partners == particle.springs && partners > 3);
        list = springs;
        for (double last = -1, id; (id = number_after(&list, "partner")) != which->a; last = id)
            assert_true(id > last);
        assert_true(number_after(&list, "kappa") == expected.kappa);
        at = strstr(at, "\"history\": [");
        for (uint32_t m = 0; m < rows; m++) {
            assert_true(number_after(&at, "lag") == m && number_after(&at, "step") == steps[s] - (int)m);
            assert_row(&at, "velocity", own + 3 * m);
        }

        at = strstr(out, "\"spring\": {");
        assert_non_null(at);
        assert_true(number_after(&at, "a") == which->a && number_after(&at, "b") == which->b);
        assert_true(number_after(&at, "rest_length") == (double)expected.spring.rest_length);
        assert_true(number_after(&at, "length") == expected.length);
        assert_true(number_after(&at, "stretch") == expected.length / (double)expected.spring.rest_length - 1);
        assert_true(number_after(&at, "history_rate") == expected.history_rate);
        assert_true(number_after(&at, "stiffness") == expected.stiffness);
        assert_true(number_after(&at, "kappa") == expected.kappa);
        for (uint32_t m = 0; m < rows; m++) {
            assert_true(number_after(&at, "lag") == m && number_after(&at, "step") == steps[s] - (int)m);
            const double off = number_after(&at, "time") - .033 * (steps[s] - (int)m);
            assert_true(off < 1e-12 && off > -1e-12);
            assert_true(number_after(&at, "weight") == weight[m]);
            assert_row(&at, "difference", difference + 3 * m);
        }
        assert_null(strstr(at, "\"lag\""));
        assert_code(0, run("inspect a.rlog --step %d --spring %u:%u", steps[s], which->a, which->b));
        assert_in("rest length", out);
        assert_in("weight", out);
        rheo_world_destroy(world);
    }
}

/* Every lag keeps its time after a change of the time step, including lags before the recording began. */
static void lags_keep_their_times(void **state)
{
    (void)state;
    record("a.rlog");
    assert_code(0, run("run --from a.rlog@4 --steps 2 --set step=0.01 --quiet -o slow.rlog --force"));
    assert_code(0, run("inspect slow.rlog --json --particle 3"));
    static const double times[] = {.152, .142, .132, .099, .066, .033};
    const char *at = strstr(out, "\"history\"");
    assert_non_null(at);
    for (int m = 0; m < 6; m++) {
        assert_true(number_after(&at, "step") == 6 - m);
        const double off = number_after(&at, "time") - times[m];
        assert_true(off < 1e-9 && off > -1e-9);
    }
}

/* Adds a vector times a factor. */
static void take_vector(const char **at, const char *key, double factor, double sum[3])
{
    sum[0] += factor * number_after(at, key);
    for (int axis = 1; axis < 3; axis++) {
        *at += 2; /* a comma and a blank */
        sum[axis] += factor * number_at(at);
    }
}

/* Regression: the window of a world that has no history was shown as if it had one. */
static void info_shows_no_history_where_there_is_none(void **state)
{
    (void)state;
    static const char *const without[] = {"history.stiffness=0", "springs.stiffness=0"};
    for (size_t i = 0; i < sizeof without / sizeof *without; i++) {
        assert_code(0, run("run %s --steps 1 --set %s --quiet -o bare.rlog --force", scene, without[i]));
        assert_code(0, run("info bare.rlog"));
        assert_null(strstr(out, "\nhistory     "));
        assert_code(0, run("info bare.rlog --json"));
        assert_in("\"window_steps\": null, \"window_time\": null, \"lag_steps\": null, \"lag_time\": null", out);
    }
    /* A history that a command ends is there all the same. */
    assert_code(0, run("run %s --steps 1 --quiet -o with.rlog --force", scene));
    assert_code(0, run("run --from with.rlog --steps 1 --set history.stiffness=0 --quiet -o bare.rlog --force"));
    assert_code(0, run("checkpoint bare.rlog --step 2 -o with.rlog --force"));
    assert_code(0, run("info with.rlog"));
    assert_in("\nhistory     6 steps", out);
}

/* A history of modes shows the modes and the newest velocity; D^q x is their sum. */
static void modes_are_shown(void **state)
{
    (void)state;
    static const struct {
        const char *kind, *info;
        int modes, rows;
    } kinds[] = {
        {"window", "history     6 steps = 0.198 T\n", 0, 7},
        {"window-fast", "history     6 steps = 0.198 T, as decaying sums", 6, 7},
        {"full", "history     full: all of it", 13, 1},
        {"tempered", "history     tempered: a window of 6 steps = 0.198 T that fades with tau = 0.252", 8, 1}};
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
        assert_code(
            0, run("run %s --steps 9 --set history.kind=%s --quiet -o modes.rlog --force", scene, kinds[i].kind));
        assert_code(0, run("verify modes.rlog"));
        assert_code(0, run("info modes.rlog"));
        assert_in(kinds[i].info, out);
        assert_in(kinds[i].kind, out);
        assert_code(0, run("info modes.rlog --json"));
        assert_in(strcmp(kinds[i].kind, "full") ? "\"window_steps\": 6" : "\"window_steps\": null", out);
        for (int pair = 0; pair < 2; pair++) {
            rheo_world *world = checkpoint_at("modes.rlog", 9);
            rheo_spring *springs = malloc((rheo_world_spring_count(world) + 1) * sizeof *springs);
            assert_non_null(springs);
            assert_int_equal(rheo_world_springs(world, springs, 1), RHEO_OK);
            char what[64];
            snprintf(what, sizeof what, pair ? "--spring %u:%u" : "--particle %u", springs[0].a, springs[0].b);
            free(springs);
            rheo_world_destroy(world);
            assert_code(0, run("inspect modes.rlog %s", what));
            char text[32];
            snprintf(text, sizeof text, "modes: %d,", kinds[i].modes);
            assert_true((strstr(out, text) != NULL) == (kinds[i].modes > 0));
            snprintf(text, sizeof text, "history: %d row%s", kinds[i].rows, kinds[i].rows == 1 ? "\n" : "s");
            assert_in(text, out);
            assert_code(0, run("inspect modes.rlog --json %s", what));
            const char *at = strstr(out, pair ? "\"spring\": {" : "\"particle\": {");
            assert_non_null(at);
            const char *found = at;
            const double rate = number_after(&found, pair ? "history_rate" : "derivative");
            int rows = 0, modes = 0;
            for (const char *list = at; (list = strstr(list, "\"lag\"")) != NULL; list++)
                rows++;
            assert_int_equal(rows, kinds[i].rows);
            const char *list = strstr(at, "\"history\": [");
            double sum[3] = {0}, size = 0;
            assert_non_null(list);
            char key[16];
            snprintf(key, sizeof key, "%s", pair ? "difference" : "velocity");
            take_vector(&list, key, 1, sum);
            list = strstr(at, "\"modes\": [");
            assert_non_null(list);
            for (; (list = strstr(list, "\"decay\"")) != NULL; modes++) {
                const double weight = number_after(&list, "weight");
                take_vector(&list, "sum", weight, sum);
            }
            assert_int_equal(modes, kinds[i].modes);
            const double scale = rheo_history_scale(.5, .033, RHEO_WEIGHTS_PAPER);
            for (int axis = 0; axis < 3; axis++)
                size += sum[axis] * sum[axis];
            const double mine = pair ? size : sum[0] * sum[0], difference = scale * scale * mine - rate * rate;
            if (modes)
                assert_true(difference <= 1e-4 * scale * scale * size && -difference <= 1e-4 * scale * scale * size);
        }
    }
}

/* Rows younger than the lag have the weight 0; the weights of the others give D^q of the particle. */
static void rows_younger_than_the_lag_have_no_weight(void **state)
{
    (void)state;
    enum { LAG = 3, ID = 5 };
    static const char *const kinds[] = {"window", "window-fast", "full", "tempered"};
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++)
        for (int steps = 2; steps <= 14; steps += 4) { /* none is old enough, some are, and the window is full */
            assert_code(0,
                        run("run %s --steps %d --set history.kind=%s --set \"history.lag=0.1 s\" --quiet -o lag.rlog "
                            "--force",
                            scene, steps, kinds[i]));
            assert_code(0, run("info lag.rlog"));
            assert_in(", after a lag of 3 steps = 0.099 T\n", out);
            assert_code(0, run("info lag.rlog --json"));
            assert_in("\"lag_steps\": 3", out);
            assert_code(0, run("inspect lag.rlog --particle %d", ID));
            assert_int_equal(strstr(out, "decaying sums over the velocities beyond lag 3\n") != NULL, i > 0);
            assert_code(0, run("inspect lag.rlog --particle %d --json", ID));
            const char *at = strstr(out, "\"particle\": {");
            assert_non_null(at);
            const double derivative = number_after(&at, "derivative");
            const char *list = strstr(at, "\"history\": ["), *end = strstr(list, "\"modes\"");
            double sum[3] = {0}, size = 0;
            int rows = 0;
            for (; (list = strstr(list, "\"lag\"")) != NULL && list < end; rows++) {
                const double weight = number_after(&list, "weight");
                assert_true(rows < LAG ? weight == 0 : rows == LAG && steps > LAG + 1 ? weight == 1 : weight > 0);
                take_vector(&list, "velocity", weight, sum);
            }
            const int most = i < 2 ? LAG + 7 : LAG + 1;
            assert_int_equal(rows, steps < most ? steps : most);
            for (list = end; (list = strstr(list, "\"decay\"")) != NULL;) {
                const double weight = number_after(&list, "weight");
                if (i == 1) /* shown by the rows, too */
                    continue;
                take_vector(&list, "sum", weight, sum);
            }
            for (int axis = 0; axis < 3; axis++)
                size += fabs(sum[axis]);
            const double scale = rheo_history_scale(.5, .033, RHEO_WEIGHTS_PAPER);
            assert_true(fabs(scale * sum[0] - derivative) <= 1e-3 * scale * size);
            assert_true((size > 0) == (steps > LAG));
        }
}

/*
 * A history of lengths shows mean velocities, with the mean weights of the lags between two samples, of which the first are 0, 1,
 * 2, 3, 4, 6.
 */
static void a_history_of_lengths_has_mean_weights(void **state)
{
    (void)state;
    enum { ID = 5 };
    for (int steps = 5; steps <= 15; steps += 5) { /* the last pair of lags is cut, and the window is full */
        double before[3] = {0}, after[3] = {0}, mean[3] = {0}, weight[7];
        assert_code(0, run("run %s --steps %d --set history.of=length --quiet -o length.rlog --force", scene, steps));
        assert_code(0, run("info length.rlog"));
        assert_in("history     6 steps = 0.198 T, of the lengths of springs\n", out);
        assert_code(0, run("inspect length.rlog --step %d --particle %d --json", steps - 1, ID));
        const char *at = strstr(out, "\"particle\": {");
        take_vector(&at, "position", 1, before);
        assert_code(0, run("inspect length.rlog --particle %d --json", ID));
        at = strstr(out, "\"particle\": {");
        take_vector(&at, "position", 1, after);
        rheo_history_weights(.5, 7, weight);
        weight[4] = weight[5] = (weight[4] + weight[5]) / 2;
        int rows = 0;
        for (const char *list = strstr(at, "\"history\": ["); (list = strstr(list, "\"lag\"")) != NULL; rows++) {
            assert_true(fabs(number_after(&list, "weight") - weight[rows]) < 1e-12);
            if (rows == 0)
                take_vector(&list, "velocity", 1, mean);
        }
        assert_int_equal(rows, steps < 7 ? steps : 7);
        for (int axis = 0; axis < 3; axis++)
            assert_true(fabs(mean[axis] - (after[axis] - before[axis]) / .033) < 1e-4);
    }
}

/* The weights of a curve are shown, and the factor of their sum is 1. */
static void a_curve_gives_the_weights(void **state)
{
    (void)state;
    enum { ID = 5 };
    if (!json_scenes)
        skip();
    const char *text =
        "{\"scene\": \"curve\", \"fluid\": {\"shapes\": [{\"block\": {\"min\": [0, 0, 0], \"max\": [6, 6, 6]}}]},\n"
        "\"history\": {\"curve\": [[0, 3], [0.1, 1.5], [0.35, 0.5], [0.5, 0.25]], \"lag\": 1}}";
    write_file("curve.json", text, strlen(text));
    for (int steps = 9; steps <= 27; steps += 9) { /* the window fills, and is full */
        assert_code(0, run("run curve.json --steps %d --quiet -o curve.rlog --force", steps));
        assert_code(0, run("verify curve.rlog"));
        assert_code(0, run("info curve.rlog"));
        assert_in("history     a curve of 4 points in 16 steps = 0.528 T, after a lag of 1 step = 0.033 T\n", out);
        assert_code(0, run("log curve.rlog"));
        assert_in("curve       4 points from 0 to 0.5 T\n", out);
        assert_code(0, run("info curve.rlog --json"));
        assert_in("\"curve\": [[0, 3], [0.1, 1.5], [0.35, 0.5], [0.5, 0.25]]", out);
        assert_in("\"window_steps\": 16", out);
        assert_code(0, run("inspect curve.rlog --particle %d --json", ID));
        const char *at = strstr(out, "\"particle\": {");
        assert_non_null(at);
        const double derivative = number_after(&at, "derivative");
        double sum[3] = {0}, size = 0;
        int rows = 0;
        for (const char *list = strstr(at, "\"history\": ["); (list = strstr(list, "\"lag\"")) != NULL; rows++) {
            const double weight = number_after(&list, "weight");
            take_vector(&list, "velocity", weight, sum);
        }
        assert_int_equal(rows, steps < 18 ? steps : 18);
        for (int axis = 0; axis < 3; axis++)
            size += fabs(sum[axis]);
        assert_true(size > 0 && fabs(sum[0] - derivative) <= 1e-4 * size);
    }
    assert_code(2, run("run curve.json --set history.curve=1"));
    assert_one_message("--set cannot change history.curve: only a scene file can");
    remove("curve.json");
}

/* Regression: nothing showed what plates do. */
static void plates_are_shown(void **state)
{
    (void)state;
    if (!json_scenes)
        skip();
    assert_code(0, run("run %s/plates.json --steps 20 -o plates.rlog --force --quiet", getenv("SCENES")));
    assert_code(0, run("inspect plates.rlog --step 19 --json"));
    /* The upper plate moves by velocity [6, 0, -2] and 0.4 sin(4 pi t). */
    const char *upper = strstr(out, "{\"name\": \"upper\", \"particles\": ");
    assert_non_null(upper);
    double at[3], force[3];
    assert_int_equal(
        sscanf(strstr(upper, "\"displacement\": ["), "\"displacement\": [%lf, %lf, %lf]", at, at + 1, at + 2), 3);
    const double time = 19 * .033;
    assert_true(fabs(at[0] - (6 * time + .4 * sin(4 * 3.14159265358979 * time))) < .001);
    assert_true(at[1] == 0 && fabs(at[2] + 2 * time) < .001);
    assert_int_equal(sscanf(strstr(upper, "\"force\": ["), "\"force\": [%lf, %lf, %lf]", force, force + 1, force + 2),
                     3);
    assert_in("\"plates\": [{\"name\": \"lower\", \"particles\": ", out);
    assert_code(0, run("inspect plates.rlog --step 19"));
    assert_in("lower plate   ", out);
    char line[96];
    snprintf(line, sizeof line, "  force       %.6g, %.6g, %.6g M L/T^2\n", force[0], force[1], force[2]);
    assert_in(line, out);
    record("a.rlog");
    assert_code(0, run("inspect a.rlog --json"));
    assert_in("\"plates\": []", out);
}

static void particles_without_a_spring_show_their_partners(void **state)
{
    (void)state;
    record("a.rlog");
    rheo_world *world = checkpoint_at("a.rlog", 8);
    const uint32_t last = rheo_world_particle_count(world) - 1;
    rheo_world_destroy(world);
    assert_code(0, run("inspect a.rlog --json --particle 0"));
    char partners[64];
    const char *at = out;
    const unsigned first = (unsigned)number_after(&at, "partner"), second = (unsigned)number_after(&at, "partner");
    snprintf(partners, sizeof partners, "particle 0 has springs to %u, %u, ", first, second);
    size_t count = 2;
    for (; (at = strstr(at, "\"partner\"")) != NULL; at++)
        count++;
    assert_code(2, run("inspect a.rlog --spring 0:%u", last));
    assert_one_message(partners);
    assert_in("not connected", err);
    const char *more = strstr(strstr(err, "springs to"), " and ");
    assert_int_equal(count > 8, more != NULL);
    if (more)
        assert_int_equal(strtoul(more + 5, NULL, 10), count - 8);
    assert_code(0, run("inspect a.rlog --spring %u:0 --json", first));

    /* A fluid without springs, without history, and with neither. */
    assert_code(
        0,
        run("run %s --steps 2 --set springs.stiffness=0 --set history.stiffness=0 -o b.rlog --force --quiet", scene));
    assert_code(2, run("inspect b.rlog --spring 0:1"));
    assert_one_message("springs to none");
    assert_code(0, run("inspect b.rlog --json --particle 0 --top 3"));
    assert_in("\"stiffest\": []", out);
    assert_in("\"springs\": []", out);
    assert_in("\"history\": []", out);
    assert_code(0, run("inspect b.rlog --particle 0 --top 3"));
    assert_in("  none", out);
    if (!json_scenes)
        skip();
    write_file("empty.json", "{}", 2);
    assert_code(0, run("run ./empty.json --steps 2 -o nothing.rlog --force --quiet"));
    assert_code(0, run("inspect nothing.rlog --json"));
    assert_string_equal(value_of("particles"), "0");
    assert_in("\"densest\": []", out);
    assert_in("\"bodies\": []", out);
    assert_code(0, run("inspect nothing.rlog"));
    assert_null(strstr(out, "nan"));
    assert_code(2, run("inspect nothing.rlog --particle 0"));
    assert_one_message("no particles");
}

/* History stiffness is too large, so springs throw the fluid apart in one of the first steps. */
static void a_failed_step_is_inspected(void **state)
{
    (void)state;
    assert_code(
        1,
        run("run %s --steps 50 --set scheme=sequential --set history.stiffness=1e6 -o bad.rlog --force --json --quiet",
            scene));
    assert_code(0, run("inspect bad.rlog --json"));
    assert_in("went bad", err);
    const char *at = strstr(out, "\"failure\": {");
    assert_non_null(at);
    const unsigned bad = (unsigned)number_after(&at, "step");
    assert_in("\"stage\": \"spring_displacement\", \"field\": \"position\", \"item\": \"particle\"", at);
    number_after(&at, "id");
    assert_in("\"reason\": \"not-finite\", \"required\": null, \"limit\": null, \"message\": \"step ", at);
    assert_in("went bad", at);
    char last[16], hash[32], text[64];
    snprintf(last, sizeof last, "%u", bad - 1);
    assert_string_equal(value_of("step"), last);
    snprintf(hash, sizeof hash, "%s", value_of("hash"));

    /* The failure does not explain a state before the last one. */
    assert_code(0, run("inspect bad.rlog --step %u", bad - 2));
    assert_string_equal(err, "");
    assert_code(0, run("inspect bad.rlog --json --step %u --stage springs --particle 3", bad));
    assert_in("went bad", err);
    at = out;
    assert_true(number_after(&at, "step") == bad);
    assert_string_equal(value_of("stage"), "\"springs\"");
    assert_string_not_equal(value_of("hash"), hash);
    snprintf(text, sizeof text, "\"metrics\": {\"step\": %s, ", last);
    assert_in(text, out);
    assert_code(1, run("inspect bad.rlog --step %u --stage spring_displacement", bad));
    assert_one_message("went bad");
    assert_code(1, run("inspect bad.rlog --step %u --stage history", bad));
    assert_one_message("went bad");
    assert_code(2, run("inspect bad.rlog --step %u", bad));
    assert_one_message("before stage spring_displacement");
    assert_code(2, run("inspect bad.rlog --step %u --stage springs", bad + 1));
    snprintf(text, sizeof text, "steps 1 to %u; --step %u", bad, bad + 1);
    assert_one_message(text);
    assert_code(2, run("inspect bad.rlog --step %u", bad + 1));
    assert_one_message("is none of them");
}

static void inspect_compares_the_state_with_the_hashes(void **state)
{
    (void)state;
    record("a.rlog");
    falsify_step("a.rlog", "other.rlog", 5);
    assert_code(0, run("inspect other.rlog --step 4"));
    assert_code(1, run("inspect other.rlog --step 6"));
    assert_one_message("step 5");
    size_t size;
    char *bytes = read_bytes("a.rlog", &size);
    write_file("truncated.rlog", bytes, size - 5);
    assert_code(0, run("inspect truncated.rlog --json"));
    assert_string_equal(value_of("step"), "8");
    assert_in("truncated", err);
}

/* ---- Text and JSON ---- */

enum { MOST_NUMBERS = 4096 };

/* The numbers of a JSON value at `at`, without those in texts. Returns how many. */
static int json_numbers(const char *at, double *value)
{
    int depth = 0, count = 0;
    do {
        const char *end = at;
        if (*at == '"') {
            at = strchr(at + 1, '"') + 1;
            continue;
        }
        const double number = rheo_text_number(at, &end);
        if (end > at && count < MOST_NUMBERS)
            value[count++] = number;
        depth += (*at == '[' || *at == '{') - (*at == ']' || *at == '}');
        at = end > at ? end : at + 1;
    } while (depth > 0);
    return count;
}

/* The numbers of a text up to `end`, which are separated by blanks, commas and colons. */
static int text_numbers(const char *at, const char *end, double *value)
{
    int count = 0;
    while (at < end && count < MOST_NUMBERS) {
        const char *behind = at;
        value[count] = rheo_text_number(at, &behind);
        count += behind > at;
        at = behind > at ? behind : at + 1;
    }
    return count;
}

/* Asserts that the first `count` numbers are the same to the six digits that a text has. */
static void assert_numbers(const char *what, int count, const double *text, const double *json)
{
    for (int i = 0; i < count; i++)
        if (!(fabs(text[i] - json[i]) <= 5.1e-6 * fabs(json[i])))
            fail_msg("%s: number %d is %g in the text and %g in JSON", what, i, text[i], json[i]);
}

/* Compares the blocks of the text behind a line with the JSON behind a key. Returns how many numbers there were. */
static int compare_text(const char *text, const char *json)
{
    static double shown[MOST_NUMBERS], exact[MOST_NUMBERS];
    static const char *const tables[] = {"neighbours", "springs", "history", "modes"};
    int all = 0;
    char key[64];
    for (const char *line = text, *end; *line; line = end + 1) {
        end = strchr(line, '\n');
        if (end[1] != ' ' && end - line > 16 && line[15] == ' ') { /* "near density    0.637905 ..." */
            int length = 16;
            while (line[length - 1] == ' ')
                length--;
            snprintf(key, sizeof key, "\"%.*s\": ", length, line);
            for (char *blank; (blank = strchr(key, ' ')) && blank[1];)
                *blank = '_';
            const char *at = strstr(json, key);
            if (!at)
                fail_msg("no %s in %s", key, json);
            const int count = json_numbers(at + strlen(key), exact);
            assert_true(text_numbers(line + 16, end, shown) >= count);
            assert_numbers(key, count, shown, exact);
            all += count;
        } else if (end[1] == ' ') { /* "springs: 11", a header, and rows */
            snprintf(key, sizeof key, "%.*s", (int)strcspn(line, ":"), line);
            bool table = false;
            for (int k = 0; k < 4; k++)
                table = table || strcmp(key, tables[k]) == 0;
            const char *newest = strstr(line, ", the newest ");
            const int rows =
                newest && newest < end ? atoi(newest + strlen(", the newest ")) : atoi(line + strlen(key) + 2);
            snprintf(key, sizeof key, "\"%.*s\": [", (int)strcspn(line, ":"), line);
            const char *at = strstr(json, key), *first = table ? strchr(end + 1, '\n') + 1 : end + 1, *behind = first;
            int lines = 0;
            for (; *behind == ' '; behind = strchr(behind, '\n') + 1)
                lines++;
            if (!at)
                fail_msg("no %s in %s", key, json);
            const int count = json_numbers(at + strlen(key) - 1, exact), numbers = text_numbers(first, behind, shown);
            assert_int_equal(lines, table ? rows : 5);
            assert_true(newest && newest < end ? count > numbers : count == numbers);
            assert_numbers(key, numbers, shown, exact);
            all += numbers;
            end = behind - 1;
        }
    }
    return all;
}

static void the_text_has_the_numbers_of_json(void **state)
{
    (void)state;
    static const struct {
        const char *made, *what, *begin, *key;
        int least; /* numbers */
    } views[] = {{"%s --set history.kind=window-fast", "--particle 3", "\nparticle 3\n", "\"particle\": {", 150},
                 {"%s --set history.kind=window-fast", "--spring 3:4", "\nspring 3:4\n", "\"spring\": {", 60},
                 {"%s --set history.lag=3", "--particle 7", "\nparticle 7\n", "\"particle\": {", 60},
                 {"%s", "", "\ndensest: ", "\"densest\": ", 35},
                 {"melting-box --set fluid.spacing=0.12", "--particle 9", "\nparticle 9\n", "\"particle\": {", 150}};
    static char text[1 << 16];
    for (size_t i = 0; i < sizeof views / sizeof *views; i++) {
        char made[256];
        if (strncmp(views[i].made, "%s", 2) == 0)
            snprintf(made, sizeof made, "%s%s", scene, views[i].made + 2);
        else
            snprintf(made, sizeof made, "%s", views[i].made);
        assert_code(0, run("run %s --steps 9 -o view.rlog --force --quiet", made));
        assert_code(0, run("inspect view.rlog %s", views[i].what));
        const char *begin = strstr(out, views[i].begin);
        assert_non_null(begin);
        snprintf(text, sizeof text, "%s", begin + (views[i].what[0] ? strlen(views[i].begin) : 1));
        assert_code(0, run("inspect view.rlog %s --json", views[i].what));
        const char *json = strstr(out, views[i].key);
        assert_non_null(json);
        const int all = compare_text(text, json);
        if (all < views[i].least)
            fail_msg("%s, %s: only %d numbers", made, views[i].what, all);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(inspect_has_its_keys),
        cmocka_unit_test(the_text_has_the_vectors_of_the_ball),
        cmocka_unit_test(inspect_shows_states_between_stages),
        cmocka_unit_test(histories_are_those_of_the_library),
        cmocka_unit_test(lags_keep_their_times),
        cmocka_unit_test(info_shows_no_history_where_there_is_none),
        cmocka_unit_test(modes_are_shown),
        cmocka_unit_test(rows_younger_than_the_lag_have_no_weight),
        cmocka_unit_test(a_history_of_lengths_has_mean_weights),
        cmocka_unit_test(a_curve_gives_the_weights),
        cmocka_unit_test(plates_are_shown),
        cmocka_unit_test(particles_without_a_spring_show_their_partners),
        cmocka_unit_test(a_failed_step_is_inspected),
        cmocka_unit_test(the_text_has_the_numbers_of_json),
        cmocka_unit_test(inspect_compares_the_state_with_the_hashes),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
