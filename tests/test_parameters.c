/* Parameters: rows, text and numbers, nearest words and old names. */
#include "support.h"

#include <ctype.h>

#include "core/words.h"
#include "world/parameters.h"

/* Every choice has a word, every default is in its range, and every path is found and unique. */
static void rows_are_complete(void **unused)
{
    (void)unused;
    const rheo_parameter *p;
    for (size_t i = 0; (p = rheo_scene_parameter_at(i)); i++) {
        assert_ptr_equal(rheo_scene_parameter_find(p->path), p);
        assert_true(*p->about && p->models && p->minimum < p->maximum);
        assert_int_equal(p->type == RHEO_PARAMETER_CHOICE, p->choices != NULL);
        assert_int_equal(p->scene_only, i >= rheo_parameter_count());
        for (uint32_t w = 0; w < p->choice_count; w++)
            assert_true(p->choices[w] && *p->choices[w] && !strchr(p->choices[w], ' '));
    }
    assert_int_equal(rheo_scene_parameter_count(), rheo_parameter_count() + 8);
    assert_null(rheo_scene_parameter_find("settle"));
    for (rheo_model model = RHEO_MODEL_THICKENING; model <= RHEO_MODEL_MELTING; model++) {
        const rheo_scene scene = rheo_default_model_scene(model);
        OK(rheo_scene_check(&scene, &error));
        assert_int_equal(scene.world.model, model);
    }
}

static void parameters_are_read_and_written_to_the_bit(void **unused)
{
    (void)unused;
    for (rheo_model model = RHEO_MODEL_THICKENING; model <= RHEO_MODEL_MELTING; model++) {
        rheo_world_def def = rheo_default_model_def(model), copy = def;
        def.step = 1.0 / 3;
        def.gravity[0] = 1e-300;
        if (model == RHEO_MODEL_THICKENING) {
            def.fluid.stiffness = 0.1 + 0.2;
            def.springs.solver = RHEO_SOLVER_IMPLICIT;
            def.history.window_seconds = 2.5;
            def.vibrators.seed = (UINT64_C(1) << 53) - 1;
        } else {
            def.melting.viscosity = 0.1 + 0.2;
            def.melting.stress = RHEO_STRESS_NESTED;
            def.melting.max_substeps = 199999;
            def.paper.heat = RHEO_AS_PRINTED_ON;
        }
        for (size_t i = 0; i < rheo_parameter_count(); i++) {
            char text[96];
            const rheo_parameter *p = rheo_parameter_at(i);
            OK(rheo_world_def_get(&def, p->path, text, sizeof text));
            if (p->models >> model & 1)
                OK(rheo_world_def_set(&copy, p->path, text, &error));
            else
                REFUSED(RHEO_ERROR_ARGUMENT, "is a parameter of the model",
                        rheo_world_def_set(&copy, p->path, text, &error));
        }
        assert_memory_equal(&def, &copy, sizeof def);
    }
    rheo_world_def def = rheo_default_world_def();
    assert_null(rheo_parameter_at(rheo_parameter_count()));

    REFUSED(RHEO_ERROR_ARGUMENT, "did you mean \"springs.stiffness\"?",
            rheo_world_def_set(&def, "springs.stifness", "1", &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "three numbers", rheo_world_def_set(&def, "gravity", "[1, 2]", &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "three numbers", rheo_world_def_set(&def, "gravity", "[1, 2, 3, 4]", &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "it is a number", rheo_world_def_set(&def, "step", "fast", &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "it is a number", rheo_world_def_set(&def, "step", "0.1x", &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "it is a number", rheo_world_def_set(&def, "step", "", &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "explicit implicit", rheo_world_def_set(&def, "springs.solver", "magic", &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "history.window", rheo_world_def_set(&def, "history.window", "2.5", &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "history.window", rheo_world_def_set(&def, "history.window", "0 s", &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "whole number", rheo_world_def_set(&def, "vibrators.seed", "1.5", &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "at most 1e+30", rheo_world_def_set(&def, "fluid.stiffness", "1e999", &error));
    OK(rheo_world_def_set(&def, "gravity", "1,2,3", &error));
    assert_true(def.gravity[2] == 3);
}

static void a_window_in_seconds_is_rounded_to_steps(void **unused)
{
    (void)unused;
    rheo_world_def def = rheo_default_world_def();
    OK(rheo_world_def_set(&def, "history.window", "2.5 s", &error));
    rheo_world *world = world_of(def, 0, NULL, NULL);
    assert_int_equal(rheo_world_history_window(world), 76); /* 2.5/0.033 = 75.76 */
    rheo_world_destroy(world);
}

static void parameters_are_set_by_name(void **unused)
{
    (void)unused;
    rheo_scene scene = rheo_default_scene();
    rheo_error error = {""};
    assert_int_equal(rheo_scene_set(&scene, "settle.time", "2.5", &error), RHEO_OK);
    assert_true(scene.settle.time == 2.5);
    assert_int_equal(rheo_scene_set(&scene, "seed", "12", &error), RHEO_OK);
    assert_int_equal(scene.seed, 12);
    assert_int_equal(rheo_scene_set(&scene, "fluid.support", "5", &error), RHEO_OK);
    assert_true(scene.world.fluid.support == 5);
    static const char *const bad[][2] = {{"settle.time", "-1"}, {"settle.time", "nan"}, {"settle.time", "inf"},
                                         {"settle.time", ""},   {"settle.time", "1x"},  {"seed", "-1"},
                                         {"seed", "1e16"},      {"steps", "0"},         {"settle.fraction", "1.1"},
                                         {"settle.tim", "1"},   {"fluid.support", "0"}};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        assert_int_equal(rheo_scene_set(&scene, bad[i][0], bad[i][1], &error), RHEO_ERROR_ARGUMENT);
        assert_non_null(strstr(error.message, bad[i][0]));
    }
    assert_int_equal(rheo_scene_set(&scene, "model", "melting", &error), RHEO_ERROR_ARGUMENT);
    assert_non_null(strstr(error.message, "model cannot be set"));
    assert_int_equal(rheo_scene_set(&scene, "melting.viscosity", "1", &error), RHEO_ERROR_ARGUMENT);
    assert_non_null(strstr(error.message, "of the model melting; the model here is thickening"));
    assert_int_equal(rheo_scene_set(&scene, "particles", "1000", &error), RHEO_OK);
    assert_int_equal(scene.particles, 1000);
    rheo_scene melting = rheo_default_model_scene(RHEO_MODEL_MELTING);
    assert_int_equal(rheo_scene_set(&melting, "melting.viscosity", "1", &error), RHEO_OK);
    assert_true(melting.world.melting.viscosity == 1);
    assert_int_equal(rheo_scene_set(&melting, "settle.time", "1", &error), RHEO_ERROR_ARGUMENT);
    assert_non_null(strstr(error.message, "settle.time is a parameter of the model thickening"));
    assert_string_equal(rheo_scene_parameter_nearest("settle.tim"), "settle.time");
    assert_string_equal(rheo_scene_parameter_nearest("support"), "fluid.support");
}

static void parameters_that_differ_are_found_in_order(void **unused)
{
    (void)unused;
    const rheo_world_def a = rheo_default_world_def();
    rheo_world_def b = a;
    char of_a[96], of_b[96];
    size_t at = 0;
    assert_null(rheo_world_def_differing(&a, &b, &at, of_a, of_b));
    b.fluid.stiffness = 0.1;
    b.gravity[2] = -1;
    at = 0;
    const rheo_parameter *first = rheo_world_def_differing(&a, &b, &at, of_a, of_b);
    assert_string_equal(first->path, "gravity");
    assert_string_not_equal(of_a, of_b);
    const rheo_parameter *second = rheo_world_def_differing(&a, &b, &at, of_a, of_b);
    assert_string_equal(second->path, "fluid.stiffness");
    assert_string_equal(of_b, "0.1");
    assert_null(rheo_world_def_differing(&a, &b, &at, of_a, of_b));
}

/* The number after a word of an error. */
static double number_after(const rheo_error *why, const char *word)
{
    const char *at = why->message, *end;
    while (*at && strncasecmp(at, word, strlen(word)) != 0) /* see says() */
        at++;
    if (!*at)
        fail_msg("\"%s\" is missing in: %s", word, why->message);
    const double number = rheo_text_number(at + strlen(word), &end);
    assert_ptr_not_equal(end, at + strlen(word));
    return number;
}

/* A refusal names limits that hold: what is on them is accepted, unless they are said to be outside. */
static void refusals_name_limits_that_hold(void **unused)
{
    (void)unused;
    rheo_error why = {""};
    static const char *const beyond[] = {"-1e300", "-1e38", "-1.01e30", "1.01e30",
                                         "1e38",   "1e300", "1e400",    "-1e400"};
    const rheo_parameter *p;
    for (size_t i = 0; (p = rheo_scene_parameter_at(i)); i++) {
        rheo_scene scene = rheo_default_model_scene(p->models & 1 ? RHEO_MODEL_THICKENING : RHEO_MODEL_MELTING);
        for (size_t k = 0; k < sizeof beyond / sizeof *beyond && !p->choices; k++) {
            char text[128], number[32];
            const bool vector = p->type == RHEO_PARAMETER_VECTOR, window = p->type == RHEO_PARAMETER_WINDOW;
            snprintf(text, sizeof text, vector ? "[0, %s, 0]" : "%s", beyond[k]);
            assert_int_equal(rheo_scene_set(&scene, p->path, text, &why), RHEO_ERROR_ARGUMENT);
            const bool open[2] = {says(why.message, "above"), says(why.message, "below")};
            const double limit[2] = {
                number_after(&why, window    ? "from "
                                   : open[0] ? "above "
                                             : "at least "),
                number_after(&why, window    ? " to "
                                   : open[1] ? "below "
                                             : "at most "),
            };
            for (int side = 0; side < 2; side++) {
                rheo_number_text(limit[side], number);
                snprintf(text, sizeof text, vector ? "[0, 0, %s]" : "%s", number);
                if (rheo_scene_set(&scene, p->path, text, NULL) != (open[side] ? RHEO_ERROR_ARGUMENT : RHEO_OK))
                    fail_msg("%s=%s, but: %s", p->path, text, why.message);
            }
        }
    }
    rheo_scene scene = rheo_default_scene();
    REFUSED(RHEO_ERROR_ARGUMENT, "gravity has a component of -1e+38; each must be a number of at least -1e+30 and at",
            rheo_scene_set(&scene, "gravity", "[0, -1e38, 0]", &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "at most 1e+30 s", rheo_scene_set(&scene, "history.window", "1e31 s", &error));
    OK(rheo_scene_set(&scene, "history.window", "1e30 s", &error)); /* too many steps, which the scene says */
    /* Settling has at most a million steps; both ways out are possible. */
    scene = rheo_default_scene();
    for (int way = 0; way < 2; way++) {
        OK(rheo_scene_set(&scene, "settle.time", "9", &error));
        OK(rheo_scene_set(&scene, "step", "7e-6", &error));
        assert_int_equal(rheo_scene_check(&scene, &why), RHEO_ERROR_ARGUMENT);
        assert_true(says(why.message, "settle.time is 9, or 1.29e+06 steps"));
        if (way)
            scene.settle.time = number_after(&why, "must be at most ");
        else
            scene.world.step = number_after(&why, "step at least ");
        OK(rheo_scene_check(&scene, &error));
    }
}

/* One component other than the default is enough. */
static void every_component_of_a_default_counts(void **unused)
{
    (void)unused;
    for (rheo_model model = RHEO_MODEL_THICKENING; model <= RHEO_MODEL_MELTING; model++) {
        const rheo__parameter_rows *rows = rheo__model_parameters(model);
        for (size_t i = 0; i < rows->count; i++) {
            const rheo__parameter_row *row = &rows->row[i];
            const rheo_parameter *p = &row->parameter;
            if (p->type != RHEO_PARAMETER_REAL && p->type != RHEO_PARAMETER_VECTOR)
                continue;
            for (uint32_t axis = 0; axis < (p->type == RHEO_PARAMETER_VECTOR ? 3 : 1); axis++) {
                rheo_world_def def = rheo_default_model_def(model);
                double value[3];
                rheo__row_set_default(&def, row);
                assert_true(rheo__row_has_default(&def, row));
                rheo__parameter_values(&def, p, value);
                const double was = value[axis];
                value[axis] = was + 1;
                if (rheo__parameter_assign(&def, p, value, NULL) != RHEO_OK) { /* a share of one */
                    value[axis] = was > 0 ? was / 2 : 0.5;
                    OK(rheo__parameter_assign(&def, p, value, &error));
                }
                assert_false(rheo__row_has_default(&def, row));
            }
        }
    }
}

static void the_nearest_word_is_found(void **unused)
{
    (void)unused;
    assert_int_equal(rheo__word_distance("kitten", "sitting"), 3);
    assert_int_equal(rheo__word_distance("", "abc"), 3);
    const char *const words[] = {"run", "fluid.stiffness", "springs.solver", "ball.radius"};
    assert_string_equal(rheo_nearest_word("rum", words, 4), "run");
    assert_string_equal(rheo_nearest_word("ball.solver", words, 4), "springs.solver");
    assert_string_equal(rheo_nearest_word("radius", words, 4), "ball.radius");
    assert_string_equal(rheo_nearest_word("balls", words, 4), "ball.radius");
    assert_string_equal(rheo_nearest_word("x", words, 1), "run");
    assert_null(rheo_nearest_word("x", NULL, 0));
    assert_true(rheo_is_near_word("rum", "run") && rheo_is_near_word("run", "run"));
    assert_true(rheo_is_near_word("verfy", "verify") && rheo_is_near_word("metriks", "metrics"));
    assert_false(rheo_is_near_word("compare", "scenes") || rheo_is_near_word("", "run") ||
                 rheo_is_near_word("rma", "run"));
    static const char begin[] = "fluid.support"; /* a sanitizer notices reading behind its end */
    assert_true(rheo_is_near_word("wifluid.supportnd", begin) && !rheo_is_near_word("fluid.supportnd", ""));
    assert_true(rheo_is_near_word("txet", "text") && rheo_is_near_word("urn", "run"));
    assert_false(rheo_is_near_word("tetx a", "text b") || rheo_is_near_word("nru", "run"));
    assert_true(rheo_is_near_word("ball.solver", "springs.solver") && rheo_is_near_word("balls", "ball.radius"));
    assert_false(rheo_is_near_word("ball.xyz", "ball.radius") || rheo_is_near_word("xyz", "ball.radius"));
    char longest[200];
    memset(longest, 'a', sizeof longest);
    longest[199] = 0;
    assert_non_null(rheo_nearest_word(longest, words, 4));
}

/* The error names the new name, which exists. */
static void old_names_are_pointed_out(void **unused)
{
    (void)unused;
    static const char *const old[][2] = {{"sources.amplitude", "vibrators.amplitude"},
                                         {"sources.kind", "vibrators.kind"},
                                         {"sources.seed", "vibrators.seed"},
                                         {"melting.courant", "melting.courant_number"},
                                         {"melting.power_index", "melting.power_law_index"},
                                         {"melting.jump_min", "melting.jump_number_min"},
                                         {"melting.jump_max", "melting.jump_number_max"}};
    for (size_t i = 0; i < sizeof old / sizeof *old; i++) {
        rheo_scene scene = rheo_default_scene();
        char right[128];
        snprintf(right, sizeof right, "\"%s\" is now called \"%s\"", old[i][0], old[i][1]);
        REFUSED(RHEO_ERROR_ARGUMENT, right, rheo_scene_set(&scene, old[i][0], "1", &error));
        REFUSED(RHEO_ERROR_ARGUMENT, right, rheo_world_def_set(&scene.world, old[i][0], "1", &error));
        assert_non_null(rheo_scene_parameter_find(rheo_parameter_new_name(old[i][0])));
        assert_null(rheo_scene_parameter_find(old[i][0]));
    }
    assert_null(rheo_parameter_new_name("vibrators.amplitude"));
}

/* ---- The comments in the public headers ---- */

enum { MOST_MEMBERS = 200 };

/* Members of a struct in a header, with the comment above each. */
typedef struct documented {
    size_t count;
    struct {
        char path[64], comment[1024];
    } member[MOST_MEMBERS];
} documented;

static void add_member(documented *d, const char *line, char *comment)
{
    size_t end = strcspn(line, "[;"), begin = end;
    while (begin && (isalnum((unsigned char)line[begin - 1]) || line[begin - 1] == '_'))
        begin--;
    assert_true(d->count < MOST_MEMBERS);
    snprintf(d->member[d->count].path, sizeof d->member->path, "%.*s", (int)(end - begin), line + begin);
    snprintf(d->member[d->count++].comment, sizeof d->member->comment, "%s", comment);
    *comment = 0;
}

/* Handles `} name;` after the members from `first` on. */
static void end_group(documented *d, size_t first, const char *line)
{
    char path[64];
    for (size_t i = first; i < d->count; i++) {
        snprintf(path, sizeof path, "%.*s.%.40s", (int)strcspn(line + 2, ";"), line + 2, d->member[i].path);
        memcpy(d->member[i].path, path, sizeof path);
    }
}

static void read_struct(const char *text, const char *name, documented *d)
{
    char line[256], begin[64], comment[1024] = "";
    size_t group = 0;
    bool inside = false;
    snprintf(begin, sizeof begin, "typedef struct %s {\n", name);
    text = strstr(text, begin);
    assert_non_null(text);
    d->count = 0;
    for (text += strlen(begin); strncmp(text, "} rheo_", 7) != 0; text += strcspn(text, "\n") + 1) {
        const char *first = text + strspn(text, " ");
        snprintf(line, sizeof line, "%.*s", (int)strcspn(first, "\n"), first);
        if (inside || strncmp(line, "/**", 3) == 0) {
            const char *words = line + strspn(line, "/* ");
            const size_t used = inside ? strlen(comment) : 0;
            snprintf(comment + used, sizeof comment - used, "%s%s", used ? " " : "", words);
            inside = !strstr(line, "*/");
        } else if (strcmp(line, "struct {") == 0) {
            group = d->count;
            *comment = 0;
        } else if (*line == '}') {
            end_group(d, group, line);
        } else if (*line) {
            add_member(d, line, comment);
        }
    }
}

/* The end of a parameter's comment: unit, range or words, default. */
static void expected_comment(const rheo_parameter *p, char *text, size_t size)
{
    char low[32], high[32], range[256] = "", value[RHEO_MODEL_MELTING + 1][96];
    bool other = false;
    for (rheo_model model = 0; model <= RHEO_MODEL_MELTING; model++) {
        const rheo_scene scene = rheo_default_model_scene(model);
        OK(rheo_scene_get(&scene, p->path, value[model], sizeof value[model]));
        other = other || strcmp(value[model], value[0]) != 0;
    }
    snprintf(low, sizeof low, "%.15g", p->minimum);
    snprintf(high, sizeof high, "%.15g", p->maximum);
    if (p->choices)
        for (uint32_t i = 0; i < p->choice_count; i++)
            snprintf(range + strlen(range), sizeof range - strlen(range), "%s%s", i ? ", " : "Words ", p->choices[i]);
    else if (p->minimum <= -1e12 && p->maximum >= 1e12)
        snprintf(range, sizeof range, "Any finite value");
    else if (p->above_minimum && p->below_maximum)
        snprintf(range, sizeof range, "Range %s < x < %s", low, high);
    else if (p->maximum >= 1e12)
        snprintf(range, sizeof range, "Range >= %s", low);
    else
        snprintf(range, sizeof range, "Range %s to %s", low, high);
    const bool unit = *p->unit && strcmp(p->unit, "1") != 0 && p->type != RHEO_PARAMETER_WINDOW;
    snprintf(text, size, "%s%s%s%s%s default %s", unit ? "Unit " : "", unit ? p->unit : "", unit ? ". " : "", range,
             p->choices ? ";" : ",", value[0]);
    if (other && (p->models & 3) == 3)
        snprintf(text + strlen(text), size - strlen(text), " (melting: %s)", value[RHEO_MODEL_MELTING]);
    snprintf(text + strlen(text), size - strlen(text), ".");
}

/* Counts the parameters whose comment in the header disagrees, and prints them. */
static int disagreements(const char *text, const char *name, bool scene_only)
{
    static documented def, ball; /* the members of ball are those of a type of its own */
    const rheo_parameter *p;
    int count = 0;
    read_struct(text, name, &def);
    if (!scene_only)
        read_struct(text, "rheo_ball", &ball);
    for (size_t i = 0; (p = rheo_scene_parameter_at(i)); i++) {
        if (p->scene_only != scene_only || strcmp(p->path, "model") == 0)
            continue;
        char expected[512];
        expected_comment(p, expected, sizeof expected);
        size_t m = 0;
        const bool of_ball = !scene_only && strncmp(p->path, "ball.", 5) == 0;
        const documented *d = of_ball ? &ball : &def;
        while (m < d->count && strcmp(d->member[m].path, p->path + (of_ball ? 5 : 0)) != 0)
            m++;
        if (m == d->count || !strstr(d->member[m].comment, expected)) {
            print_message("%s: \"%s\" is not in \"%s\"\n", p->path, expected,
                          m < d->count ? d->member[m].comment : "");
            count++;
        }
    }
    return count;
}

static char *read_header(const char *name)
{
    static char text[1 << 17];
    char path[512];
    assert_non_null(getenv("HEADERS"));
    snprintf(path, sizeof path, "%s/%s", getenv("HEADERS"), name);
    FILE *header = fopen(path, "rb");
    assert_non_null(header);
    const size_t size = fread(text, 1, sizeof text - 1, header);
    fclose(header);
    text[size] = 0;
    return text;
}

/* Ranges, defaults and units in the headers agree with the rows, and a change of each is noticed. */
static void headers_agree_with_the_rows(void **unused)
{
    (void)unused;
    assert_int_equal(disagreements(read_header("scene.h"), "rheo_scene", true), 0);
    char *text = read_header("world.h");
    assert_int_equal(disagreements(text, "rheo_world_def", false), 0);
    static const char *const change[][2] = {
        {"default 300.", "default 301."},         {"Range 0 < x < 1", "Range 0 < x < 2"},
        {"Unit 1/T^2.", "Unit 1/T^3."},           {"Words floor, force", "Words force, floor"},
        {"(melting: 0.045)", "(melting: 0.046)"}, {"double yield_ratio", "double yield_ratia"}};
    for (size_t i = 0; i < sizeof change / sizeof *change; i++) {
        char *found = strstr(strstr(text, "typedef struct rheo_world_def {"), change[i][0]);
        assert_non_null(found);
        memcpy(found, change[i][1], strlen(change[i][1]));
        assert_int_equal(disagreements(text, "rheo_world_def", false), 1);
        memcpy(found, change[i][0], strlen(change[i][0]));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rows_are_complete),
        cmocka_unit_test(parameters_are_read_and_written_to_the_bit),
        cmocka_unit_test(a_window_in_seconds_is_rounded_to_steps),
        cmocka_unit_test(parameters_are_set_by_name),
        cmocka_unit_test(parameters_that_differ_are_found_in_order),
        cmocka_unit_test(refusals_name_limits_that_hold),
        cmocka_unit_test(every_component_of_a_default_counts),
        cmocka_unit_test(the_nearest_word_is_found),
        cmocka_unit_test(old_names_are_pointed_out),
        cmocka_unit_test(headers_agree_with_the_rows),
    };
    return cmocka_run_group_tests_name("parameters", tests, NULL, NULL);
}
