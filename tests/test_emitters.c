/*
 * Emitters: the volume that flows out, particles that have no room, limits, commands, failed steps, the past that emitted
 * particles are given, and recordings, from every step of which a run goes on to the same bits.
 */
#define PATH "test_emitters.rlog"

#include "recorded_runs.h"
#include "resume.h"

#include <math.h>

/* ---- Worlds ---- */

/* Neither gravity nor pressure: emitted particles move straight on. */
static rheo_world_def free_def(void)
{
    rheo_world_def def = rheo_default_world_def();
    def.gravity[1] = 0;
    def.fluid.stiffness = def.fluid.near_stiffness = 0;
    def.springs.stiffness = 0;
    return def;
}

/* A vertical jet of 9 particles a layer, 10 L/T. */
static rheo_emitter jet(void)
{
    rheo_emitter e = rheo_default_emitter("jet");
    e.position[1] = 20;
    e.radius = 3;
    e.speed = 10;
    return e;
}

static rheo_world *emitting(rheo_world_def def, rheo_emitter e)
{
    rheo_world *world;
    OK(rheo_world_def_add_emitter(&def, &e, &error));
    OK(rheo_world_create(&def, &world, &error));
    return world;
}

static rheo_emitter_state state_of(const rheo_world *world)
{
    rheo_emitter_state state;
    assert_true(rheo_world_emitter(world, 0, &state));
    assert_false(rheo_world_emitter(world, 1, &state));
    rheo_world_emitter(world, 0, &state);
    return state;
}

static void steps(rheo_world *world, int count)
{
    for (int i = 0; i < count; i++)
        OK(rheo_world_step(world, &error));
}

/* The next step becomes infinite: two particles approach each other too fast. */
static void make_bad(rheo_world *world)
{
    const rheo_real fast = sizeof(rheo_real) == 4 ? (rheo_real)3e38 : (rheo_real)1.5e308;
    OK(rheo_world_add_particles(world, 2, (rheo_real[]){90, 9, 9, 91, 9, 9}, (rheo_real[]){fast, 0, 0, -fast, 0, 0},
                                &error));
}

/* ---- Volume ---- */

/* Layers that left until the beginning of the last step: 1 + floor(speed time/spacing). */
static uint64_t layers_after(double speed, double spacing, double time)
{
    return 1 + (uint64_t)floor(speed * time / spacing);
}

static void the_rate_is_exact_for_any_step(void **unused)
{
    (void)unused;
    static const double lengths[] = {0.0331, 0.01, 0.007, 0.2501}, speeds[] = {10, 0.37, 15.9};
    for (size_t s = 0; s < 4; s++)
        for (size_t k = 0; k < 3; k++) {
            rheo_world_def def = free_def();
            rheo_emitter e = jet();
            def.step = lengths[s];
            e.speed = speeds[k];
            rheo_world *world = emitting(def, e);
            assert_int_equal(rheo_world_def_emitter_sites(rheo_world_definition(world), 0), 9);
            steps(world, 60);
            const double last = 59 * lengths[s];
            assert_int_equal(rheo_world_particle_count(world), 9 * layers_after(speeds[k], 2, last));
            assert_int_equal(state_of(world).emitted, rheo_world_particle_count(world));
            assert_int_equal(state_of(world).blocked, 0);
            /* Every layer is where one is that left in the middle of a step. */
            for (uint32_t id = 0; id < rheo_world_particle_count(world); id++) {
                const double y = 20 - speeds[k] * 60 * lengths[s] + 2 * (double)(id / 9);
                assert_true(fabs((double)rheo_world_positions(world)[3 * id + 1] - y) < 2e-3);
            }
            rheo_world_destroy(world);
        }
}

static void times_and_shapes_are_kept(void **unused)
{
    (void)unused;
    rheo_world_def def = free_def();
    rheo_emitter e = jet();
    def.step = 0.1;
    e.start = 0.25;
    e.end = 1.2;
    e.shape = RHEO_EMITTER_RECTANGLE;
    e.width = 6.1;
    e.height = 1.9;
    e.direction[0] = 3; /* and down */
    e.direction[1] = -4;
    rheo_world *world = emitting(def, e);
    steps(world, 3); /* up to 0.2 */
    assert_int_equal(rheo_world_particle_count(world), 0);
    steps(world, 1);
    assert_int_equal(rheo_world_particle_count(world), 3); /* 3 x 1 */
    /* The width is horizontal: along z. The layer left at 0.25, and the step ended at 0.4. */
    const rheo_real *x = rheo_world_positions(world), *v = rheo_world_velocities(world);
    for (int i = 0; i < 3; i++) {
        assert_true(fabs((double)x[3 * i] - 0.6 * 1.5) < 1e-5);
        assert_true(fabs((double)x[3 * i + 1] - (20 - 0.8 * 1.5)) < 1e-5);
        assert_true(fabs(fabs((double)x[3 * i + 2]) - 2 * abs(i - 1)) < 1e-5);
        assert_true(fabs((double)v[3 * i] - 6) < 1e-5 && fabs((double)v[3 * i + 1] + 8) < 1e-5);
    }
    steps(world, 30);
    assert_int_equal(rheo_world_particle_count(world), 3 * (1 + 4)); /* 0.95 T with 10 L/T: 9.5 L */
    rheo_world_destroy(world);
}

static void the_limit_is_the_last_particle(void **unused)
{
    (void)unused;
    rheo_emitter e = jet();
    e.limit = 31; /* 3 layers and 4 particles */
    rheo_world *world = emitting(free_def(), e);
    steps(world, 60);
    assert_int_equal(rheo_world_particle_count(world), 31);
    steps(world, 60);
    assert_int_equal(rheo_world_particle_count(world), 31);
    OK(rheo_world_set(world, "emitters.jet.limit", "100", &error));
    steps(world, 20);
    assert_true(rheo_world_particle_count(world) > 31);
    rheo_world_destroy(world);
}

static void particles_without_room_are_left_out(void **unused)
{
    (void)unused;
    rheo_world_def def = free_def();
    const rheo_real there[6] = {0, 20, 0, 2, 19.5, 0};
    def.particles.count = 2;
    def.particles.position = there;
    rheo_world *world = emitting(def, jet());
    steps(world, 1);
    assert_int_equal(rheo_world_particle_count(world), 2 + 7);
    assert_int_equal(state_of(world).blocked, 2);
    assert_int_equal(state_of(world).emitted, 7);
    rheo_world_destroy(world);
    /* Nor is there room in the ball. */
    def = free_def();
    def.ball.radius = 10;
    def.ball.position[1] = 20;
    world = emitting(def, jet());
    steps(world, 1);
    assert_int_equal(rheo_world_particle_count(world), 0);
    assert_int_equal(state_of(world).blocked, 9);
    rheo_world_destroy(world);
}

/* ---- Commands ---- */

static void a_command_switches_it_off_and_on(void **unused)
{
    (void)unused;
    rheo_world_def def = free_def();
    def.step = 0.1; /* half a spacing a step */
    rheo_world *world = emitting(def, jet());
    steps(world, 4); /* layers at 0 and 0.2 */
    assert_int_equal(rheo_world_particle_count(world), 18);
    OK(rheo_world_set(world, "emitters.jet.flow", "off", &error));
    steps(world, 10);
    assert_int_equal(rheo_world_particle_count(world), 18);
    OK(rheo_world_set(world, "emitters.1.flow", "on", &error));
    OK(rheo_world_set(world, "emitters.jet.position", "[50, 20, 0]", &error));
    steps(world, 2);
    assert_int_equal(rheo_world_particle_count(world), 27);
    assert_true((double)rheo_world_positions(world)[3 * 20] > 40);
    REFUSED(RHEO_ERROR_ARGUMENT, "there is no emitter \"jot\"; the emitters are: \"jet\"",
            rheo_world_set(world, "emitters.jot.flow", "on", &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "an emitter has no such parameter of its own; it has: shape, flow",
            rheo_world_set(world, "emitters.jet.colour", "1", &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "fixed when a world is made",
            rheo_world_set(world, "emitters.jet.material", "0", &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "it is one of: off on", rheo_world_set(world, "emitters.jet.flow", "1", &error));
    const uint64_t hash = rheo_world_hash(world);
    REFUSED(RHEO_ERROR_ARGUMENT, "supports in a step", rheo_world_set(world, "emitters.jet.speed", "41", &error));
    assert_true(rheo_world_hash(world) == hash);
    rheo_world_destroy(world);
}

/* ---- Failures ---- */

static void a_step_that_fails_takes_its_particles_back(void **unused)
{
    (void)unused;
    rheo_world_def def = rheo_default_world_def();
    def.history.window = 5;
    rheo_world *world = emitting(def, jet()), *other = emitting(def, jet());
    steps(world, 6);
    steps(other, 6);
    make_bad(world);
    make_bad(other);
    const uint32_t particles = rheo_world_particle_count(world);
    const uint64_t hash = rheo_world_hash(world), emitted = state_of(world).emitted;
    for (int i = 0; i < 3; i++) {
        assert_int_equal(rheo_world_step(world, &why), RHEO_ERROR_STATE);
        assert_int_equal(rheo_world_particle_count(world), particles);
        assert_int_equal(state_of(world).emitted, emitted);
        assert_true(rheo_world_hash(world) == hash);
    }
    rheo_world_destroy(world);
    rheo_world_destroy(other);
}

/* Memory for so many allocations; negative: without end. */
static int allocations;

static void *count_down(size_t bytes, void *user)
{
    (void)user;
    return allocations-- == 0 ? (allocations = 0, NULL) : malloc(bytes);
}

static void give_back(void *memory, void *user)
{
    (void)user;
    free(memory);
}

static void without_memory_nothing_is_emitted(void **unused)
{
    (void)unused;
    rheo_world_def def = rheo_default_world_def();
    def.allocator = (rheo_allocator){count_down, give_back, NULL};
    uint64_t expected = 0;
    int failures = 0;
    for (int most = -1; most < 60; most++) {
        allocations = -1;
        rheo_world *world = emitting(def, jet());
        steps(world, 7);
        const uint64_t hash = rheo_world_hash(world);
        allocations = most;
        const rheo_result result = rheo_world_step(world, &why); /* emits a layer */
        if (result != RHEO_OK) {
            assert_int_equal(result, RHEO_ERROR_MEMORY);
            assert_true(rheo_world_hash(world) == hash);
            failures++;
            allocations = -1;
            steps(world, 1);
        }
        allocations = -1;
        expected = most < 0 ? rheo_world_hash(world) : expected;
        assert_true(rheo_world_hash(world) == expected);
        rheo_world_destroy(world);
    }
    assert_true(failures > 3);
}

/* ---- The past ---- */

/* In a steady flow all particles have the same past, whatever the memory and however old they are. */
static void emitted_particles_have_moved_before(void **unused)
{
    (void)unused;
    static const rheo_history_kind kinds[] = {RHEO_HISTORY_WINDOW, RHEO_HISTORY_WINDOW_FAST, RHEO_HISTORY_FULL,
                                              RHEO_HISTORY_TEMPERED};
    for (size_t k = 0; k < 4; k++)
        for (uint32_t lag = 0; lag <= 3; lag += 3)
            for (uint32_t window = 5; window <= 40; window += 35) {
                rheo_world_def def = free_def();
                def.springs.stiffness = 15;
                def.history.kind = kinds[k];
                def.history.lag = lag;
                def.history.window = window;
                rheo_world *world = emitting(def, jet());
                for (int n = 0; n < 25; n++) {
                    steps(world, 1);
                    rheo_particle_state first, last;
                    const uint32_t count = rheo_world_particle_count(world);
                    OK(rheo_world_particle(world, 0, &first, &error));
                    OK(rheo_world_particle(world, count - 1, &last, &error));
                    const double d = fabs((double)first.derivative[1]);
                    if (fabs((double)first.derivative[1] - (double)last.derivative[1]) > 1e-4 * (1 + d))
                        fail_msg("kind %d, lag %u, window %u, step %d: D^q x is %g of the first, %g of the last",
                                 (int)kinds[k], lag, window, n, (double)first.derivative[1],
                                 (double)last.derivative[1]);
                    assert_true(n < 5 || d > 1);
                }
                rheo_world_destroy(world);
            }
}

/* ---- Recordings ---- */

static rheo_world *thick_jet(rheo_history_kind of_kind, rheo_history_of of, rheo_scheme of_scheme)
{
    rheo_world_def def = rheo_default_world_def();
    rheo_emitter e = jet(), second = rheo_default_emitter("second");
    def.history.kind = of_kind;
    def.history.of = of;
    def.history.window = 9;
    def.scheme = of_scheme;
    def.walls.plane = some_walls();
    def.walls.count = 1;
    walls_of(&def)[0] = (rheo_wall){{0, 0, 0}, {0, 1, 0}};
    e.position[1] = 7;
    second.position[0] = 12;
    second.position[1] = 5;
    second.shape = RHEO_EMITTER_RECTANGLE;
    second.width = second.height = 4;
    second.speed = 20;
    second.start = 0.1;
    second.limit = 30;
    if (of_scheme == RHEO_SCHEME_SUMMED) {
        rheo_material soft = rheo_default_material("soft");
        soft.springs.stiffness = 3;
        OK(rheo_world_def_add_material(&def, &soft, &error));
        second.material = 1;
    }
    OK(rheo_world_def_add_emitter(&def, &second, &error));
    return emitting(def, e);
}

static void runs_go_on_from_every_step(void **unused)
{
    (void)unused;
    for (int k = 0; k <= RHEO_HISTORY_TEMPERED; k++)
        resume_every_step(thick_jet((rheo_history_kind)k, RHEO_HISTORY_OF_VECTOR, RHEO_SCHEME_SUMMED), 16, PATH,
                          "history");
    resume_every_step(thick_jet(RHEO_HISTORY_WINDOW, RHEO_HISTORY_OF_LENGTH, RHEO_SCHEME_SUMMED), 16, PATH,
                      "lengths");
    resume_every_step(thick_jet(RHEO_HISTORY_WINDOW, RHEO_HISTORY_OF_VECTOR, RHEO_SCHEME_SEQUENTIAL), 16, PATH,
                      "sequential");
    resume_every_step(thick_jet(RHEO_HISTORY_WINDOW, RHEO_HISTORY_OF_VECTOR, RHEO_SCHEME_POSITIONS), 16, PATH,
                      "positions");
}

static rheo_world *hot_jet(void)
{
    rheo_world_def def = melt_def(0.25);
    fluid f = lattice(0.25, 3, 3, 3, 0);
    warm_by_height(&f, 0.75);
    rheo_emitter e = rheo_default_emitter("jet");
    e.position[1] = 2;
    e.radius = 0.3;
    e.speed = 3;
    e.temperature = 1.5;
    OK(rheo_world_def_add_emitter(&def, &e, &error));
    return melt_of(def, f);
}

static void melting_worlds_have_emitters(void **unused)
{
    (void)unused;
    rheo_world *world = hot_jet();
    rheo_particle_state state;
    const uint32_t before = rheo_world_particle_count(world);
    steps(world, 12);
    assert_true(rheo_world_particle_count(world) >= before + 10);
    OK(rheo_world_particle(world, before, &state, &error));
    assert_true(fabs((double)state.temperature - 1.5) < 0.2);
    rheo_world_destroy(world);
    resume_every_step(hot_jet(), 16, PATH, "hot");
}

/* Recorded with commands, verified, and continued wherever it was cut off. */
static void recordings_verify_and_are_continued(void **unused)
{
    (void)unused;
    rheo_recorder *recorder;
    rheo_verification v;
    const rheo_record_options options = {.scene = "jet", .keyframe_spacing = 4, .force = true};
    for (int cut = 20; cut >= 0; cut -= 4) {
        rheo_world *world = thick_jet(RHEO_HISTORY_WINDOW, RHEO_HISTORY_OF_VECTOR, RHEO_SCHEME_SUMMED);
        static uint64_t whole;
        remove(PATH);
        OK(rheo_recorder_open(world, PATH, &options, &recorder, &error));
        for (int n = 0; n < 20; n++) {
            if (n == cut) { /* interrupted, and begun again */
                OK(rheo_recorder_close(recorder, &error));
                rheo_world_destroy(world);
                world = thick_jet(RHEO_HISTORY_WINDOW, RHEO_HISTORY_OF_VECTOR, RHEO_SCHEME_SUMMED);
                OK(rheo_recorder_continue(&world, PATH, &options, &recorder, &error));
                assert_int_equal(rheo_world_step_count(world), n);
            }
            if (n == 9)
                OK(rheo_world_set(world, "emitters.jet.flow", "off", &error));
            if (n == 14)
                OK(rheo_world_set(world, "emitters.jet.flow", "on", &error));
            OK(rheo_recorder_step(recorder, &error));
        }
        OK(rheo_recorder_close(recorder, &error));
        whole = cut == 20 ? rheo_world_hash(world) : whole;
        assert_true(rheo_world_hash(world) == whole);
        rheo_world_destroy(world);
        OK(rheo_verify(PATH, &v, &error));
        assert_int_equal(v.verdict, RHEO_SAME);
        assert_int_equal(v.steps, 20);
    }
    remove(PATH);
}

/* The state before a failed step is recorded, and the failure is the same again. */
static void a_failure_is_recorded(void **unused)
{
    (void)unused;
    rheo_recorder *recorder;
    rheo_recording *recording;
    rheo_verification v;
    rheo_world *world = emitting(rheo_default_world_def(), jet());
    const rheo_record_options options = {.scene = "jet", .keyframe_spacing = 100, .force = true};
    OK(rheo_recorder_open(world, PATH, &options, &recorder, &error));
    for (int n = 0; n < 8; n++) {
        if (n == 7)
            make_bad(world);
        if (rheo_recorder_step(recorder, &why) != RHEO_OK)
            assert_int_equal(n, 7);
    }
    OK(rheo_recorder_close(recorder, &error));
    rheo_world_destroy(world);
    OK(rheo_verify(PATH, &v, &error));
    assert_int_equal(v.verdict, RHEO_SAME);
    OK(rheo_recording_open(PATH, &recording, &error));
    assert_int_equal(rheo_recording_get_info(recording).last_step, 7);
    rheo_recording_close(recording);
    remove(PATH);
}

/* A state that no emission leaves behind is refused; it could keep a step from ending. */
static void damaged_states_are_refused(void **unused)
{
    (void)unused;
    rheo_world *world = emitting(free_def(), jet());
    steps(world, 3);
    OK(rheo__world_check_state(world, true, &error));
    static const double bad[] = {-1e-9, -1e300, (double)INFINITY, (double)NAN};
    for (size_t i = 0; i < 4; i++) {
        const double way = world->state.emitter_way[7];
        world->state.emitter_way[7] = bad[i];
        assert_int_equal(rheo__world_check_state(world, true, &why), RHEO_ERROR_FORMAT);
        world->state.emitter_way[7] = way;
    }
    rheo_world_destroy(world);
}

/* Neither does a change of the step and the speed keep it from ending. */
static void any_settings_end_a_step(void **unused)
{
    (void)unused;
    rheo_world_def def = free_def();
    rheo_emitter e = jet();
    def.step = 1e5;
    e.speed = 1e-9;
    rheo_world *world = emitting(def, e);
    steps(world, 2);
    OK(rheo_world_set(world, "step", "1e-9", &error));
    OK(rheo_world_set(world, "emitters.jet.speed", "1e9", &error)); /* 1e14 supports since the last step */
    steps(world, 2);
    /* 1000 layers, of which the newest is where the first still is. */
    assert_int_equal(state_of(world).emitted, 9 * 1000);
    assert_int_equal(state_of(world).blocked, 9);
    rheo_world_destroy(world);
}

/* A world without emitters has no field of them. */
static void other_worlds_pay_nothing(void **unused)
{
    (void)unused;
    rheo_world *world = make_world(2);
    rheo_emitter_state state;
    assert_false(rheo_world_emitter(world, 0, &state));
    assert_false(world->features & RHEO__FEATURE_EMITTERS);
    assert_false(rheo__state_has(&world->state, RHEO__FIELD_emitter_time));
    assert_null(world->state.emitter_way);
    rheo_world_destroy(world);
}

/* ---- Bad input ---- */

static rheo_result check_with(rheo_emitter e, rheo_error *problem)
{
    rheo_world_def def = rheo_default_world_def();
    def.walls.plane = some_walls();
    def.walls.count = 1;
    walls_of(&def)[0] = (rheo_wall){{0, 0, 0}, {0, 2, 0}};
    if (rheo_world_def_add_emitter(&def, &e, problem) != RHEO_OK)
        return RHEO_ERROR_ARGUMENT;
    return rheo_world_def_check(&def, problem);
}

#define BAD(text, change)                                          \
    do {                                                           \
        rheo_emitter e = jet();                                    \
        OK(check_with(e, &error));                                 \
        change;                                                    \
        REFUSED(RHEO_ERROR_ARGUMENT, text, check_with(e, &error)); \
    } while (0)

static void bad_emitters_are_refused(void **unused)
{
    (void)unused;
    BAD("emitter 1 has the name \"\"; a name is a letter", e.name[0] = 0);
    BAD("emitter 1 has the name \"main\"", snprintf(e.name, sizeof e.name, "main"));
    BAD("emitters.jet.direction is [0, 0, 0]; it must be a finite vector other than zero", e.direction[1] = 0);
    BAD("emitters.1.speed is 0; it must be a number above 0", e.speed = 0);
    BAD("emitters.jet.speed is 130: that is 1.07 supports in a step", e.speed = 130);
    BAD("emitters.1.radius is -1", e.radius = -1);
    BAD("wider than 1000 spacings", e.radius = 2001);
    BAD("emitters.jet: a layer has 9 particles, more than its limit of 8", e.limit = 8);
    BAD("emitters.1.limit is 0", e.limit = 0);
    BAD("emitters.jet.end is 1, before its start at 2", (e.start = 2, e.end = 1));
    BAD("emitters.jet.material is 1; the last material is 0", e.material = 1);
    BAD("emitters.jet: its opening is behind wall 0, up to 5 deep", e.position[1] = -5);
    BAD("behind wall 0, up to 2.5 deep", (e.position[1] = 0.5, e.direction[0] = 1, e.direction[1] = 0));
    BAD("emitters.1.position has a component of", e.position[0] = (double)NAN);
    rheo_world_def def = rheo_default_world_def();
    const rheo_emitter e = jet();
    OK(rheo_world_def_add_emitter(&def, &e, &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "two emitters have the name \"jet\"", rheo_world_def_add_emitter(&def, &e, &error));
    def.emitters.count = RHEO_MAX_EMITTERS + 1;
    REFUSED(RHEO_ERROR_ARGUMENT, "there are 9 emitters; at most 8 are possible", rheo_world_def_check(&def, &error));
    def.emitters.count = 2;
    def.emitters.list[1] = def.emitters.list[0];
    def.emitters.list[1].name[0] = 'p';
    def.emitters.list[1].limit = 1u << 30;
    REFUSED(RHEO_ERROR_ARGUMENT, "are 1073751824 together; at most 2^30 are possible",
            rheo_world_def_check(&def, &error));
    rheo_world_def frozen = rheo_default_model_def(RHEO_MODEL_MELTING);
    rheo_emitter small_one = rheo_default_emitter("jet");
    frozen.melting.flow = RHEO_FLOW_FROZEN;
    OK(rheo_world_def_add_emitter(&frozen, &small_one, &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "nothing moves with melting.flow frozen", rheo_world_def_check(&frozen, &error));
}

/* ---- Scenes ---- */

static rheo_warning only_warning(const rheo_scene *scene)
{
    rheo_warning warning[4] = {{.kind = RHEO_WARNING_EMPTY}};
    size_t count;
    OK(rheo_scene_warnings(scene, warning, 4, &count, &error));
    if (count != 1)
        fail_msg("there are %zu warnings: %s", count, warning[0].text);
    return warning[0];
}

static rheo_scene scene_with(rheo_emitter e)
{
    rheo_scene scene = rheo_default_scene();
    const rheo_wall floor = {{0, 0, 0}, {0, 1, 0}};
    OK(rheo_scene_add_wall(&scene, &floor, &error));
    OK(rheo_world_def_add_emitter(&scene.world, &e, &error));
    return scene;
}

static void scenes_know_their_emitters(void **unused)
{
    (void)unused;
    rheo_memory without, with;
    size_t count;
    rheo_emitter e = jet();
    rheo_scene scene = scene_with(e);
    const rheo_fill block = {.kind = RHEO_FILL_BLOCK, .max = {8, 4, 8}};
    OK(rheo_scene_warnings(&scene, NULL, 0, &count, &error));
    assert_int_equal(count, 0); /* not even that there are no shapes */
    OK(rheo_scene_add_fill(&scene, &block, &error));
    OK(rheo_scene_memory(&scene, 0, &without, &error));
    OK(rheo_scene_memory(&scene, 100, &with, &error));
    assert_int_equal(without.emitted, 0);
    assert_int_equal(with.emitted, 9 * layers_after(10, 2, 99 * 0.033));
    assert_true(with.all > 2 * without.all);
    OK(rheo_scene_memory(&scene, 10000000, &with, &error));
    assert_int_equal(with.emitted, 10000);
    scene.resolution = 2; /* the same volume */
    OK(rheo_scene_memory(&scene, 10000000, &with, &error));
    assert_int_equal(with.emitted, 80000);
    rheo_scene_release(&scene);

    e.position[1] = 3; /* into the floor */
    scene = scene_with(e);
    rheo_warning warning = only_warning(&scene);
    assert_int_equal(warning.kind, RHEO_WARNING_EMITTER);
    assert_int_equal(warning.wall, 0);
    assert_true(says(warning.text, "emitter jet flows into wall 0, 3 in front of it"));
    rheo_scene_release(&scene);

    e.position[1] = 20;
    e.speed = 110;
    scene = scene_with(e);
    warning = only_warning(&scene);
    assert_int_equal(warning.kind, RHEO_WARNING_SPEED);
    assert_true(says(warning.text, "the fluid of emitter jet moves by"));
    rheo_scene_release(&scene);

    e = jet(); /* in the fluid */
    e.position[0] = e.position[2] = 9;
    e.position[1] = 7;
    scene = scene_with(e);
    const rheo_fill around = {.kind = RHEO_FILL_BLOCK, .max = {18, 8, 18}};
    OK(rheo_scene_add_fill(&scene, &around, &error));
    warning = only_warning(&scene);
    assert_int_equal(warning.kind, RHEO_WARNING_EMITTER);
    assert_true(says(warning.text, "9 of the 9 particles of its first layer have no room"));
    /* While the fluid settles, nothing flows. */
    scene.settle.time = 0.3;
    rheo_world *world;
    OK(rheo_scene_create_world(&scene, &world, &error));
    assert_int_equal(rheo_world_particle_count(world), 9 * 9 * 4);
    rheo_world_destroy(world);
    rheo_scene_release(&scene);
}

/* Every SIMD variant has the bits of the scalar one. */
static void all_variants_compute_the_same_bits(void **unused)
{
    (void)unused;
    const char *best = rheo_simd(), *variant;
    uint64_t expected = 0;
    for (uint32_t i = 0; (variant = rheo_simd_available(i)); i++) {
        OK(rheo_use_simd(variant, &error));
        rheo_world *world = thick_jet(RHEO_HISTORY_TEMPERED, RHEO_HISTORY_OF_VECTOR, RHEO_SCHEME_SUMMED);
        steps(world, 20);
        expected = i ? expected : rheo_world_hash(world);
        assert_true(rheo_world_hash(world) == expected);
        rheo_world_destroy(world);
    }
    OK(rheo_use_simd(best, &error));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_rate_is_exact_for_any_step),
        cmocka_unit_test(times_and_shapes_are_kept),
        cmocka_unit_test(the_limit_is_the_last_particle),
        cmocka_unit_test(particles_without_room_are_left_out),
        cmocka_unit_test(a_command_switches_it_off_and_on),
        cmocka_unit_test(a_step_that_fails_takes_its_particles_back),
        cmocka_unit_test(without_memory_nothing_is_emitted),
        cmocka_unit_test(emitted_particles_have_moved_before),
        cmocka_unit_test(runs_go_on_from_every_step),
        cmocka_unit_test(melting_worlds_have_emitters),
        cmocka_unit_test(recordings_verify_and_are_continued),
        cmocka_unit_test(a_failure_is_recorded),
        cmocka_unit_test(damaged_states_are_refused),
        cmocka_unit_test(any_settings_end_a_step),
        cmocka_unit_test(other_worlds_pay_nothing),
        cmocka_unit_test(bad_emitters_are_refused),
        cmocka_unit_test(scenes_know_their_emitters),
        cmocka_unit_test(all_variants_compute_the_same_bits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
