/* Parameters: their rows, text and numbers, nearest and old names. */
#include "support.h"

#include "core/words.h"

/* Every choice has its word, every default is in its range, every path is found and known once. */
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
    assert_int_equal(rheo_scene_parameter_count(), rheo_parameter_count() + 7);
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
    REFUSED(RHEO_ERROR_ARGUMENT, "finite", rheo_world_def_set(&def, "fluid.stiffness", "1e999", &error));
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

static void the_nearest_word_is_found(void **unused)
{
    (void)unused;
    assert_int_equal(rheo__word_distance("kitten", "sitting"), 3);
    assert_int_equal(rheo__word_distance("", "abc"), 3);
    const char *const words[] = {"run", "fluid.stiffness", "springs.solver", "ball.radius"};
    assert_string_equal(rheo_nearest_word("rum", words, 4), "run");
    assert_string_equal(rheo_nearest_word("ball.solver", words, 4), "springs.solver");
    assert_string_equal(rheo_nearest_word("radius", words, 4), "ball.radius");
    assert_string_equal(rheo_nearest_word("x", words, 1), "run");
    assert_null(rheo_nearest_word("x", NULL, 0));
    char longest[200];
    memset(longest, 'a', sizeof longest);
    longest[199] = 0;
    assert_non_null(rheo_nearest_word(longest, words, 4));
}

/* The error names the present name, which exists. */
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rows_are_complete),
        cmocka_unit_test(parameters_are_read_and_written_to_the_bit),
        cmocka_unit_test(a_window_in_seconds_is_rounded_to_steps),
        cmocka_unit_test(parameters_are_set_by_name),
        cmocka_unit_test(the_nearest_word_is_found),
        cmocka_unit_test(old_names_are_pointed_out),
    };
    return cmocka_run_group_tests_name("parameters", tests, NULL, NULL);
}
