/*
 * Who changed a particle of the melting model: what stages say that they added gives the values of the state, bit for bit, in
 * every variant of the model; and what they say is true.
 */
#include "melting_support.h"

#include "core/account.h"
#include "record/recording.h"

static const char *const FIELDS[] = {"position", "velocity", "density", "temperature"};
enum { FIELD_COUNT = sizeof FIELDS / sizeof *FIELDS };

/* ---- Recordings ---- */

typedef struct played {
    void *bytes;
    rheo_recording *recording;
    rheo_player *player;
    uint64_t last; /* step that can be looked into, the one that failed included */
} played;

static played play_of(rheo_recording *recording, void *bytes)
{
    played p = {.bytes = bytes, .recording = recording};
    rheo_failure failure;
    OK(rheo_player_open(recording, NULL, &p.player, &error));
    p.last = rheo_recording_get_info(recording).last_step + rheo_recording_failure(recording, &failure);
    return p;
}

/* Records steps of a world, at most until one fails, and destroys it. */
static played play(rheo_world *world, int steps)
{
    rheo_recorder *recorder;
    rheo_recording *recording;
    rheo_error refusal = {""};
    void *bytes;
    size_t size;
    rheo_result result = RHEO_OK;
    OK(rheo_recorder_open_memory(world, NULL, &recorder, &error));
    for (int i = 0; i < steps && result == RHEO_OK; i++)
        result = rheo_recorder_step(recorder, &refusal);
    if (result != RHEO_OK && result != RHEO_ERROR_STATE)
        fail_msg("%s", refusal.message);
    OK(rheo_recorder_close_memory(recorder, &bytes, &size, &error));
    rheo_world_destroy(world);
    OK(rheo_recording_open_memory(bytes, size, &recording, &error));
    return play_of(recording, bytes);
}

static void stop(played *p)
{
    rheo_player_close(p->player);
    rheo_recording_close(p->recording);
    free(p->bytes);
}

/* ---- Exactness ---- */

typedef struct seen {
    const char *what;
    uint64_t id, changes, contributions;
} seen;

static bool check_change(void *data, const rheo_change *change)
{
    seen *s = data;
    if (!change->exact)
        fail_msg("%s: step %llu, %s: the contributions do not give the %s of particle %llu", s->what,
                 (unsigned long long)change->step, change->stage, change->field, (unsigned long long)s->id);
    if (change->count == 0)
        fail_msg("%s: step %llu, %s changed the %s of particle %llu, but has no contributions", s->what,
                 (unsigned long long)change->step, change->stage, change->field, (unsigned long long)s->id);
    s->changes++;
    s->contributions += change->count;
    return true;
}

/* All stage runs of a step for a particle; each holds for all fields. */
static void check_particle(const played *p, seen *s, uint64_t step, uint64_t id)
{
    rheo__account account = {.allocator = rheo__allocator_or_default((rheo_allocator){0}), .id = (uint32_t)id};
    OK(rheo__player_step_account(p->player, step, &account, &error));
    assert_true(account.stages > 0);
    for (size_t i = 0; i < account.stages; i++)
        if (!account.stage[i].holds)
            fail_msg("%s: step %llu, %s: the lines do not give the values of particle %llu", s->what,
                     (unsigned long long)step, account.stage[i].name, (unsigned long long)id);
    rheo__account_release(&account);
}

/* What users are told of it. */
static void check_report(const played *p, seen *s, uint64_t step, uint64_t id)
{
    s->id = id;
    for (size_t f = 0; f < FIELD_COUNT; f++) {
        rheo_error error;
        const rheo_result result = rheo_player_why(p->player, step, NULL, id, FIELDS[f], check_change, s, &error);
        if (result != RHEO_OK && !(result == RHEO_ERROR_ARGUMENT && says(error.message, "no field")))
            fail_msg("%s: %s", s->what, error.message);
    }
}

/* Whether particle i is a better example of kind k than j: lowest, highest, leftmost, rightmost, hottest, fastest, thinnest. */
enum { KINDS = 7 };
static bool is_better(const rheo__state *s, int kind, uint32_t i, uint32_t j)
{
    const rheo_real *x = s->position + 3 * (size_t)i, *y = s->position + 3 * (size_t)j;
    const rheo_real *v = s->velocity + 3 * (size_t)i, *w = s->velocity + 3 * (size_t)j;
    switch (kind) {
    case 0:
        return x[1] < y[1];
    case 1:
        return x[1] > y[1];
    case 2:
        return x[0] < y[0];
    case 3:
        return x[0] > y[0];
    case 4:
        return s->temperature && s->temperature[i] > s->temperature[j];
    case 5:
        return rheo__length2(v[0], v[1], v[2]) > rheo__length2(w[0], w[1], w[2]);
    default:
        return s->density[i] < s->density[j];
    }
}

/* Checks a step for the first particles, the last one, one in the middle and all examples. */
static void check_step(const played *p, seen *s, uint64_t step)
{
    OK(rheo_player_seek(p->player, step - 1, &error));
    const rheo__state *state = &rheo_player_world(p->player)->state;
    uint32_t id[KINDS + 4] = {0, 1, state->particles / 2, state->particles - 1};
    for (int kind = 0; kind < KINDS; kind++)
        for (uint32_t i = 1; i < state->particles; i++)
            if (is_better(state, kind, i, id[4 + kind]))
                id[4 + kind] = i;
    static size_t count; /* slow builds check every n-th, of each kind in turn */
    for (int i = 0; i < KINDS + 4; i++)
        if (count++ % every() == 0)
            check_particle(p, s, step, id[i]);
    check_report(p, s, step, id[count++ % (KINDS + 4)]);
}

static void check_recording(const char *name)
{
    char path[1024];
    rheo_recording *recording;
    snprintf(path, sizeof path, "%s/%s.rlog", getenv("REPLAYS"), name);
    OK(rheo_recording_open(path, &recording, &error));
    played p = play_of(recording, NULL);
    seen s = {.what = name};
    check_step(&p, &s, rheo_recording_get_info(recording).first_step + 1);
    check_step(&p, &s, p.last);
    print_message("%s: %llu changes, %llu contributions\n", name, (unsigned long long)s.changes,
                  (unsigned long long)s.contributions);
    stop(&p);
}

static void recordings_are_exact(void **unused)
{
    (void)unused;
    static const char *const NAMES[] = {"melt",
                                        "melt-commands",
                                        "melt-failure",
                                        "melt-printed",
                                        "melt-summation",
                                        "builtin/melting-all",
                                        "builtin/melting-box",
                                        "builtin/melting-bunny",
                                        "builtin/melting-bunny-small",
                                        "builtin/melting-drop",
                                        "builtin/melting-logo"};
    if (!IS_FLOAT)
        skip(); /* they are of float builds */
    for (size_t i = 0; i < sizeof NAMES / sizeof *NAMES; i++)
        check_recording(NAMES[i]);
}

/* ---- Variants ---- */

/*
 * A box that melts in a corner of two walls, one of them slanting and one above it. It moves and shears; particles 0 and 1
 * coincide.
 */
static rheo_world *lively_box(rheo_world_def def)
{
    random_state = 1;
    fluid f = lattice(0.1, 5, 6, 5, 0.1);
    warm_by_height(&f, 0.6);
    for (int axis = 0; axis < 3; axis++)
        f.x[3 + axis] = f.x[axis];
    for (uint32_t i = 0; i < f.count; i++) {
        f.v[3 * i] = (rheo_real)(0.5 - random_unit()) + f.x[3 * i + 1];
        f.v[3 * i + 1] = -(rheo_real)0.3;
        f.density[i] = (rheo_real)(1 + 0.01 * random_unit());
    }
    add_wall(&def, 0, 0, 0, 0.1, 1, 0);
    add_wall(&def, 0, 0, 0, 1, 0, 0);
    add_wall(&def, 0, 0.65, 0, 0, -1, 0);
    return melt_of(def, f);
}

static void every_variant_is_exact(void **unused)
{
    (void)unused;
    static const char *const VARIANTS[][5] = {
        {"melting.stress", "nested"},
        {"melting.solver", "explicit", "melting.jump_number_max", "5"},
        {"melting.stress", "nested", "melting.solver", "explicit"},
        {"melting.rheology", "newtonian"},
        {"melting.viscosity", "0"},
        {"melting.wall", "free-slip"},
        {"melting.wall", "free-slip", "melting.stress", "nested"},
        {"melting.density", "summation"},
        {"melting.laplacian", "second"},
        {"melting.flow", "frozen"},
        {"melting.flow", "frozen", "melting.laplacian", "second"},
        {"melting.flow", "frozen", "paper.heat", "on"},
        {"melting.diffusivity", "0"},
        {"melting.xsph", "0"},
        {"melting.xsph", "0", "paper.xsph", "on"},
        {"melting.repulsion", "0"},
        {"melting.alpha", "0", "melting.beta", "0"},
        {"melting.max_iterations", "1"},
        {"melting.tolerance", "1e-9"},
        {"gravity", "[0, 0, 0]"},
        {"paper.kernel", "on"},
        {"paper.jump", "on"},
        {"paper.artificial_viscosity", "on"},
        {"paper.xsph", "on"},
        {"paper.heat", "on"},
        {"paper.leapfrog", "on"},
        {"paper.leapfrog", "on", "melting.density", "summation"},
        {"paper.xsph", "on", "paper.leapfrog", "on"},
    };
    for (size_t i = 0; i < sizeof VARIANTS / sizeof *VARIANTS; i++) {
        rheo_world_def def = melt_def(0.1);
        def.melting.diffusivity = 0.01;
        def.melting.jump_number_max = 100;
        def.melting.substeps = 3;
        char what[256] = "";
        for (int k = 0; VARIANTS[i][k]; k += 2) {
            set(&def, VARIANTS[i][k], VARIANTS[i][k + 1]);
            const size_t length = strlen(what);
            snprintf(what + length, sizeof what - length, "%s=%s ", VARIANTS[i][k], VARIANTS[i][k + 1]);
        }
        seen s = {.what = what};
        played p = play(lively_box(def), 2);
        assert_int_equal(p.last, 2);
        check_step(&p, &s, 1);
        check_step(&p, &s, 2);
        print_message("%s: %llu changes, %llu contributions\n", what, (unsigned long long)s.changes,
                      (unsigned long long)s.contributions);
        assert_true(s.contributions > 100);
        stop(&p);
    }
}

/* A step fails: densities below 0, and a system that cannot be solved in float. */
static void a_step_that_fails_is_exact(void **unused)
{
    (void)unused;
    for (int unsolvable = 0; unsolvable < (IS_FLOAT ? 2 : 1); unsolvable++) {
        rheo_world_def def = melt_def(0.1);
        def.melting.substeps = 1;
        def.step = unsolvable ? 0.01 : 0.1;
        if (unsolvable)
            def.melting.viscosity = 1e30;
        seen s = {.what = unsolvable ? "unsolvable" : "torn apart"};
        played p = play(lively_box(def), 50);
        rheo_failure failure;
        assert_true(rheo_recording_failure(p.recording, &failure));
        print_message("%s: step %llu, %s, %s\n", s.what, (unsigned long long)p.last, failure.stage, failure.field);
        check_step(&p, &s, p.last);
        check_particle(&p, &s, p.last, (uint64_t)failure.id);
        assert_true(s.contributions > 0);
        stop(&p);
    }
}

/* Without one addition, of whatever source, values differ from those of the state. Rounding hides small ones. */
static void a_missing_addition_is_noticed(void **unused)
{
    (void)unused;
    static const rheo_source SOURCES[] = {RHEO_SOURCE_GRAVITY,   RHEO_SOURCE_PRESSURE, RHEO_SOURCE_PARTING,
                                          RHEO_SOURCE_VISCOSITY, RHEO_SOURCE_WALL,     RHEO_SOURCE_SOLVER,
                                          RHEO_SOURCE_FLOW,      RHEO_SOURCE_HEAT,     RHEO_SOURCE_DRIFT};
    rheo_world_def def = melt_def(0.1);
    def.melting.diffusivity = 0.01;
    def.melting.substeps = 1;
    played p = play(lively_box(def), 1);
    rheo__account a = {.allocator = rheo__allocator_or_default((rheo_allocator){0}), .id = 1};
    OK(rheo__player_step_account(p.player, 1, &a, &error));
    uint32_t lines[RHEO_SOURCE_COUNT] = {0}, noticed[RHEO_SOURCE_COUNT] = {0};
    const rheo__account_stage *last = &a.stage[a.stages - 1];
    for (size_t k = 0; k < a.count; k++) {
        rheo__account_values values;
        memcpy(values, a.stage[0].before, sizeof values);
        rheo__account_replay(&a, 0, k, values);
        rheo__account_replay(&a, k + 1, a.count, values);
        lines[a.line[k].source]++;
        noticed[a.line[k].source] += memcmp(values, last->after, RHEO__FIELD_COUNT * sizeof *values) != 0;
    }
    for (size_t i = 0; i < sizeof SOURCES / sizeof *SOURCES; i++) {
        const rheo_source source = SOURCES[i];
        print_message("%s: %u of %u are noticed\n", rheo_source_name(source), noticed[source], lines[source]);
        assert_true(lines[source] > 0 && 2 * noticed[source] >= lines[source]);
    }
    rheo__account_release(&a);
    stop(&p);
}

/* ---- Truth ---- */

/* The contributions to a field of a particle by a stage, as changes of the field. */
enum { MOST = 1000 };
typedef struct account {
    rheo_contribution of[MOST];
    size_t count;
    double before[3], after[3];
} account;

static bool keep(void *data, const rheo_change *change)
{
    account *a = data;
    assert_true(a->count == 0 && change->count <= MOST && change->exact);
    a->count = change->count;
    memcpy(a->of, change->contribution, change->count * sizeof *a->of);
    memcpy(a->before, change->before, sizeof a->before);
    memcpy(a->after, change->after, sizeof a->after);
    return true;
}

static void look(const played *p, uint64_t step, const char *stage, uint32_t id, const char *field, account *a)
{
    a->count = 0;
    OK(rheo_player_why(p->player, step, stage, id, field, keep, a, &error));
}

/* The sum of the contributions of a source, of all items or one; false: there is none. */
enum { ALL = -1 };
static bool sum_of(const account *a, rheo_source source, int64_t item, const char *of_sum, double sum[3])
{
    bool any = false;
    memset(sum, 0, 3 * sizeof *sum);
    for (size_t i = 0; i < a->count; i++)
        if (a->of[i].source == source && (item == ALL || a->of[i].item == (uint64_t)item) &&
            (!of_sum || strcmp(a->of[i].sum, of_sum) == 0)) {
            for (int axis = 0; axis < 3; axis++)
                sum[axis] += a->of[i].change[axis];
            any = true;
        }
    return any;
}

static double size_of(const double v[3])
{
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}
static double difference(const double a[3], const double b[3], double by)
{
    return size_of((double[]){a[0] - by * b[0], a[1] - by * b[1], a[2] - by * b[2]});
}

static played some_substeps(rheo_world_def def, uint64_t substeps)
{
    def.melting.diffusivity = 0.01;
    def.melting.jump_number_max = 100;
    def.melting.substeps = substeps;
    def.step = 0.002 * (double)substeps;
    return play(lively_box(def), 1);
}

/*
 * For all partners of some particles, checks that the contributions of a source are opposite to those that the partner has by
 * the particle, or have the ratio of the squares of densities. Returns how many pairs there are.
 */
static int check_pairs(const played *p, const char *stage, const char *field, rheo_source source, const char *sum,
                       bool of_density, double tolerance)
{
    static account own, other;
    int pairs = 0;
    OK(rheo_player_seek(p->player, 0, &error));
    rheo_real density[1000];
    memcpy(density, rheo_player_world(p->player)->state.density,
           rheo_player_world(p->player)->state.particles * sizeof *density);
    for (uint32_t id = 0; id < 150; id += 37) {
        look(p, 1, stage, id, field, &own);
        for (size_t i = 0; i < own.count; i += 5) {
            double a[3], b[3];
            if (own.of[i].source != source || (sum && strcmp(own.of[i].sum, sum) != 0))
                continue;
            const uint32_t partner = (uint32_t)own.of[i].item;
            assert_true(partner != id && sum_of(&own, source, partner, sum, a));
            look(p, 1, stage, partner, field, &other);
            assert_true(sum_of(&other, source, id, sum, b));
            const double by = of_density ? pow((double)(density[id] / density[partner]), 2) : -1;
            if (!(difference(a, b, by) <= tolerance * size_of(a)))
                fail_msg("%s: %u gets %g %g %g from %u, which gets %g %g %g", rheo_source_name(source), id, a[0],
                         a[1], a[2], partner, b[0], b[1], b[2]);
            pairs++;
        }
    }
    return pairs;
}

static const double ROUNDING = IS_FLOAT ? 2e-6 : 1e-14;

/* What a particle gets from another, that one loses. */
static void pairs_are_opposite(void **unused)
{
    (void)unused;
    for (int nested = 0; nested < 2; nested++)
        for (int is_explicit = 0; is_explicit < 2; is_explicit++) {
            rheo_world_def def = melt_def(0.1);
            set(&def, "melting.stress", nested ? "nested" : "pairwise");
            set(&def, "melting.solver", is_explicit ? "explicit" : "implicit");
            played p = some_substeps(def, 1);
            assert_true(check_pairs(&p, "momentum", "velocity", RHEO_SOURCE_PRESSURE, "acceleration", false, 0) > 50);
            assert_true(check_pairs(&p, "momentum", "velocity", RHEO_SOURCE_PARTING, "acceleration", false, 0) <= 1);
            assert_true(check_pairs(&p, "viscosity", "velocity", RHEO_SOURCE_VISCOSITY, "viscosity", false,
                                    100 * ROUNDING) > 30);
            assert_true(
                check_pairs(&p, "integration", "temperature", RHEO_SOURCE_HEAT, "heat_rate", false, ROUNDING) > 50);
            assert_true(check_pairs(&p, "integration", "density", RHEO_SOURCE_FLOW, "density_rate", true,
                                    100 * ROUNDING) > 50);
            stop(&p);
        }
}

/* The slope of the kernel over r, in double. */
static double slope_at(double r2, double h)
{
    static const double FACTOR[] = {15, -6, 1};
    const double q = sqrt(r2) / h;
    double slope = 0;
    for (int a = 1; a <= 3; a++)
        slope -= q < a ? 5 * FACTOR[a - 1] * pow(a - q, 4) : 0;
    return slope / (120 * PI * h * h * h * h * sqrt(r2));
}

/* Heat and viscosity of pairs are those of docs/melting.md (5, 6). */
static void pairs_obey_their_equations(void **unused)
{
    (void)unused;
    for (int is_explicit = 0; is_explicit < 2; is_explicit++) {
        rheo_world_def def = melt_def(0.1);
        set(&def, "melting.solver", is_explicit ? "explicit" : "implicit");
        played p = some_substeps(def, 1);
        rheo_world *before;
        OK(rheo_recording_world(p.recording, 0, NULL, &before, &error));
        const rheo__state *s = &before->state;
        const uint32_t id = 77;
        static account heat, viscous;
        look(&p, 1, "integration", id, "temperature", &heat);
        look(&p, 1, "viscosity", id, "velocity", &viscous);
        const rheo__melting *m = rheo__melting_of(rheo_player_world(p.player));
        const double dt = (double)m->substep, h = m->smoothing_length, mass = rheo__melting_mass(m->def);
        const uint32_t i = m->pairs.rank_of[id];
        int pairs = 0, viscous_pairs = 0;
        for (uint32_t other = 0; other < s->particles; other++) {
            const uint32_t j = m->pairs.rank_of[other];
            double x[3], u[3], got[3];
            for (int axis = 0; axis < 3; axis++) {
                x[axis] = (double)s->position[3 * id + axis] - (double)s->position[3 * other + axis];
                u[axis] = is_explicit ? (double)(s->velocity[3 * id + axis] - s->velocity[3 * other + axis])
                                      : (double)((&m->cg.x[i].x)[axis] - (&m->cg.x[j].x)[axis]);
            }
            const double r2 = x[0] * x[0] + x[1] * x[1] + x[2] * x[2], rho_i = (double)s->density[id],
                         rho_j = (double)s->density[other];
            if (other == id || !(r2 < 8.9 * h * h))
                continue;
            const double slope = slope_at(r2, h);
            assert_true(sum_of(&heat, RHEO_SOURCE_HEAT, other, NULL, got));
            const double flows = dt * 0.01 * 2 * mass * (double)(m->heat_points[i].y + m->heat_points[j].y) /
                                 (rho_i + rho_j) * (double)(s->temperature[id] - s->temperature[other]) * slope;
            NEAR(got[0], flows, 1e3 * ROUNDING * fabs(flows) + 1e-12);
            pairs++;
            if (!(r2 < 6.2 * h * h))
                continue;
            const double eta_i = (double)m->viscosity[i], eta_j = (double)m->viscosity[j];
            const double b = -10 * mass * (double)(m->viscous_factor[i] + m->viscous_factor[j]) * eta_i * eta_j /
                             (eta_i + eta_j) * slope / (rho_i * rho_j * (r2 + 0.01 * h * h));
            const double by = -dt * b * (u[0] * x[0] + u[1] * x[1] + u[2] * x[2]);
            assert_true(sum_of(&viscous, RHEO_SOURCE_VISCOSITY, other, NULL, got));
            if (!(difference(got, x, by) <= 1e3 * ROUNDING * (size_of(got) + 1e-5)))
                fail_msg("viscosity of %u: %g %g %g, not %g %g %g", other, got[0], got[1], got[2], by * x[0],
                         by * x[1], by * x[2]);
            viscous_pairs++;
        }
        print_message("%d pairs, %d of viscosity\n", pairs, viscous_pairs);
        assert_true(pairs > 80 && viscous_pairs > 30);
        rheo_world_destroy(before);
        stop(&p);
    }
}

/* What the solver adds beyond pairs and walls is its tolerance, or the rounding if it is explicit. */
static void the_solver_leaves_little(void **unused)
{
    (void)unused;
    for (int nested = 0; nested < 2; nested++)
        for (int is_explicit = 0; is_explicit < 2; is_explicit++) {
            rheo_world_def def = melt_def(0.1);
            set(&def, "melting.stress", nested ? "nested" : "pairwise");
            set(&def, "melting.solver", is_explicit ? "explicit" : "implicit");
            set(&def, "melting.tolerance", "1e-4");
            def.melting.max_iterations = 1000;
            played p = some_substeps(def, 2);
            static account a;
            double most = 0, most_change = 0;
            for (uint32_t id = 0; id < 150; id += 7) {
                double rest[3], pairs[3], walls[3];
                look(&p, 1, "viscosity@2", id, "velocity", &a);
                sum_of(&a, RHEO_SOURCE_SOLVER, ALL, NULL, rest);
                assert_true(sum_of(&a, RHEO_SOURCE_VISCOSITY, ALL, NULL, pairs));
                sum_of(&a, RHEO_SOURCE_WALL, ALL, NULL, walls);
                most = fmax(most, size_of(rest));
                most_change = fmax(most_change, difference(pairs, walls, -1));
            }
            print_message("%s, %s: rest %.2g of %.2g\n", nested ? "nested" : "pairwise",
                          is_explicit ? "explicit" : "implicit", most, most_change);
            assert_true(most_change > 0.01 && most < (is_explicit ? 10 * ROUNDING : 1e-3) * most_change);
            stop(&p);
        }
}

/* Fluid at rest: the floor carries the weight of a column. */
static void a_floor_carries_the_weight(void **unused)
{
    (void)unused;
    enum { WIDTH = 9, HEIGHT = 8 };
    rheo_world_def def = melt_def(0.1);
    def.melting.substeps = 1;
    def.step = 0.002;
    played p = play(melting_box(def, WIDTH, HEIGHT, WIDTH), 1);
    double weight = 0, floor = 0, pressure = 0;
    static account a;
    for (uint32_t layer = 0; layer < HEIGHT; layer++) {
        double sum[3];
        look(&p, 1, "momentum", WIDTH / 2 + WIDTH * (layer + HEIGHT * (WIDTH / 2)), "velocity", &a);
        assert_true(sum_of(&a, RHEO_SOURCE_GRAVITY, ALL, NULL, sum));
        weight -= sum[1];
        sum_of(&a, RHEO_SOURCE_WALL, 0, NULL, sum);
        floor += sum[1];
        sum_of(&a, RHEO_SOURCE_PRESSURE, ALL, NULL, sum);
        pressure += sum[1];
    }
    print_message("weight of the column %.6g, floor %.6g, its neighbours %.2g\n", weight, floor, pressure);
    NEAR(weight, HEIGHT * 0.002, 1e-6);
    NEAR(floor, weight, 0.05 * weight);
    NEAR(pressure, 0, 0.01 * weight);
    stop(&p);
}

/* A density that is summed anew is the sum of the shares. */
static void shares_make_the_density(void **unused)
{
    (void)unused;
    rheo_world_def def = melt_def(0.1);
    set(&def, "melting.density", "summation");
    played p = some_substeps(def, 1);
    static account a;
    double shares[3], own[3], walls[3];
    look(&p, 1, "summation", 0, "density", &a);
    assert_true(sum_of(&a, RHEO_SOURCE_SHARE, ALL, NULL, shares));
    assert_true(sum_of(&a, RHEO_SOURCE_SHARE, 0, NULL, own));
    assert_true(sum_of(&a, RHEO_SOURCE_WALL, ALL, NULL, walls));
    NEAR(shares[0] + walls[0], a.after[0], 10 * ROUNDING);
    NEAR(own[0], 66 / (120 * PI), ROUNDING);
    stop(&p);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(recordings_are_exact),
        cmocka_unit_test(every_variant_is_exact),
        cmocka_unit_test(a_missing_addition_is_noticed),
        cmocka_unit_test(a_step_that_fails_is_exact),
        cmocka_unit_test(pairs_are_opposite),
        cmocka_unit_test(pairs_obey_their_equations),
        cmocka_unit_test(the_solver_leaves_little),
        cmocka_unit_test(a_floor_carries_the_weight),
        cmocka_unit_test(shares_make_the_density),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
