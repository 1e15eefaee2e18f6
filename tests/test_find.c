/* Searching a recording (rheolog/find.h): what is found is what playing every step and stage finds. */
#include "support.h"

#include <math.h>

#include "core/state.h"
#include "record/recording.h"
#include "world/stage_runs.h"

enum { STEPS = 60, MOST_HITS = 4000 };

static const char *const PATH = "test_find.rlog";
static rheo_error why;
static rheo_recording *recording;
static rheo_player *player;

/* ---- A recording, with keyframes at 0, 20, 40 and 60 ---- */

static void record(bool full)
{
    const rheo_real position[6] = {3, 18, 3, 12, 18, 12}, velocity[6] = {0, -9, 0, 1, -8, 0};
    rheo_world *world = lively_world();
    rheo_recorder *recorder;
    const rheo_record_options options = {.scene = "find", .keyframe_spacing = 20, .full = full, .force = true};
    OK(rheo_recorder_open(world, PATH, &options, &recorder, &error));
    for (int i = 0; i < STEPS; i++) {
        if (i == 23)
            OK(rheo_world_add_particles(world, 2, position, velocity, &error));
        OK(rheo_recorder_step(recorder, &error));
    }
    OK(rheo_recorder_close(recorder, &error));
    rheo_world_destroy(world);
    OK(rheo_recording_open(PATH, &recording, &error));
    OK(rheo_player_open(recording, NULL, &player, &error));
}

static void forget(void)
{
    rheo_player_close(player);
    rheo_recording_close(recording);
    remove(PATH);
}

/* ---- Searching ---- */

typedef struct hits {
    rheo_found item[MOST_HITS];
    size_t count, most; /* most: the receiver ends the search after as many; 0: never */
} hits;

static hits found;

static bool receive(void *data, const rheo_found *f)
{
    hits *h = data;
    assert_true(h->count < MOST_HITS);
    h->item[h->count++] = *f;
    return h->count != h->most;
}

static rheo_search search(const char *condition, rheo_find_options options)
{
    rheo_search s;
    found.count = 0;
    options.receiver = receive;
    options.data = &found;
    OK(rheo_player_find(player, condition, &options, &s, &error));
    return s;
}

static const rheo_find_options ALL = {.which = RHEO_FIND_ALL};

/* ---- What playing finds ---- */

typedef double measure(const rheo_world *world, uint64_t *id);

static double fastest(const rheo_world *world, uint64_t *id)
{
    double most = -1;
    const rheo_real *v = rheo_world_velocities(world);
    for (uint32_t i = 0; i < rheo_world_particle_count(world); i++, v += 3) {
        const double x = (double)v[0], y = (double)v[1], z = (double)v[2], speed = sqrt(x * x + y * y + z * z);
        if (speed > most) {
            most = speed;
            *id = i;
        }
    }
    return most;
}

static double thinnest(const rheo_world *world, uint64_t *id)
{
    const uint32_t count = rheo_world_particle_count(world);
    rheo_particle_state *p = calloc(count, sizeof *p);
    uint32_t least = 0;
    OK(rheo_world_particles(world, p, &error));
    for (uint32_t i = 0; i < count; i++)
        least = p[i].density < p[least].density ? i : least;
    const double density = p[least].density;
    *id = least;
    free(p);
    return density;
}

static double height_of_ball(const rheo_world *world, uint64_t *id)
{
    rheo_body body;
    *id = 0;
    OK(rheo_world_body(world, 0, &body));
    return body.position[1];
}

static double stretched(const rheo_world *world, uint64_t *id)
{
    const size_t count = rheo_world_spring_count(world);
    rheo_spring *spring = calloc(count + 1, sizeof *spring);
    double most = -INFINITY;
    OK(rheo_world_springs(world, spring, count));
    for (size_t k = 0; k < count; k++) {
        rheo_spring_state s;
        OK(rheo_world_spring(world, spring[k].a, spring[k].b, &s, &error));
        if (s.length / (double)s.spring.rest_length - 1 > most) {
            most = s.length / (double)s.spring.rest_length - 1;
            *id = spring[k].a;
        }
    }
    free(spring);
    return most;
}

static double speed_of_60(const rheo_world *world, uint64_t *id)
{
    rheo_particle_state p;
    *id = 60;
    OK(rheo_world_particle(world, 60, &p, &error));
    return p.velocity[1];
}

/* The value of a measure in each step, and the id. */
static void play(measure *m, double value[STEPS + 1], uint64_t id[STEPS + 1])
{
    for (uint64_t step = 0; step <= STEPS; step++) {
        OK(rheo_player_seek(player, step, &error));
        value[step] = m(rheo_player_world(player), &id[step]);
    }
}

/* A bound that about half of the steps exceed. */
static double middle(const double value[STEPS + 1])
{
    double sum = 0;
    for (int i = 0; i <= STEPS; i++)
        sum += value[i];
    return sum / (STEPS + 1);
}

static void all_first_and_last_are_those_of_playing(void **state)
{
    (void)state;
    static const struct {
        measure *measure;
        const char *condition;
        bool below;
    } cases[] = {{fastest, "any particle: speed > %.17g", false},
                 {thinnest, "any particle:density<%.17g", true},
                 {height_of_ball, "ball: y < %.17g", true},
                 {stretched, "any spring: stretch >= %.17g", false},
                 {speed_of_60, "particle 60: velocity.y <= %.17g", true},
                 {speed_of_60, "particle 60: vy > %.17g", false}};
    for (int full = 0; full < 2; full++) {
        record(full);
        for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
            double value[STEPS + 1];
            uint64_t id[STEPS + 1];
            char condition[96];
            play(cases[i].measure, value, id);
            const double bound = middle(value);
            snprintf(condition, sizeof condition, cases[i].condition, bound);
            size_t expected = 0;
            rheo_search s = search(condition, ALL);
            for (uint64_t step = 0; step <= STEPS; step++) {
                if (cases[i].below ? !(value[step] < bound) : !(value[step] > bound))
                    continue;
                assert_true(expected < found.count);
                const rheo_found *f = &found.item[expected++];
                assert_int_equal(f->step, step);
                assert_int_equal(f->id, id[step]);
                NEAR(f->value, value[step], 1e-6 * fabs(value[step]));
                assert_string_equal(f->stage, "");
            }
            assert_int_equal(found.count, expected);
            assert_int_equal(s.hits, expected);
            assert_true(expected > 2 && expected < STEPS - 2);
            assert_true(s.looked && s.first == 0 && s.last == STEPS);
            const rheo_found first = found.item[0], last = found.item[expected - 1];
            s = search(condition, (rheo_find_options){.which = RHEO_FIND_FIRST});
            assert_int_equal(found.count, 1);
            assert_memory_equal(&s.found, &first, sizeof first);
            assert_true(s.first == 0 && s.last == first.step);
            s = search(condition, (rheo_find_options){.which = RHEO_FIND_LAST});
            assert_int_equal(found.count, 1);
            assert_memory_equal(&s.found, &last, sizeof last);
            /* Bounds are exclusive. */
            s = search(condition,
                       (rheo_find_options){.which = RHEO_FIND_LAST, .has_before = true, .before = last.step});
            assert_true(s.hits == 0 || s.found.step < last.step);
            s = search(condition, (rheo_find_options){.has_after = true, .after = first.step});
            assert_true(s.found.step > first.step && s.first == first.step + 1);
        }
        forget();
    }
}

static void conditions_are_combined(void **state)
{
    (void)state;
    record(false);
    double height[STEPS + 1], speed[STEPS + 1];
    uint64_t id[STEPS + 1];
    play(height_of_ball, height, id);
    play(fastest, speed, id);
    const double h = middle(height), v = middle(speed);
    static const char *const condition[] = {
        "ball: y < %.17g and any particle: speed > %.17g",
        "ball: y < %.17g or any particle: speed > %.17g",
        "not ball: y < %.17g and any particle: speed > %.17g",
        "not (ball: y < %.17g or any particle: speed > %.17g)",
        "step < 10 or step >= 30 and ball: y < %.17g or any particle: speed > %.17g",
        "(step < 10 or step >= 30) and (ball: y < %.17g or any particle: speed > %.17g)",
    };
    for (int c = 0; c < 6; c++) {
        char text[160];
        snprintf(text, sizeof text, condition[c], h, v);
        search(text, ALL);
        size_t at = 0;
        for (int step = 0; step <= STEPS; step++) {
            const bool a = height[step]<h, b = speed[step]> v, early = step < 10, late = step >= 30;
            const bool holds[] = {
                a && b, a || b, !a && b, !(a || b), early || (late && a) || b, (early || late) && (a || b)};
            if (holds[c]) {
                assert_true(at < found.count);
                assert_int_equal(found.item[at++].step, step);
            }
        }
        assert_int_equal(at, found.count);
    }
    forget();
}

static uint64_t simulated;

static bool count_steps(const char *task, uint64_t done, uint64_t total, void *user)
{
    (void)user;
    (void)done;
    (void)total;
    simulated += strcmp(task, "simulating") == 0;
    return true;
}

/* Where metrics decide, nothing is simulated; a search for the last takes the last interval first. */
static void no_more_is_simulated_than_needed(void **state)
{
    (void)state;
    record(false);
    rheo_use_progress((rheo_progress){count_steps, NULL});
    simulated = 0;
    search("time > 0.5 and step != 7", ALL);
    search("step == 33 and step > 40 and any particle: speed > 0", ALL);
    assert_int_equal(simulated, 0);
    assert_int_equal(found.count, 0);
    search("step == 33 and any particle: speed > 0", ALL);
    assert_int_equal(found.count, 1);
    assert_int_equal(simulated, 13); /* from the keyframe at 20 */
    OK(rheo_player_seek(player, 0, &error));
    simulated = 0;
    search("any particle: speed > 0", (rheo_find_options){.which = RHEO_FIND_LAST, .has_before = true, .before = 60});
    assert_int_equal(found.item[0].step, 59);
    assert_true(simulated <= 19);
    rheo_use_progress((rheo_progress){0});
    forget();
}

static void metrics_are_those_of_the_recording(void **state)
{
    (void)state;
    record(false);
    double value[256], most = 0;
    const uint32_t m = rheo_recording_metric_by_name(recording, "max_speed");
    uint64_t at = 0;
    for (uint64_t step = 0; step <= STEPS; step++) {
        OK(rheo_recording_metrics(recording, step, value, &error));
        if (value[m] > most) {
            most = value[m];
            at = step;
        }
    }
    char text[64];
    snprintf(text, sizeof text, "max_speed >= %.17g", most);
    const rheo_search s = search(text, ALL);
    assert_int_equal(s.hits, 1);
    assert_int_equal(s.found.step, at);
    assert_string_equal(s.found.quantity, "max_speed");
    assert_string_equal(s.found.item, "");
    NEAR(s.found.value, most, 0);
    forget();
}

/* After a stage: the player comes to the same states. */
static void stages_are_looked_into(void **state)
{
    (void)state;
    for (int full = 0; full < 2; full++) {
        record(full);
        static const char *const stages[] = {"gravity", "forces@2", "walls", "history"};
        for (size_t i = 0; i < sizeof stages / sizeof *stages; i++) {
            search("any particle: speed > 9", (rheo_find_options){.which = RHEO_FIND_ALL, .stage = stages[i]});
            size_t at = 0;
            for (uint64_t step = 1; step <= STEPS; step++)
                for (uint64_t substep = 1; substep <= 16; substep++) {
                    char name[48];
                    uint64_t id = 0;
                    const bool repeats = strcmp(stages[i], "history") != 0, one = strchr(stages[i], '@') != NULL;
                    if (one || !repeats)
                        snprintf(name, sizeof name, "%s", stages[i]);
                    else
                        snprintf(name, sizeof name, "%s@%d", stages[i], (int)substep);
                    if (rheo_player_seek_stage(player, step, name, &why) != RHEO_OK)
                        break; /* as many substeps as the step has */
                    const double speed = fastest(rheo_player_world(player), &id);
                    if (speed > 9) {
                        assert_true(at < found.count);
                        const rheo_found *f = &found.item[at++];
                        assert_int_equal(f->step, step);
                        assert_string_equal(f->stage, name);
                        assert_int_equal(f->id, id);
                        NEAR(f->value, speed, 0);
                    }
                    if (one || !repeats)
                        break;
                }
            assert_int_equal(at, found.count);
            assert_true(at > 0);
        }
        forget();
    }
}

/* Particles exist from the step in which they were added; springs come and go. */
static void things_exist_for_a_time(void **state)
{
    (void)state;
    record(false);
    const uint32_t first = (uint32_t)rheo_recording_get_info(recording).particles;
    char text[64];
    snprintf(text, sizeof text, "particle %u exists", first);
    rheo_search s = search(text, ALL);
    assert_int_equal(s.hits, STEPS - 23);
    assert_int_equal(found.item[0].step, 24);
    assert_string_equal(found.item[0].quantity, "exists");
    snprintf(text, sizeof text, "particle %u: speed >= 0", first + 1);
    assert_int_equal(search(text, ALL).hits, STEPS - 23);
    snprintf(text, sizeof text, "particle %u: speed >= 0", first + 2);
    REFUSED(RHEO_ERROR_ARGUMENT, "the recording has no particle", rheo_player_find(player, text, NULL, &s, &error));
    bool there[STEPS + 1];
    rheo_spring ends = {0};
    OK(rheo_player_seek(player, 30, &error));
    const size_t count = rheo_world_spring_count(rheo_player_world(player));
    rheo_spring *spring = calloc(count, sizeof *spring);
    OK(rheo_world_springs(rheo_player_world(player), spring, count));
    size_t times = 0;
    for (size_t k = 0; k < count && (times < 5 || times > STEPS - 5); k++) { /* one that is not always there */
        ends = spring[k];
        times = 0;
        for (uint64_t step = 0; step <= STEPS && k % 16 == 0; step++) {
            rheo_spring_state state_of;
            OK(rheo_player_seek(player, step, &error));
            there[step] = rheo_world_spring(rheo_player_world(player), ends.a, ends.b, &state_of, &why) == RHEO_OK;
            times += there[step];
        }
    }
    free(spring);
    assert_true(times >= 5 && times <= STEPS - 5);
    snprintf(text, sizeof text, "spring %u:%u exists", ends.b, ends.a); /* in any order */
    s = search(text, ALL);
    assert_int_equal(s.hits, times);
    for (size_t i = 0; i < times; i++)
        assert_true(there[found.item[i].step]);
    assert_int_equal(s.found.id, ends.a);
    assert_int_equal(s.found.other_id, ends.b);
    forget();
}

static void what_is_not_understood_is_refused(void **state)
{
    (void)state;
    static const struct {
        const char *condition, *text;
    } cases[] = {
        {"", "needs the name of a metric"},
        {"max_speed", "needs one of < <= > >= == !="},
        {"max_speed >", "it needs a number"},
        {"max_speed > 3x", "it needs a number"},
        {"max_speed = 3", "equality is written =="},
        {"max_speed > 3 max_speed < 4", "combined with and, or"},
        {"max_speed > 3 and", "ends too early"},
        {"(max_speed > 3", "a parenthesis is not closed"},
        {"max_sped > 3", "did you mean \"max_speed\""},
        {"speed > 3", "speed is no metric; say of what"},
        {"particle: speed > 3", "the id of a particle is a whole number"},
        {"particle 1.5: speed > 3", "the id of a particle is a whole number"},
        {"particle 4294967296: speed > 3", "the id of a particle is a whole number"},
        {"particle 1 speed > 3", "followed by : and a quantity"},
        {"particle 1: sped > 3", "a particle has no quantity \"sped\"; there are x, y, z"},
        {"particle 1: density.x > 3", "has no quantity \"density.x\""},
        {"any spring: kapa > 3", "there are length, rest_length, stretch"},
        {"spring 1: length > 3", "the id of a particle is a whole number"},
        {"spring 1:1 exists", "and these are one"},
        {"any ball: y > 3", "\"any\" is followed by particle or spring"},
        {"any particle exists", "followed by : and a quantity"},
        {"ball: temperature > 3", "the ball has no quantity \"temperature\"; there are"},
    };
    rheo_search s;
    record(false);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        REFUSED(RHEO_ERROR_ARGUMENT, cases[i].text, rheo_player_find(player, cases[i].condition, NULL, &s, &error));
        assert_int_equal(s.hits, 0);
    }
    char many[1200] = "step > 0";
    for (int i = 0; i < 32; i++)
        strcat(many, " and step > 0");
    REFUSED(RHEO_ERROR_ARGUMENT, "at most 32 comparisons", rheo_player_find(player, many, NULL, &s, &error));
    char deep[256] = "";
    for (int i = 0; i < 40; i++)
        strcat(deep, "not ");
    strcat(deep, "step > 0");
    REFUSED(RHEO_ERROR_ARGUMENT, "more than 16 levels", rheo_player_find(player, deep, NULL, &s, &error));
    rheo_find_options o = {.stage = "forces"};
    REFUSED(RHEO_ERROR_ARGUMENT, "which belongs to the end of a step",
            rheo_player_find(player, "step > 0", &o, &s, &error));
    o.stage = "force";
    REFUSED(RHEO_ERROR_ARGUMENT, "there is no stage \"force\"",
            rheo_player_find(player, "ball: y < 0", &o, &s, &error));
    o = (rheo_find_options){.has_after = true, .after = STEPS};
    REFUSED(RHEO_ERROR_ARGUMENT, "there is no step to look at",
            rheo_player_find(player, "ball: y < 0", &o, &s, &error));
    o = (rheo_find_options){.has_before = true, .before = 0};
    REFUSED(RHEO_ERROR_ARGUMENT, "there is no step to look at",
            rheo_player_find(player, "ball: y < 0", &o, &s, &error));
    forget();
}

static bool stop_at_10(const char *task, uint64_t done, uint64_t total, void *user)
{
    (void)user;
    (void)total;
    return strcmp(task, "searching") != 0 || done < 10;
}

static struct {
    uint64_t calls, done, total;
} searched;

static bool count_searched(const char *task, uint64_t done, uint64_t total, void *user)
{
    (void)user;
    if (strcmp(task, "searching") != 0)
        return true;
    searched.calls++;
    assert_true(done >= searched.done && done <= total);
    searched.done = done;
    searched.total = total;
    return true;
}

/* Progress counts the places that were looked at, of those between the first and the last one that may be. */
static void progress_of_a_search_counts_its_steps(void **state)
{
    (void)state;
    static const uint64_t RANGE[][2] = {{0, STEPS}, {7, 50}, {20, 20}, {13, 14}};
    record(false);
    rheo_use_progress((rheo_progress){count_searched, NULL});
    for (size_t i = 0; i < sizeof RANGE / sizeof *RANGE; i++)
        for (int last = 0; last < 2; last++) {
            const rheo_find_options options = {.which = last ? RHEO_FIND_LAST : RHEO_FIND_FIRST,
                                               .has_after = RANGE[i][0] > 0,
                                               .has_before = RANGE[i][1] < STEPS,
                                               .after = RANGE[i][0] - 1,
                                               .before = RANGE[i][1] + 1};
            rheo_search s;
            memset(&searched, 0, sizeof searched);
            OK(rheo_player_find(player, "ball: y < -1000", &options, &s, &error));
            const uint64_t steps = RANGE[i][1] - RANGE[i][0] + 1;
            assert_true(searched.calls > 0 && searched.done == steps && searched.total == steps);
            assert_true(s.first == RANGE[i][0] && s.last == RANGE[i][1]);
        }
    rheo_use_progress((rheo_progress){0});
    forget();
}

/* A search can be ended from both sides, and says how far it has looked. */
static void searches_can_be_ended(void **state)
{
    (void)state;
    record(false);
    rheo_search s;
    rheo_use_progress((rheo_progress){stop_at_10, NULL});
    assert_int_equal(rheo_player_find(player, "ball: y < -1000", NULL, &s, &why), RHEO_ERROR_STOPPED);
    rheo_use_progress((rheo_progress){0});
    assert_true(s.hits == 0 && s.looked && s.first == 0 && s.last == 9);
    found.most = 3;
    s = search("ball: y > -1000", ALL);
    found.most = 0;
    assert_int_equal(s.hits, 3);
    assert_int_equal(s.last, 2);
    forget();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_first_and_last_are_those_of_playing),
        cmocka_unit_test(conditions_are_combined),
        cmocka_unit_test(no_more_is_simulated_than_needed),
        cmocka_unit_test(metrics_are_those_of_the_recording),
        cmocka_unit_test(stages_are_looked_into),
        cmocka_unit_test(things_exist_for_a_time),
        cmocka_unit_test(what_is_not_understood_is_refused),
        cmocka_unit_test(searches_can_be_ended),
        cmocka_unit_test(progress_of_a_search_counts_its_steps),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
