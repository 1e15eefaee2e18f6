/* A third model (third_model.c), which no file of src knows, works in library and program. */
#include "cli_support.h"

#include <math.h>

static const char SCENE[] = "{\"model\": \"drag\", \"steps\": 20, \"step\": 0.1, \"drag\": {\"rate\": 2},"
                            " \"fluid\": {\"spacing\": 1, \"shapes\": [{\"block\": {\"min\": [0, 0, 0],"
                            " \"max\": [3, 2, 2], \"velocity\": [4, 3, 0]}}]}}";

/* The last number of a column in `out`, which holds the output of `rheolog metrics`. */
static double last_of(const char *name)
{
    int column = 0;
    const char *line = out;
    for (const char *at = out; *at != '\n' && strncmp(at, name, strlen(name)) != 0; at++)
        column += *at == ',';
    for (const char *next = out; (next = strchr(next, '\n')) && next[1]; line = ++next)
        continue;
    for (; column > 0; column--)
        line = strchr(line, ',') + 1;
    return atof(line);
}

static void the_program_knows_the_model(void **state)
{
    (void)state;
    if (!json_scenes)
        skip();
    double decay = 1;
    for (int step = 0; step < 20; step++)
        decay *= pow(1 - 2 * 0.1 / (1 + step % 3), 1 + step % 3);
    write_file("drag.json", SCENE, strlen(SCENE));
    assert_code(0, run("run drag.json -o a.rlog --force --json"));
    assert_string_equal(value_of("model"), "\"drag\"");
    assert_code(0, run("verify a.rlog"));
    assert_code(0, run("metrics a.rlog"));
    assert_memory_equal(out, "step,time,max_speed,momentum_x\n", 31);
    assert_true(fabs(last_of("max_speed") - 5 * decay) < 1e-5 && fabs(last_of("momentum_x") - 48 * decay) < 1e-4);
    assert_code(0, run("inspect a.rlog --particle 0 --top 3 --json"));
    assert_in("\"velocity\"", out);
    assert_in("\"fastest\"", out);
    assert_null(strstr(out, "density"));
    assert_code(0, run("inspect a.rlog --particle 0"));
    assert_code(0, run("info a.rlog"));
    assert_in("drag.rate", out);
    assert_null(strstr(out, "melting."));
    assert_code(0, run("doctor a.rlog"));
    assert_code(2, run("run drag.json --set resolution=2"));
    assert_in("the model drag cannot change its spacing", err);
    static const char *const STAGES[] = {"drag@2", "drag@3", "floor"}; /* step 9 has three substeps */
    for (int i = 0; i < 3; i++) {
        assert_code(0, run("inspect a.rlog --step 9 --stage %s --json", STAGES[i]));
        assert_memory_equal(value_of("stage") + 1, STAGES[i], strlen(STAGES[i]));
    }
    assert_code(2, run("inspect a.rlog --step 9 --stage drag@4"));
    assert_in("step 9 has only 3 substeps", err);
    assert_code(2, run("inspect a.rlog --step 9 --stage floor@3"));
    assert_in("made once in a step", err);
    assert_code(0, run("scenes --parameters"));
    assert_in("(drag)", out);

    assert_code(0, run("run drag.json --set drag.rate=1 -o b.rlog --force"));
    assert_code(1, run("diff a.rlog b.rlog"));
    assert_in("drag.rate", out);
    assert_code(2, run("run drag.json --set melting.viscosity=1"));
    assert_in("drag", err);
}

static void the_library_knows_the_model(void **state)
{
    (void)state;
    const rheo_model model = (rheo_model)2;
    assert_int_equal(rheo_model_count(), 3);
    assert_string_equal(rheo_model_name(model), "drag");
    assert_null(rheo_model_name((rheo_model)3));
    rheo_world_def def = rheo_default_model_def(model);
    const rheo_real position[3] = {0, 1, 2}, velocity[3] = {1, 0, -2};
    def.particles.count = 1;
    def.particles.position = position;
    def.particles.velocity = velocity;
    rheo_world *world;
    rheo_error error;
    assert_int_equal(rheo_world_create(&def, &world, &error), RHEO_OK);
    assert_string_equal(rheo_world_quantity(world, 1)->name, "velocity");
    assert_null(rheo_world_quantity(world, 2));
    double density = 1, near_density = 1;
    assert_int_equal(rheo_world_densities(world, &density, &near_density, &error), RHEO_OK);
    assert_true(density == 0 && near_density == 0); /* the model has none */
    assert_int_equal(rheo_world_set(world, "drag.rate", "3", &error), RHEO_OK);
    for (int i = 0; i < 10; i++)
        assert_int_equal(rheo_world_step(world, &error), RHEO_OK);
    double decay = 1;
    for (int i = 0; i < 10; i++)
        decay *= pow(1 - 3 * def.step / (1 + i % 3), 1 + i % 3);
    assert_true(fabs((double)rheo_world_velocities(world)[2] + 2 * decay) < 1e-5);
    rheo_world_destroy(world);

    def.ball.radius = 1;
    assert_int_equal(rheo_world_create(&def, &world, &error), RHEO_ERROR_ARGUMENT);
    assert_non_null(strstr(error.message, "the model drag has no ball"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_program_knows_the_model),
        cmocka_unit_test(the_library_knows_the_model),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
