/*
 * Chains of causes (record/why_chain.c) and distances (record/why_not.c) in hard cases: values that are not finite, rows with
 * entries without partners, pairs across a border of periodic space.
 */
#include "why.h"

/* ---- NaN and infinity ---- */

static const double HUGE_NUMBER = RHEO_DOUBLE ? 1e308 : 3e38; /* ten times as much is infinite */

/* A step of length 10 of particles at rest but for one; springs and viscosity are off. */
static rheo_world_def huge_step(void)
{
    rheo_world_def def = inert_def();
    def.step = 10;
    def.substeps = 1;
    return def;
}

/* Makes one step, which fails or not. */
static recorded record_step(rheo_world *world, rheo_result expected)
{
    rheo_error why = {""};
    rheo_recorder *recorder = record_in_memory(world);
    const rheo_result result = rheo_recorder_step(recorder, &why);
    if (result != expected)
        fail_msg("the step ends with %d: %s", (int)result, why.message);
    return reopen(recorder, world);
}

enum { MOST_LINKS = 8 };

typedef struct links {
    rheo_link of[MOST_LINKS];
    size_t count;
    rheo_chain chain;
} links;

static bool keep_link(void *data, const rheo_link *link)
{
    links *l = data;
    assert_true(l->count < MOST_LINKS);
    l->of[l->count++] = *link;
    return true;
}

/* The chain of step 1; all that is told of the particle is exact. */
static links chain_of(const recorded *r, uint64_t id, const char *stage, const char *field)
{
    links l = {.count = 0};
    told t = {.of = "not finite"};
    check_particle(r->player, 1, id, &t);
    OK(rheo_player_why_chain(r->player, 1, stage, id, field, MOST_LINKS, keep_link, &l, &l.chain, &error));
    assert_int_equal(l.count, l.chain.links);
    return l;
}

static void is_link(const rheo_link *link, const char *stage, const char *field, uint64_t id, const char *what,
                    rheo_source source)
{
    assert_string_equal(link->stage, stage);
    assert_string_equal(link->field, field);
    assert_int_equal(link->id, id);
    assert_string_equal(rheo_not_finite_name(link->not_finite), what);
    assert_int_equal(link->largest.source, source);
}

/* The velocity makes the position infinite, which sets the velocity in a later stage of scheme sequential. */
static void infinity_is_passed_on_to_a_later_stage(void **state)
{
    (void)state;
    const rheo_real position[3] = {1, 2, 3}, velocity[3] = {0, 0, (rheo_real)HUGE_NUMBER};
    rheo_world_def def = huge_step();
    def.scheme = RHEO_SCHEME_SEQUENTIAL;
    def.substeps = 0;
    recorded r = record_step(world_of(def, 1, position, velocity), RHEO_ERROR_STATE);
    const links l = chain_of(&r, 0, NULL, "velocity");
    assert_int_equal(l.count, 2);
    is_link(&l.of[0], "velocity", "velocity", 0, "passed on", RHEO_SOURCE_DISPLACEMENT);
    is_link(&l.of[1], "prediction", "position", 0, "born", RHEO_SOURCE_VELOCITY);
    assert_int_equal(l.chain.end, RHEO_CHAIN_BORN);
    discard(&r);
}

/* Particle 1 leaves to infinity; its neighbour gets NaN from it by their pressure. */
static void not_a_number_is_passed_on_to_a_partner(void **state)
{
    (void)state;
    const rheo_real position[6] = {1, 2, 3, 2, 2, 3}, velocity[6] = {0, 0, 0, (rheo_real)HUGE_NUMBER, 0, 0};
    rheo_world_def def = huge_step();
    def.fluid.stiffness = 1e-3;
    recorded r = record_step(world_of(def, 2, position, velocity), RHEO_ERROR_STATE);
    const links l = chain_of(&r, 0, NULL, "position");
    assert_int_equal(l.count, 2);
    is_link(&l.of[0], "forces@1", "position", 0, "passed on", RHEO_SOURCE_PRESSURE);
    assert_int_equal(l.of[0].largest.item, 1);
    is_link(&l.of[1], "prediction@1", "position", 1, "born", RHEO_SOURCE_VELOCITY);
    assert_int_equal(l.chain.end, RHEO_CHAIN_BORN);
    discard(&r);
}

/* A plate puts its particles in place, whatever they were: the step is good. */
static void a_plate_swallows_infinity(void **state)
{
    (void)state;
    if (RHEO_DOUBLE)
        skip(); /* no parameters make it infinite */
    const rheo_real position[6] = {1, 1, 1, 1, 9, 1};
    rheo_world_def def = huge_step();
    def.step = 1e5;
    def.space.period[0] = def.space.period[2] = 20;
    def.plates.lower = 4;
    def.plates.upper = 6;
    def.gravity[1] = -1e30;
    recorded r = record_step(world_of(def, 2, position, NULL), RHEO_OK);
    for (uint64_t id = 0; id < 2; id++) {
        const links l = chain_of(&r, id, "plates@1", "position");
        assert_int_equal(l.count, 2);
        is_link(&l.of[0], "plates@1", "position", id, "swallowed", RHEO_SOURCE_PLATE);
        is_link(&l.of[1], "prediction@1", "position", id, "born", RHEO_SOURCE_VELOCITY);
        assert_int_equal(l.chain.end, RHEO_CHAIN_BORN);
    }
    discard(&r);
}

/*
 * All fall so far that the squared distance to the place of idle entries overflows. These add NaN instead of 0. Particle 3
 * has them, because it has fewer neighbours than particle 1.
 */
static void an_entry_without_a_partner_is_told(void **state)
{
    (void)state;
    if (RHEO_DOUBLE)
        skip(); /* its squares hold such distances */
    const rheo_real position[12] = {1, 2, 3, 2, 2, 3, 1.5F, 2, 4, 3.5F, 2, 3};
    rheo_world_def def = huge_step();
    def.gravity[1] = -1e30;
    def.fluid.stiffness = 1e-3;
    recorded r = record_step(world_of(def, 4, position, NULL), RHEO_ERROR_STATE);
    const links l = chain_of(&r, 3, NULL, "position");
    assert_int_equal(l.count, 1);
    is_link(&l.of[0], "forces@1", "position", 3, "born", RHEO_SOURCE_PRESSURE);
    assert_int_equal(l.of[0].largest.item, 3);
    assert_string_equal(l.of[0].largest.sum, "pressure");
    discard(&r);
}

/* ---- Periodic space ---- */

/* All that changes one of two neighbours comes from the other, and pushes it along x in this direction. */
typedef struct pushed {
    uint64_t by;
    double direction;
    size_t count;
} pushed;

static bool is_pushed(void *data, const rheo_change *change)
{
    pushed *p = data;
    assert_true(change->exact);
    p->count += change->count;
    for (size_t i = 0; i < change->count; i++) {
        assert_int_equal(change->contribution[i].item, p->by);
        assert_true(change->contribution[i].change[0] * p->direction > 0);
    }
    return true;
}

/* Three particles in a row at rest; 0 and 1 are neighbours across the border of x alone. */
static void a_pair_across_a_border_is_told(void **state)
{
    (void)state;
    const double length = 12;
    const rheo_real position[9] = {-5.5F, 0, 0, 5.5F, 0, 0, 0, 0, 0};
    rheo_world_def def = inert_def();
    def.substeps = 1;
    def.space.period[0] = def.space.period[2] = length;
    def.fluid.stiffness = 10;
    def.fluid.rest_density = 0;
    def.springs.stiffness = 10;
    def.springs.rest_length = RHEO_REST_SUPPORT;
    recorded r = record_step(world_of(def, 3, position, NULL), RHEO_OK);
    for (uint64_t id = 0; id < 2; id++) {
        pushed p = {.by = 1 - id, .direction = id ? -1 : 1}; /* away from the image, into the period */
        OK(rheo_player_why(r.player, 1, "forces", id, "velocity", is_pushed, &p, &error));
        assert_int_equal(p.count, 2); /* pressure and a spring */
    }
    rheo_why_not w;
    OK(rheo_player_why_not(r.player, 1, 0, 1, false, NULL, NULL, &w, &error));
    OK(rheo_player_seek(r.player, 1, &error));
    rheo_real x[9]; /* the world of the player does not last */
    memcpy(x, rheo_world_positions(rheo_player_world(r.player)), sizeof x);
    assert_true(w.holds && w.across);
    NEAR(w.at.distance, length - ((double)x[3] - (double)x[0]), 1e-5);
    assert_true(says(w.why, "across a border of periodic space, and so are neighbours"));
    OK(rheo_player_why_not(r.player, 1, 0, 2, false, NULL, NULL, &w, &error));
    assert_true(!w.holds && !w.across);
    NEAR(w.at.distance, (double)x[6] - (double)x[0], 1e-5);
    OK(rheo_player_why_not(r.player, 1, 1, 0, true, NULL, NULL, &w, &error));
    assert_true(w.holds && w.across && w.at.spring);
    assert_true(says(w.why, "across a border of periodic space, and have a spring"));
    discard(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(infinity_is_passed_on_to_a_later_stage),
        cmocka_unit_test(not_a_number_is_passed_on_to_a_partner),
        cmocka_unit_test(a_plate_swallows_infinity),
        cmocka_unit_test(an_entry_without_a_partner_is_told),
        cmocka_unit_test(a_pair_across_a_border_is_told),
    };
    return cmocka_run_group_tests_name("chains of causes", tests, NULL, NULL);
}
