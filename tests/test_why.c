/*
 * Who changed a particle: what stages say that they added gives the values of the state, bit for bit, in every stage of the
 * golden recordings.
 */
#define _XOPEN_SOURCE 700
#include "why.h"

#include <dirent.h>

static void check_recording(const char *path, told *all)
{
    rheo_recording *r;
    rheo_player *player;
    OK(rheo_recording_open(path, &r, &error));
    if (rheo_recording_definition(r)->model != RHEO_MODEL_THICKENING) { /* test_why_melting has the others */
        rheo_recording_close(r);
        return;
    }
    const rheo_recording_info info = rheo_recording_get_info(r);
    rheo_failure failure;
    const bool fails = rheo_recording_failure(r, &failure);
    const uint64_t steps[] = {info.first_step + 1, info.last_step, info.last_step + 1};
    told own = {.of = path};
    OK(rheo_player_open(r, NULL, &player, &error));
    for (size_t k = 0; k < (fails ? 3 : 2); k++) {
        uint64_t id[INTERESTING];
        OK(rheo_player_seek(player, steps[k] - 1, &error));
        const size_t count = interesting(rheo_player_world(player), id);
        for (size_t i = 0; i < count; i++)
            check_particle(player, steps[k], id[i], &own);
    }
    assert_true(own.contributions > 0);
    for (int source = 0; source < RHEO_SOURCE_COUNT; source++)
        all->by[source] += own.by[source];
    rheo_player_close(player);
    rheo_recording_close(r);
}

static void check_folder(const char *folder, told *all)
{
    struct dirent **names;
    const int count = scandir(folder, &names, NULL, alphasort);
    assert_true(count > 10);
    for (int i = 0; i < count; i++) {
        char path[1024];
        snprintf(path, sizeof path, "%s/%s", folder, names[i]->d_name);
        if (strstr(path, ".rlog"))
            check_recording(path, all);
        free(names[i]);
    }
    free(names);
}

/* The recordings of replays have a scheme, solver or part each; those of replays/builtin are of the built-in scenes. */
static void every_stage_is_exact(void **state)
{
    (void)state;
    if (sizeof(rheo_real) != 4) /* they are of float */
        skip();
    char builtin[1024];
    told all = {.of = ""};
    snprintf(builtin, sizeof builtin, "%s/builtin", getenv("REPLAYS"));
    check_folder(builtin, &all);
    check_folder(getenv("REPLAYS"), &all);
    const rheo_source needed[] = {RHEO_SOURCE_GRAVITY, RHEO_SOURCE_VELOCITY,     RHEO_SOURCE_PRESSURE,
                                  RHEO_SOURCE_SPRING,  RHEO_SOURCE_VISCOSITY,    RHEO_SOURCE_WALL,
                                  RHEO_SOURCE_BALL,    RHEO_SOURCE_PLATE,        RHEO_SOURCE_PAST,
                                  RHEO_SOURCE_MODE,    RHEO_SOURCE_DISPLACEMENT, RHEO_SOURCE_VIBRATOR};
    for (size_t i = 0; i < sizeof needed / sizeof *needed; i++)
        if (!all.by[needed[i]])
            fail_msg("no particle has a contribution of %s", rheo_source_name(needed[i]));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_stage_is_exact),
    };
    return cmocka_run_group_tests_name("why", tests, NULL, NULL);
}
