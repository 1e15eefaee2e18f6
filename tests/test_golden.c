/* Replays the golden recordings of replays/ and compares step by step. Proves that a changed constant is noticed. */
#include "support.h"

#include <dirent.h>

#include "record/recording.h"
#include "scenes/making.h"
#include "world/world.h"

static const char *const GOLDEN[] = {"ball",           "commands",   "failure",       "floor",        "force",
                                     "frozen",         "full",       "implicit",      "incline",      "lag",
                                     "materials",      "melt",       "melt-commands", "melt-failure", "melt-printed",
                                     "melt-summation", "no-history", "plates",        "positions",    "sequential",
                                     "spheres",        "stress",     "tempered",      "window-fast"};
enum { GOLDENS = sizeof GOLDEN / sizeof *GOLDEN };

static const char *path_of(const char *name)
{
    static char path[512];
    const char *folder = getenv("REPLAYS");
    assert_non_null(folder);
    snprintf(path, sizeof path, "%s/%s.rlog", folder, name);
    return path;
}

/* A build with the other number type can only report that it cannot replay. */
static bool other_number_type(void)
{
    if (sizeof(rheo_real) == 4)
        return false;
    print_message("the golden recordings are for float; this build for double cannot compare them\n");
    return true;
}

/* Verifies a golden recording with every SIMD variant. */
static void verify_all_variants(const char *name, uint64_t least, uint64_t most)
{
    const char *variant;
    for (uint32_t k = 0; (variant = rheo_simd_available(k)); k++) {
        rheo_verification v;
        OK(rheo_use_simd(variant, &error));
        OK(rheo_verify(path_of(name), &v, &error));
        if (v.verdict != RHEO_SAME || v.steps < least || v.steps > most)
            fail_msg(
                "%s, SIMD variant %s: %s\nTo accept an intended change of results: replays/make.sh PROGRAM \"why\"",
                name, variant, v.message);
    }
    OK(rheo_use_simd(rheo_simd_available(0), &error));
}

static void golden_recordings_are_the_same(void **unused)
{
    (void)unused;
    if (other_number_type())
        skip();
    for (int i = 0; i < GOLDENS; i++)
        verify_all_variants(GOLDEN[i], 3, UINT64_MAX);
}

/* Verifies a golden recording with one parameter changed. */
static rheo_verification verify_changed(const char *name, const char *key, double factor)
{
    rheo_recording *recording;
    rheo_world *world;
    rheo_verification v;
    OK(rheo_recording_open(path_of(name), &recording, &error));
    OK(rheo_recording_world(recording, rheo_recording_get_info(recording).first_step, NULL, &world, &error));
    char value[96];
    double number;
    OK(rheo_world_def_get(rheo_world_definition(world), key, value, sizeof value));
    number = strtod(value, NULL);
    snprintf(value, sizeof value, "%.17g", number * factor);
    OK(rheo_world_set(world, key, value, &error));
    rheo__world_forget_commands(world);
    OK(rheo__verify_world(recording, world, &v, &error));
    rheo_world_destroy(world);
    rheo_recording_close(recording);
    return v;
}

/* Small versions of all built-in scenes. */
static void builtin_scenes_are_the_same(void **unused)
{
    (void)unused;
    if (other_number_type())
        skip();
    rheo_scene scene;
    for (size_t i = 0; rheo_scene_builtin_at(i, &scene) == RHEO_OK; i++) {
        char name[128];
        snprintf(name, sizeof name, "builtin/%s", scene.name);
        rheo_scene_release(&scene);
        verify_all_variants(name, 24, 24);
    }
    rheo_verification v = verify_changed("builtin/drop", "springs.stiffness", 1 + 1e-6);
    assert_int_equal(v.verdict, RHEO_DIFFERS);
}

/* ---- Stale recordings ---- */

/* The definition and number of particles of a built-in scene, as replays/make.sh records it. False: no such scene. */
static bool definition_of(const char *name, rheo_scene *scene, rheo_world_def *def, uint64_t *particles)
{
    if (rheo_scene_builtin(name, scene, NULL) != RHEO_OK)
        return false;
    OK(rheo_scene_set(scene, "resolution", "0.4", &error));
    OK(rheo__scene_check_parameters(scene, def, &error));
    OK(rheo__def_in_steps(def, &error));
    OK(rheo_scene_spacing(scene, &def->fluid.spacing, &error));
    OK(rheo_scene_particle_count(scene, particles, &error));
    return true;
}

/* Names what a recording of a built-in scene has that the scene has not; "": nothing. */
static const char *stale(const char *name, const rheo_recording *recording, const char *changed_path)
{
    static char text[512];
    char was[96], is[96];
    rheo_scene scene;
    rheo_world_def def;
    uint64_t particles;
    text[0] = 0;
    if (!definition_of(name, &scene, &def, &particles)) {
        snprintf(text, sizeof text, "there is no built-in scene %s", name);
        return text;
    }
    if (changed_path)
        OK(rheo_world_def_set(&def, changed_path, "12.5", &error));
    const rheo_parameter *p;
    for (size_t i = 0; (p = rheo_world_def_differing(rheo_recording_definition(recording), &def, &i, was, is));)
        /* Making the scene sets these. */
        if (!(strncmp(p->path, "ball", 4) == 0 && strstr(p->path, ".position")) &&
            strcmp(p->path, "fluid.number_density") != 0)
            snprintf(text, sizeof text, "%s was %s, it is %s in the scene", p->path, was, is);
    if (rheo_recording_get_info(recording).particles != particles)
        snprintf(text, sizeof text, "it has %llu particles, the scene %llu",
                 (unsigned long long)rheo_recording_get_info(recording).particles, (unsigned long long)particles);
    rheo_scene_release(&scene);
    return text;
}

/*
 * A recording verifies whatever its scene has become, because it has its own parameters. So nothing noticed one whose scene
 * was renamed or changed.
 */
static void recordings_of_built_in_scenes_are_of_these_scenes(void **unused)
{
    (void)unused;
    char folder_name[512];
    snprintf(folder_name, sizeof folder_name, "%s/builtin", getenv("REPLAYS"));
    DIR *folder = opendir(folder_name);
    assert_non_null(folder);
    size_t found = 0;
    for (struct dirent *entry; (entry = readdir(folder));) {
        char name[64], path[80];
        snprintf(name, sizeof name, "%.*s", (int)strcspn(entry->d_name, "."), entry->d_name);
        if (!name[0])
            continue;
        snprintf(path, sizeof path, "builtin/%s", name);
        rheo_recording *recording;
        OK(rheo_recording_open(path_of(path), &recording, &error));
        if (*stale(name, recording, NULL))
            fail_msg("builtin/%s is stale: %s; replays/make.sh records it again", entry->d_name,
                     stale(name, recording, NULL));
        if (strcmp(name, "drop") == 0) { /* and what is stale is found */
            assert_string_equal(stale("dropp", recording, NULL), "there is no built-in scene dropp");
            assert_true(says(stale("drop", recording, "fluid.linear_viscosity"), ", it is 12.5 in the scene"));
            assert_true(says(stale("drop-pair", recording, NULL), "it has "));
        }
        rheo_recording_close(recording);
        found++;
    }
    closedir(folder);
    assert_int_equal(found, rheo_scene_builtin_count());
}

/* Every recording in the folder is compared, because an unlisted one would never fail. */
static void every_golden_recording_is_listed(void **unused)
{
    (void)unused;
    DIR *folder = opendir(getenv("REPLAYS"));
    assert_non_null(folder);
    int found = 0;
    for (struct dirent *entry; (entry = readdir(folder));) {
        size_t length = strlen(entry->d_name);
        if (length < 5 || strcmp(entry->d_name + length - 5, ".rlog") != 0)
            continue;
        bool listed = false;
        for (int i = 0; i < GOLDENS; i++)
            listed =
                listed || (strncmp(entry->d_name, GOLDEN[i], length - 5) == 0 && strlen(GOLDEN[i]) == length - 5);
        if (!listed)
            fail_msg("%s is not in the list of golden recordings", entry->d_name);
        found++;
    }
    closedir(folder);
    assert_int_equal(found, GOLDENS);
}

static void golden_recordings_are_small_and_whole(void **unused)
{
    (void)unused;
    for (int i = 0; i < GOLDENS; i++) {
        rheo_recording *recording;
        OK(rheo_recording_open(path_of(GOLDEN[i]), &recording, &error));
        rheo_recording_info info = rheo_recording_get_info(recording);
        assert_true(info.complete && info.full && info.bytes < 1 << 20);
        assert_true(rheo_recording_blessing_count(recording) > 0);
        rheo_recording_close(recording);
    }
}

/* Any changed constant makes the test above fail, and the report names step, stage, field and particle. */
static void a_changed_constant_is_named(void **unused)
{
    (void)unused;
    if (other_number_type())
        skip();
    const struct {
        const char *name, *key, *stage, *field;
        uint64_t latest;
    } change[] = {
        {"ball", "fluid.near_stiffness", "forces", "position", 1},
        {"ball", "fluid.stiffness", "forces", "position", 1},
        {"ball", "fluid.linear_viscosity", "viscosity", "velocity", 1},
        {"ball", "springs.stiffness", "forces", "velocity", 1},
        {"ball", "springs.plasticity", "densities", "spring_rest_length", 1},
        {"ball", "history.stiffness", "forces", "velocity", 2},
        {"materials", "materials.cornstarch.history.stiffness", "forces", "position", 2},
        {"materials", "materials.cornstarch.history.onset", "forces", "position", 2},
        {"materials", "materials.2.springs.stiffness", "forces", "velocity", 1},
        {"materials", "materials.2.springs.plasticity", "densities", "spring_rest_length", 1},
        {"ball", "ball.density_ratio", "ball", "velocity", 30},
        {"ball", "walls.sticking", "walls", "velocity", 30},
        {"no-history", "fluid.near_stiffness", "forces", "position", 1},
        {"positions", "positions.relaxation", "density_constraint", "position", 1},
        {"positions", "positions.viscosity", "viscosity", "velocity", 1},
        {"sequential", "fluid.near_stiffness", "density", "position", 1},
        {"sequential", "history.stiffness", "spring_displacement", "position", 2},
        {"floor", "vibrators.amplitude", "walls", "position", 10},
        {"floor", "vibrators.frequency", "vibrators", "vibrator_phase", 5},
        {"force", "vibrators.amplitude", "vibrators", "velocity", 10},
        {"spheres", "fluid.rest_density", "forces", "position", 1},
        {"incline", "history.order", "fractional_derivative", "derivative", 3},
        {"commands", "fluid.rest_density", "forces", "position", 41},
        {"full", "history.order", "fractional_derivative", "derivative", 3},
        {"window-fast", "history.order", "fractional_derivative", "derivative", 3},
        {"tempered", "history.stiffness", "forces", "position", 3},
        {"plates", "plates.amplitude", "plates", "position", 1},
        {"stress", "plates.stress", "plates", "velocity", 1},
        {"melt", "melting.sound_speed", "substeps", "substeps", 1}, /* close to needing one more substep */
        {"melt-summation", "melting.sound_speed", "momentum", "velocity", 1},
        {"melt", "melting.alpha", "momentum", "velocity", 1},
        {"melt", "melting.viscosity", "viscosity", "velocity", 1},
        {"melt", "melting.diffusivity", "integration", "temperature", 1},
        {"melt", "melting.xsph", "integration", "", 3}, /* float positions round off small drifts */
        {"melt", "melting.temperature_max", "viscosity", "velocity", 10},
        {"melt-printed", "melting.jump_number_max", "viscosity", "velocity", 1},
        {"melt-printed", "melting.alpha", "momentum", "velocity", 20},
        {"melt-summation", "melting.rest_density", "summation", "density", 1},
        {"melt-summation", "melting.viscosity", "viscosity", "velocity", 20},
        {"melt-commands", "melting.power_law_index", "viscosity", "velocity", 16},
        {"frozen", "melting.diffusivity", "integration", "temperature", 1},
    };
    const size_t stride = every() > 1 ? 3 : 1;
    for (size_t i = 0; i < sizeof change / sizeof *change; i += stride) {
        rheo_verification v = verify_changed(change[i].name, change[i].key, 1 + 1e-6);
        print_message("%s, %s: %s\n", change[i].name, change[i].key, v.message);
        assert_int_equal(v.verdict, RHEO_DIFFERS);
        char stage[32]; /* the substep depends on the change */
        snprintf(stage, sizeof stage, "%.*s", (int)strcspn(v.first.stage, "@"), v.first.stage);
        assert_string_equal(stage, change[i].stage);
        assert_true(v.first.step >= 1 && v.first.step <= change[i].latest);
        assert_non_null(strstr(v.message, change[i].field));
        assert_true(v.first.origin && v.first.expected_bits != v.first.actual_bits && v.first.count > 0);
        assert_true(v.has_hash);
    }
}

/* If this build cannot make the recorded step, it has no hash. */
static void a_failed_step_has_no_hash(void **unused)
{
    (void)unused;
    if (other_number_type())
        skip();
    rheo_verification v = verify_changed("sequential", "springs.stiffness", 1e20);
    print_message("%s\n", v.message);
    assert_int_equal(v.verdict, RHEO_DIFFERS);
    assert_false(v.has_hash);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(golden_recordings_are_the_same),
        cmocka_unit_test(builtin_scenes_are_the_same),
        cmocka_unit_test(recordings_of_built_in_scenes_are_of_these_scenes),
        cmocka_unit_test(every_golden_recording_is_listed),
        cmocka_unit_test(golden_recordings_are_small_and_whole),
        cmocka_unit_test(a_changed_constant_is_named),
        cmocka_unit_test(a_failed_step_has_no_hash),
    };
    return cmocka_run_group_tests_name("golden", tests, NULL, NULL);
}
