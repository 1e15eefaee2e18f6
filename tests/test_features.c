/*
 * A world has only the stages, fields and bytes of the parts that its scene has. Parts are added to a bare scene one by
 * one; every parameter of an absent part is changed, and must leave stages, fields, bytes and results as they are.
 */
#include "support.h"

#include <math.h>

/* ---- Memory ---- */

/* The bytes that a world holds, and its blocks. */
typedef struct counter {
    size_t bytes, blocks;
} counter;

enum { HEAD = 64 }; /* keeps blocks aligned as malloc() does */

static void *count_up(size_t bytes, void *user)
{
    counter *c = user;
    char *block = malloc(bytes + HEAD);
    if (!block)
        return NULL;
    memcpy(block, &bytes, sizeof bytes);
    c->bytes += bytes;
    c->blocks++;
    return block + HEAD;
}

static void count_down(void *memory, void *user)
{
    counter *c = user;
    if (!memory)
        return;
    char *block = (char *)memory - HEAD;
    size_t bytes;
    memcpy(&bytes, block, sizeof bytes);
    c->bytes -= bytes;
    c->blocks--;
    free(block);
}

/* ---- Scenes ---- */

enum { SIDE = 6, LAYERS = 8, PARTICLES = SIDE * SIDE * LAYERS, MOST = 4000, STEPS = 9 };

/* Particles on a lattice, not quite regular. */
static void place(rheo_world_def *def, uint32_t count, double apart)
{
    static rheo_real position[3 * MOST];
    assert_true(count <= MOST);
    for (uint32_t i = 0; i < count; i++) {
        position[3 * i] = (rheo_real)(apart * (i % SIDE + .5 + .02 * (i % 3)));
        position[3 * i + 1] = (rheo_real)(apart * (i / SIDE % LAYERS + .5 + .02 * (i % 5)));
        position[3 * i + 2] = (rheo_real)(apart * (i / (SIDE * LAYERS) + .5));
    }
    def->particles.count = count;
    def->particles.position = position;
}

/* Pressure and viscosity alone; of the melting model pressure alone. Without gravity. */
static rheo_world_def bare(rheo_model model)
{
    rheo_world_def def = rheo_default_model_def(model);
    memset(def.gravity, 0, sizeof def.gravity);
    if (model == RHEO_MODEL_THICKENING) {
        def.springs.stiffness = def.history.stiffness = 0;
        def.history.window = 4;
    } else {
        def.melting.viscosity = 0;
        def.fluid.spacing = 2;
        def.step = .1;
    }
    place(&def, PARTICLES, 2);
    return def;
}

/* What a string of parameters cannot set. */
typedef enum extra { NONE, WALLS, VIBRATORS, MATERIAL, CURVE, WARM } extra;

static void add_extra(rheo_world_def *def, extra what)
{
    static const rheo_wall floor = {{0, 0, 0}, {0, 1, 0}};
    static const double vibrator[1][2] = {{6, 6}};
    static const rheo_curve_point curve[] = {{.01, 5}, {.1, 1}, {.132, 0}};
    static rheo_real temperature[PARTICLES];
    rheo_material stiff = rheo_default_material("stiff");
    stiff.history.stiffness = 1000;
    if (what == WALLS) {
        def->walls.plane = &floor;
        def->walls.count = 1;
    } else if (what == VIBRATORS) {
        def->vibrators.position = vibrator;
        def->vibrators.count = 1;
    } else if (what == MATERIAL) {
        OK(rheo_world_def_add_material(def, &stiff, &error));
    } else if (what == CURVE) {
        def->history.curve = curve;
        def->history.curve_count = sizeof curve / sizeof *curve;
    } else if (what == WARM) {
        for (int i = 0; i < PARTICLES; i++)
            temperature[i] = (rheo_real)(i % 7);
        def->particles.temperature = temperature;
    }
}

/* ---- What a world has ---- */

enum { NAMES = 600, PLACES = 48 };

typedef struct content {
    char stages[NAMES];
    uint32_t fields;
    rheo_field_info field[PLACES];
    counter created, stepped; /* memory after creation, and after some steps */
    uint64_t hash;
} content;

static void take_names(content *c, const rheo_world *world)
{
    rheo_stage_info stage;
    for (uint32_t i = 0; rheo_world_stage(world, i, &stage) == RHEO_OK; i++)
        snprintf(c->stages + strlen(c->stages), NAMES - strlen(c->stages), "%s%s", i ? " " : "", stage.name);
    c->fields = rheo_world_field_count(world);
    assert_true(strlen(c->stages) + 1 < NAMES && c->fields <= PLACES);
    for (uint32_t i = 0; i < c->fields; i++)
        OK(rheo_world_field(world, i, &c->field[i]));
}

/* False: the definition is refused. */
static bool look_at(rheo_world_def def, content *c)
{
    counter memory = {0, 0};
    rheo_world *world;
    rheo_error error = {""};
    *c = (content){.stages = ""};
    def.allocator = (rheo_allocator){count_up, count_down, &memory};
    if (rheo_world_create(&def, &world, &error) != RHEO_OK)
        return false;
    c->created = memory;
    step(world, STEPS);
    c->stepped = memory;
    c->hash = rheo_world_hash(world);
    take_names(c, world);
    rheo_world_destroy(world);
    assert_int_equal(memory.bytes, 0);
    return true;
}

/* Whether a list of words with blanks between has a word. */
static bool lists(const char *list, const char *word)
{
    const size_t length = strlen(word);
    for (const char *at = list; (at = strstr(at, word)) != NULL; at += length)
        if ((at == list || at[-1] == ' ') && (at[length] == ' ' || at[length] == 0))
            return true;
    return false;
}

static const rheo_field_info *find(const content *c, const char *name)
{
    for (uint32_t i = 0; i < c->fields; i++)
        if (strcmp(c->field[i].name, name) == 0)
            return &c->field[i];
    return NULL;
}

static void append(char *text, const char *sign, const char *name)
{
    snprintf(text + strlen(text), NAMES - strlen(text), "%s%s%s", *text ? " " : "", sign, name);
}

static void append_stages(char *text, const char *sign, const content *c, const content *other)
{
    char copy[NAMES], *word = copy;
    snprintf(copy, sizeof copy, "%s", c->stages);
    while (word) {
        char *end = strchr(word, ' ');
        if (end)
            *end = 0;
        if (!lists(other->stages, word))
            append(text, sign, word);
        word = end ? end + 1 : NULL;
    }
}

/* Names of the stages and fields that `with` has and `base` lacks with +, and the other way round with -. */
static void changes(const content *with, const content *base, char stages[NAMES], char fields[NAMES])
{
    stages[0] = fields[0] = 0;
    append_stages(stages, "+", with, base);
    append_stages(stages, "-", base, with);
    for (uint32_t i = 0; i < with->fields; i++)
        if (!find(base, with->field[i].name))
            append(fields, "+", with->field[i].name);
    for (uint32_t i = 0; i < base->fields; i++)
        if (!find(with, base->field[i].name))
            append(fields, "-", base->field[i].name);
}

/* ---- Parts ---- */

#define BALL_FIELDS "+ball_position +ball_velocity +ball_spin +ball_orientation"
#define PLATE_FIELDS "+start_position +plate +plate_displacement +plate_velocity +plate_phase"
#define VIBRATOR_FIELDS "+vibrator_position +vibrator_phase +vibrator_frequency +random"

/* A part, the part that it is added to, and what it adds. reals, bytes: of state per particle. */
static const struct part {
    const char *name, *base, *set[3]; /* KEY, VALUE */
    extra what;
    const char *stages, *fields;
    double reals, bytes;
} PARTS[] = {
    {"fluid", NULL, {NULL}, NONE, "", "", 0, 0},
    {"walls", "fluid", {NULL}, WALLS, "+walls", "", 0, 0},
    {"springs", "fluid", {"springs.stiffness", "15"}, NONE, "", "+spring_ends +spring_rest_length", 0, 0},
    {"history",
     "springs",
     {"history.stiffness", "150"},
     NONE,
     "+fractional_derivative +history",
     "+history_rows +history_velocity +derivative",
     3 + 3 * 5,
     0},
    {"lag", "history", {"history.lag", "3"}, NONE, "", "", 3 * 3, 0},
    {"curve", "history", {NULL}, CURVE, "", "", 0, 0},
    {"window-fast", "history", {"history.kind", "window-fast"}, NONE, "", "+history_modes", 0, 0},
    {"full", "history", {"history.kind", "full"}, NONE, "", "+history_modes -history_velocity", -15, 0},
    {"of length",
     "history",
     {"history.of", "length"},
     NONE,
     "",
     "+history_position -history_velocity -derivative",
     0,
     0},
    {"passive", "history", {"history.hardening", "passive"}, NONE, "", "", 0, 0},
    {"materials", "history", {NULL}, MATERIAL, "", "+material", 0, 4},
    {"substeps", "springs", {"substeps", "4"}, NONE, "", "", 0, 0},
    {"sticking", "history", {NULL}, WALLS, "+walls", "", 0, 0},
    {"ball", "fluid", {"ball.radius", "3"}, NONE, "+ball_motion +ball", BALL_FIELDS, 0, 0},
    {"push", "ball", {"ball.push", "[0, -1, 0]"}, NONE, "+ball_push", "+ball_push_phase", 0, 0},
    {"vibrators", "walls", {NULL}, VIBRATORS, "+vibrators", VIBRATOR_FIELDS, 0, 0},
    {"period", "fluid", {"space.period", "[12, 0, 12]"}, NONE, "", "", 0, 0},
    {"lower plate", "period", {"plates.upper", "12"}, NONE, "+plates", PLATE_FIELDS, 3, 4},
    {"plates", "lower plate", {"plates.lower", "4"}, NONE, "", "", 0, 0},
    {"plates by stress", "plates", {"plates.control", "stress"}, NONE, "", "", 0, 0},
    {"sequential",
     "fluid",
     {"scheme", "sequential"},
     NONE,
     "+neighbours_start +density +velocity -substeps -densities -forces",
     "-substeps -list_position -list_margin",
     -4,
     0},
    {"sequential springs",
     "sequential",
     {"springs.stiffness", "15"},
     NONE,
     "+springs +spring_displacement",
     "+spring_ends +spring_rest_length",
     0,
     0},
    {"positions",
     "fluid",
     {"scheme", "positions"},
     NONE,
     "+density_constraint -substeps -densities -forces",
     "-substeps",
     0,
     0},
    {"unit of stiffness", "positions", {"springs.stiffness", "15"}, NONE, "", "", 0, 0},
    {"positions history",
     "unit of stiffness",
     {"history.stiffness", "150"},
     NONE,
     "+fractional_derivative +multiplier +history",
     "+history_rows +history_velocity +derivative",
     3 + 3 * 5,
     0},
    {"melting", NULL, {NULL}, NONE, "", "", 0, 0},
    {"melting walls", "melting", {NULL}, WALLS, "+walls", "", 0, 0},
    {"melting viscosity",
     "melting",
     {"melting.viscosity", "0.05"},
     NONE,
     "+viscosity",
     "+predicted_acceleration",
     3,
     0},
    {"nested", "melting viscosity", {"melting.stress", "nested"}, NONE, "", "", 0, 0},
    {"explicit", "melting viscosity", {"melting.solver", "explicit"}, NONE, "", "", 0, 0},
    {"no heat", "melting", {"melting.diffusivity", "0"}, NONE, "", "", 0, 0},
    {"warm", "no heat", {NULL}, WARM, "", "+temperature", 1, 0},
    {"heat", "warm", {"melting.diffusivity", "0.1"}, NONE, "", "", 0, 0},
    {"frozen", "heat", {"melting.flow", "frozen"}, NONE, "+gradients -momentum", "", 0, 0},
    {"summation", "melting", {"melting.density", "summation"}, NONE, "+summation", "", 0, 0},
    {"leapfrog", "heat", {"paper.leapfrog", "on"}, NONE, "+gradients", "", 0, 0},
};
enum { COUNT = sizeof PARTS / sizeof *PARTS };

static const struct part *part(const char *name)
{
    for (size_t i = 0; i < COUNT; i++)
        if (strcmp(PARTS[i].name, name) == 0)
            return &PARTS[i];
    fail_msg("there is no part %s", name);
    return NULL;
}

/* The scene that has a part, and those it is added to. */
static rheo_world_def with(const struct part *p)
{
    if (!p->base)
        return bare(strcmp(p->name, "melting") == 0 ? RHEO_MODEL_MELTING : RHEO_MODEL_THICKENING);
    rheo_world_def def = with(part(p->base));
    if (p->set[0])
        OK(rheo_world_def_set(&def, p->set[0], p->set[1], &error));
    add_extra(&def, p->what);
    return def;
}

/* Bytes per particle of the fields that have values for particles. The number of modes is that of the fit. */
static double particle_bytes(const content *c)
{
    double bytes = 0;
    for (uint32_t i = 0; i < c->fields; i++)
        if (c->field[i].location == RHEO_LOCATION_PARTICLE && strcmp(c->field[i].name, "history_modes") != 0)
            bytes += (double)c->field[i].bytes / PARTICLES;
    return bytes;
}

static void parts_add_their_stages_fields_and_bytes(void **unused)
{
    (void)unused;
    for (size_t i = 0; i < COUNT; i++) {
        const struct part *p = &PARTS[i];
        content own, base;
        char stages[NAMES], fields[NAMES];
        if (!p->base)
            continue;
        assert_true(look_at(with(p), &own) && look_at(with(part(p->base)), &base));
        changes(&own, &base, stages, fields);
        if (strcmp(stages, p->stages) != 0 || strcmp(fields, p->fields) != 0)
            fail_msg("%s: stages \"%s\", not \"%s\"; fields \"%s\", not \"%s\"", p->name, stages, p->stages, fields,
                     p->fields);
        const double more = particle_bytes(&own) - particle_bytes(&base),
                     expected = p->reals * (double)sizeof(rheo_real) + p->bytes;
        if (fabs(more - expected) > 1e-9)
            fail_msg("%s: %g bytes of state more per particle, not %g", p->name, more, expected);
        /* A base that had the memory of the part already would not grow by it. */
        if (!strchr(stages, '-') && !strchr(fields, '-') &&
            own.created.bytes < base.created.bytes + (size_t)(PARTICLES * expected))
            fail_msg("%s: memory of %zu bytes, of the base %zu", p->name, own.created.bytes, base.created.bytes);
    }
}

/* ---- Absent parts ---- */

/* Parameters of the bare scenes; all others are of parts that they lack. */
static bool is_used(const rheo_parameter *p, rheo_model model)
{
    static const char *const used[][24] = {
        {"model", "step", "gravity", "scheme", "substeps", "max_substeps", "fluid.spacing", "fluid.support",
         "fluid.stiffness", "fluid.near_stiffness", "fluid.rest_density", "fluid.cohesion", "fluid.linear_viscosity",
         "fluid.quadratic_viscosity", "springs.stiffness", "ball.radius", "space.period", "plates.lower",
         "plates.upper"},
        {"model",
         "step",
         "gravity",
         "fluid.spacing",
         "melting.smoothing_length",
         "melting.rest_density",
         "melting.sound_speed",
         "melting.viscosity",
         "melting.temperature_min",
         "melting.alpha",
         "melting.beta",
         "melting.xsph",
         "melting.repulsion",
         "melting.courant_number",
         "melting.substeps",
         "melting.max_substeps",
         "melting.density",
         "melting.flow",
         "paper.kernel",
         "paper.artificial_viscosity",
         "paper.courant",
         "paper.xsph",
         "paper.leapfrog"}};
    for (size_t i = 0; i < sizeof used[0] / sizeof *used[0] && used[model][i]; i++)
        if (strcmp(used[model][i], p->path) == 0)
            return true;
    return p->scene_only || !(p->models & UINT32_C(1) << model);
}

/* Writes the k-th other value of a parameter. False: there is none. */
static bool other_value(const rheo_world_def *def, const rheo_parameter *p, uint32_t k, char value[96])
{
    OK(rheo_world_def_get(def, p->path, value, 96));
    if (p->type == RHEO_PARAMETER_CHOICE) {
        if (k >= p->choice_count)
            return false;
        snprintf(value, 96, "%s", p->choices[k]);
    } else if (p->type == RHEO_PARAMETER_VECTOR) {
        snprintf(value, 96, "[3, 2, 1]");
    } else {
        const char *end;
        const double now = rheo_text_number(value, &end), other = now > 0 ? 1.2 * now : 1;
        rheo_number_text(p->type == RHEO_PARAMETER_REAL ? other : floor(other + 1), value);
    }
    return k == 0 || p->type == RHEO_PARAMETER_CHOICE;
}

static void parameters_of_absent_parts_change_nothing(void **unused)
{
    (void)unused;
    for (int model = RHEO_MODEL_THICKENING; model <= RHEO_MODEL_MELTING; model++) {
        const rheo_world_def def = bare((rheo_model)model);
        content own, base;
        int changed = 0;
        assert_true(look_at(def, &base));
        for (size_t i = 0; i < rheo_parameter_count(); i++) {
            const rheo_parameter *p = rheo_parameter_at(i);
            char value[96], stages[NAMES], fields[NAMES];
            for (uint32_t k = 0; !is_used(p, (rheo_model)model) && other_value(&def, p, k, value); k++) {
                rheo_world_def one = def;
                OK(rheo_world_def_set(&one, p->path, value, &error));
                assert_true(look_at(one, &own));
                changes(&own, &base, stages, fields);
                if (*stages || *fields || own.created.bytes != base.created.bytes ||
                    own.stepped.bytes != base.stepped.bytes || own.stepped.blocks != base.stepped.blocks ||
                    own.hash != base.hash)
                    fail_msg("%s %s: stages \"%s\", fields \"%s\", %zu and %zu bytes, not %zu and %zu%s", p->path,
                             value, stages, fields, own.created.bytes, own.stepped.bytes, base.created.bytes,
                             base.stepped.bytes, own.hash == base.hash ? "" : ", another state");
                changed++;
            }
        }
        assert_true(changed > 10);
    }
}

/* A part stays absent if its parameters are set later, as far as they can be set. */
static void parameters_that_are_set_later_add_no_part(void **unused)
{
    (void)unused;
    static const char *const scenes[] = {"fluid",   "springs", "sequential", "positions",
                                         "melting", "no heat", "frozen"};
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++) {
        const rheo_world_def def = with(part(scenes[i]));
        rheo_world *world;
        int changed = 0;
        OK(rheo_world_create(&def, &world, &error));
        content before = {.stages = ""}, after = {.stages = ""};
        take_names(&before, world);
        for (size_t n = 0; n < rheo_parameter_count(); n++) {
            const rheo_parameter *p = rheo_parameter_at(n);
            char value[96], own[96];
            if (!p->live || p->scene_only || !(p->models & UINT32_C(1) << def.model) || strcmp(p->path, "step") == 0)
                continue;
            OK(rheo_world_def_get(&def, p->path, own, sizeof own));
            for (uint32_t k = 0; other_value(&def, p, k, value); k++)
                if (rheo_world_set(world, p->path, value, NULL) == RHEO_OK) {
                    const rheo_result result = rheo_world_step(world, NULL);
                    assert_true(result == RHEO_OK || result == RHEO_ERROR_STATE);
                    changed++;
                }
            (void)rheo_world_set(world, p->path, own, NULL); /* refused if the world was made without the part */
        }
        assert_true(changed > 15);
        take_names(&after, world);
        assert_string_equal(after.stages, before.stages);
        assert_int_equal(after.fields, before.fields);
        rheo_world_destroy(world);
    }
}

/* Memory per particle of a scene whose particles have no neighbours, after some steps: its arrays, and their copies that undo a
 * step. */
static double bytes_per_particle(rheo_world_def def)
{
    enum { FEW = 20 * SIDE * LAYERS, MANY = 80 * SIDE * LAYERS };
    content few, many;
    place(&def, FEW, 100);
    assert_true(look_at(def, &few));
    place(&def, MANY, 100);
    assert_true(look_at(def, &many));
    return (double)(many.stepped.bytes - few.stepped.bytes) / (MANY - FEW);
}

/* An array for a part that the scene lacks would show here: the bytes are those that the parts of these scenes take. */
static void bare_scenes_have_no_arrays_of_parts(void **unused)
{
    (void)unused;
    static const struct {
        const char *part;
        double bytes; /* in float */
    } scenes[] = {{"fluid", 236}, {"sequential", 197}, {"positions", 236}, {"melting", 333}, {"frozen", 180}};
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++) {
        rheo_world_def def = with(part(scenes[i].part));
        def.particles.temperature = NULL;
        const double most = scenes[i].bytes * (double)sizeof(rheo_real) / 4, found = bytes_per_particle(def);
        if (!(found > most / 4 && found < most + 1))
            fail_msg("%s: %g bytes per particle, not %g", scenes[i].part, found, most);
    }
}

/* A recorder adds less than a byte per particle to the memory of its world. */
static void recorders_add_nothing(void **unused)
{
    (void)unused;
    content base;
    counter memory = {0, 0};
    rheo_world_def def = bare(RHEO_MODEL_THICKENING);
    assert_true(look_at(def, &base));
    def.allocator = (rheo_allocator){count_up, count_down, &memory};
    rheo_world *world;
    rheo_recorder *recorder;
    content own = {.stages = ""};
    OK(rheo_world_create(&def, &world, &error));
    OK(rheo_recorder_open_memory(world, NULL, &recorder, &error));
    for (int i = 0; i < STEPS; i++)
        OK(rheo_recorder_step(recorder, &error));
    OK(rheo_recorder_close(recorder, &error));
    take_names(&own, world);
    assert_string_equal(own.stages, base.stages);
    assert_int_equal(own.fields, base.fields);
    assert_true(memory.bytes < base.stepped.bytes + PARTICLES && rheo_world_hash(world) == base.hash);
    rheo_world_destroy(world);
    assert_int_equal(memory.bytes, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(parts_add_their_stages_fields_and_bytes),
        cmocka_unit_test(parameters_of_absent_parts_change_nothing),
        cmocka_unit_test(parameters_that_are_set_later_add_no_part),
        cmocka_unit_test(bare_scenes_have_no_arrays_of_parts),
        cmocka_unit_test(recorders_add_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
