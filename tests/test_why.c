/*
 * Who changed a particle: what stages say that they added gives the values of the state, bit for bit, in every stage of the
 * built-in scenes; and what they say is true.
 */
#define _XOPEN_SOURCE 700
#include "support.h"

#include <dirent.h>

typedef struct seen {
    uint64_t changes, contributions;
} seen;

static bool receive(void *data, const rheo_change *change)
{
    seen *s = data;
    if (!change->exact)
        fail_msg("step %llu, %s: the contributions do not give the %s", (unsigned long long)change->step,
                 change->stage, change->field);
    s->changes++;
    s->contributions += change->count;
    if (change->count == 0)
        fail_msg("%s changed the %s, but has no contributions", change->stage, change->field);
    return true;
}

static const char *const FIELDS[] = {"position", "velocity", "density", "temperature", "derivative"};

static void check_recording(const char *path)
{
    rheo_recording *r;
    rheo_player *player;
    OK(rheo_recording_open(path, &r, &error));
    OK(rheo_player_open(r, NULL, &player, &error));
    const rheo_recording_info info = rheo_recording_get_info(r);
    const uint64_t first = info.first_step, last = info.last_step;
    const uint64_t particles = rheo_world_particle_count(rheo_player_world(player));
    seen all = {0};
    for (int k = 0; k < 5; k++) {
        const uint64_t id = k == 4 ? particles - 1 : particles * (uint64_t)k / 4, step = k % 2 ? first + 1 : last;
        for (size_t f = 0; f < sizeof FIELDS / sizeof *FIELDS; f++) {
            rheo_error error;
            const rheo_result result = rheo_player_why(player, step, NULL, id, FIELDS[f], receive, &all, &error);
            if (result != RHEO_OK && !(result == RHEO_ERROR_ARGUMENT && f >= 2))
                fail_msg("%s: %s", path, error.message);
        }
    }
    printf("%s: %llu changes, %llu contributions\n", path, (unsigned long long)all.changes,
           (unsigned long long)all.contributions);
    assert_true(all.contributions > 0);
    rheo_player_close(player);
    rheo_recording_close(r);
}

static void check_folder(const char *folder)
{
    struct dirent **names;
    const int count = scandir(folder, &names, NULL, alphasort);
    assert_true(count > 10);
    for (int i = 0; i < count; i++) {
        char path[1024];
        if (strstr(names[i]->d_name, ".rlog")) {
            snprintf(path, sizeof path, "%s/%s", folder, names[i]->d_name);
            check_recording(path);
        }
        free(names[i]);
    }
    free(names);
}

/* The recordings of replays have a scheme, solver or part each; those of replays/builtin are of the built-in scenes. */
static void every_stage_is_exact(void **state)
{
    (void)state;
    char builtin[1024];
    snprintf(builtin, sizeof builtin, "%s/builtin", getenv("REPLAYS"));
    check_folder(builtin);
    check_folder(getenv("REPLAYS"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_stage_is_exact),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
