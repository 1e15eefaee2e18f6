/*
 * The table of parameters: one line for every number of a definition. --set, scene files, recordings, commands and
 * validation are loops over it.
 */
#include "world/world.h"

#include <stdio.h>
#include <string.h>

#include "core/text.h"

enum {
    NONE = 0,
    ABOVE = 1,
    BELOW = 2,
    LIVE = 4,
    THICK = 8, /* of this model alone */
    MELT = 16
};

#define LARGE 1e30
#define SMALL 1e-12              /* a float and its square are still far from 0 */
#define WHOLE 9007199254740991.0 /* 2^53 - 1 */

/* path, member, type, unit, minimum, maximum, flags, choices, about */
#define PARAMETERS(X)                                                                                               \
    X("model", model, CHOICE, "", 0, 1, NONE, "thickening melting", "what the fluid is made of")                    \
    X("step", step, REAL, "T", SMALL, 1e6, LIVE, NULL, "fixed time step")                                           \
    X("gravity", gravity, VECTOR, "L/T^2", -LARGE, LARGE, LIVE, NULL, "acceleration of gravity; y is up")           \
    X("fluid.support", fluid.support, REAL, "L", SMALL, 1e12, LIVE | THICK, NULL,                                   \
      "radius h within which particles are neighbours")                                                             \
    X("fluid.spacing", fluid.spacing, REAL, "L", SMALL, 1e12, LIVE, NULL,                                           \
      "distance of particles at rest; of thickening half of it is a wall's reach")                                  \
    X("fluid.stiffness", fluid.stiffness, REAL, "L/T^2", 0, LARGE, LIVE | THICK, NULL,                              \
      "k of the pressure k (rho - rho0)")                                                                           \
    X("fluid.near_stiffness", fluid.near_stiffness, REAL, "L/T^2", 0, LARGE, LIVE | THICK, NULL,                    \
      "k_near of the near pressure")                                                                                \
    X("fluid.rest_density", fluid.rest_density, REAL, "1", 0, LARGE, LIVE | THICK, NULL,                            \
      "rho0, sum of (1 - r/h)^2 over neighbours at rest")                                                           \
    X("fluid.linear_viscosity", fluid.linear_viscosity, REAL, "1/T", 0, LARGE, LIVE | THICK, NULL,                  \
      "sigma of the viscosity impulse")                                                                             \
    X("fluid.quadratic_viscosity", fluid.quadratic_viscosity, REAL, "1/L", 0, LARGE, LIVE | THICK, NULL,            \
      "beta of the viscosity impulse")                                                                              \
    X("fluid.number_density", fluid.number_density, REAL, "1/L^3", 0, LARGE, LIVE | THICK, NULL,                    \
      "particles per volume for the ball's mass; 0: 1/spacing^3, or as settled")                                    \
    X("springs.stiffness", springs.stiffness, REAL, "1/T^2", 0, LARGE, LIVE | THICK, NULL,                          \
      "k_min; 0 at the start: a fluid without springs and so without history")                                      \
    X("springs.plasticity", springs.plasticity, REAL, "1/T", 0, LARGE, LIVE | THICK, NULL,                          \
      "alpha, rate at which rest lengths flow")                                                                     \
    X("springs.yield_ratio", springs.yield_ratio, REAL, "1", 0, LARGE, LIVE | THICK, NULL,                          \
      "gamma, strain below which rest lengths do not flow")                                                         \
    X("springs.rest_length", springs.rest_length, CHOICE, "", 0, 1, LIVE | THICK, "distance support",               \
      "rest length of a new spring: the distance of its ends, or the support")                                      \
    X("springs.solver", springs.solver, CHOICE, "", 0, 1, LIVE | THICK, "explicit implicit",                        \
      "displacement by kappa (the paper's) or by kappa/(1 + kappa)")                                                \
    X("history.kind", history.kind, CHOICE, "", 0, 3, THICK, "window window-fast full tempered",                    \
      "memory: exact window, one of exponentials, whole history, fading window")                                    \
    X("history.stiffness", history.stiffness, REAL, "T^(q-2)/L", 0, LARGE, LIVE | THICK, NULL,                      \
      "k_hist; 0 at the start: a fluid without history")                                                            \
    X("history.order", history.order, REAL, "1", 0, 1, ABOVE | BELOW | LIVE | THICK, NULL,                          \
      "q, order of the fractional derivative")                                                                      \
    X("history.window", history.window, WINDOW, "steps", 1, 1000000, THICK, NULL,                                   \
      "d, how far back velocities count (not of kind full): steps, or seconds as \"2.5 s\"")                        \
    X("history.weights", history.weights, CHOICE, "", 0, 1, LIVE | THICK, "paper l1",                               \
      "weights of the fractional derivative: the paper's or those of the L1 scheme")                                \
    X("walls.sticking", walls.sticking, REAL, "1", 0, LARGE, LIVE | THICK, NULL,                                    \
      "c_b, how strongly stiff fluid sticks to walls")                                                              \
    X("ball.radius", ball.radius, REAL, "L", 0, 1e12, THICK, NULL, "R; 0: no ball")                                 \
    X("ball.density_ratio", ball.density_ratio, REAL, "1", 1e-6, LARGE, LIVE | THICK, NULL,                         \
      "density of the ball against the fluid's")                                                                    \
    X("ball.position", ball.position, VECTOR, "L", -LARGE, LARGE, LIVE | THICK, NULL, "centre at the start")        \
    X("ball.velocity", ball.velocity, VECTOR, "L/T", -LARGE, LARGE, LIVE | THICK, NULL, "velocity at the start")    \
    X("ball.spin", ball.spin, VECTOR, "1/T", -LARGE, LARGE, LIVE | THICK, NULL, "angular velocity at the start")    \
    X("ball.friction", ball.friction, REAL, "1", 0, 1, LIVE | THICK, NULL,                                          \
      "mu, share of the sliding that a contact stops")                                                              \
    X("vibrators.kind", vibrators.kind, CHOICE, "", 0, 1, THICK, "floor force",                                     \
      "vibrators raise the floor, or push what is below vibrators.height")                                          \
    X("vibrators.amplitude", vibrators.amplitude, REAL, "L", 0, 1e12, LIVE | THICK, NULL,                           \
      "a, amplitude of a vibrator")                                                                                 \
    X("vibrators.frequency", vibrators.frequency, REAL, "1/T", SMALL, 1e12, LIVE | THICK, NULL, "f0")               \
    X("vibrators.spread", vibrators.spread, REAL, "1", 0, 1, LIVE | THICK, NULL,                                    \
      "each frequency walks at random inside f0 (1 +- spread)")                                                     \
    X("vibrators.wander", vibrators.wander, REAL, "1", 0, 1, LIVE | THICK, NULL,                                    \
      "largest change of a frequency in a step, as a part of f0")                                                   \
    X("vibrators.radius", vibrators.radius, REAL, "L", SMALL, 1e12, LIVE | THICK, NULL, "radius of a vibrator")     \
    X("vibrators.height", vibrators.height, REAL, "L", -LARGE, LARGE, LIVE | THICK, NULL,                           \
      "with kind force: y below which particles are pushed")                                                        \
    X("vibrators.seed", vibrators.seed, INTEGER, "", 0, WHOLE, THICK, NULL, "seed of the random frequencies")       \
    X("melting.smoothing_length", melting.smoothing_length, REAL, "L", 0, 1e12, MELT | LIVE, NULL,                  \
      "h, a third of the support of the kernel; 0: the spacing")                                                    \
    X("melting.rest_density", melting.rest_density, REAL, "M/L^3", SMALL, 1e12, MELT | LIVE, NULL,                  \
      "rho0; a particle has the mass rho0 spacing^3")                                                               \
    X("melting.sound_speed", melting.sound_speed, REAL, "L/T", SMALL, 1e12, MELT | LIVE, NULL,                      \
      "c of the pressure c^2 (rho - rho0)")                                                                         \
    X("melting.rheology", melting.rheology, CHOICE, "", 0, 1, MELT | LIVE, "jump newtonian",                        \
      "viscosity from the jump number (Eq. 3), or constant")                                                        \
    X("melting.viscosity", melting.viscosity, REAL, "M/(L T)", 0, LARGE, MELT | LIVE, NULL,                         \
      "mu, dynamic viscosity: eta = mu eta*(D t0)")                                                                 \
    X("melting.time_scale", melting.time_scale, REAL, "T", SMALL, 1e12, MELT | LIVE, NULL,                          \
      "t0; the yield stress is mu/t0")                                                                              \
    X("melting.power_law_index", melting.power_law_index, REAL, "1", 0, 2, MELT | LIVE, NULL,                       \
      "n of the power law; below 1 it thins")                                                                       \
    X("melting.jump_number_min", melting.jump_number_min, REAL, "1", 0, 1e9, MELT | LIVE, NULL,                     \
      "J of what is molten")                                                                                        \
    X("melting.jump_number_max", melting.jump_number_max, REAL, "1", 0, 1e9, MELT | LIVE, NULL,                     \
      "J of what is solid")                                                                                         \
    X("melting.temperature_min", melting.temperature_min, REAL, "K", -1e12, 1e12, MELT | LIVE, NULL,                \
      "below it all is solid")                                                                                      \
    X("melting.temperature_max", melting.temperature_max, REAL, "K", -1e12, 1e12, MELT | LIVE, NULL,                \
      "above it all is molten")                                                                                     \
    X("melting.temperature", melting.temperature, REAL, "K", -1e12, 1e12, MELT | LIVE, NULL,                        \
      "of particles that are given none")                                                                           \
    X("melting.diffusivity", melting.diffusivity, REAL, "L^2/T", 0, 1e12, MELT | LIVE, NULL,                        \
      "k, thermal; 0 at the start: no heat flows")                                                                  \
    X("melting.alpha", melting.alpha, REAL, "1", 0, 1e6, MELT | LIVE, NULL, "artificial viscosity, bulk")           \
    X("melting.beta", melting.beta, REAL, "1", 0, 1e6, MELT | LIVE, NULL,                                           \
      "artificial viscosity, von Neumann-Richtmyer")                                                                \
    X("melting.xsph", melting.xsph, REAL, "1", 0, 1, MELT | LIVE, NULL,                                             \
      "epsilon, how far particles move with their neighbours")                                                      \
    X("melting.repulsion", melting.repulsion, REAL, "1", 0, 1e6, MELT | LIVE, NULL,                                 \
      "against clumping, in c^2/spacing, of pairs closer than 0.7 spacings")                                        \
    X("melting.courant_number", melting.courant_number, REAL, "1", 1e-6, 10, MELT | LIVE, NULL,                     \
      "substep in h/(c + |v|max)")                                                                                  \
    X("melting.substeps", melting.substeps, INTEGER, "", 0, 200000, MELT | LIVE, NULL,                              \
      "substeps in a step; 0: as many as the state asks for")                                                       \
    X("melting.max_substeps", melting.max_substeps, INTEGER, "", 1, 200000, MELT | LIVE, NULL,                      \
      "a step that asks for more substeps is refused")                                                              \
    X("melting.stress", melting.stress, CHOICE, "", 0, 1, MELT | LIVE, "pairwise nested",                           \
      "stress between pairs, or D, eta D and its divergence one after the other")                                   \
    X("melting.solver", melting.solver, CHOICE, "", 0, 1, MELT | LIVE, "implicit explicit",                         \
      "viscosity by conjugate gradients, or with substeps that it asks for")                                        \
    X("melting.tolerance", melting.tolerance, REAL, "1", 1e-12, 1, MELT | LIVE, NULL,                               \
      "of conjugate gradients: residual against what a substep changes")                                            \
    X("melting.max_iterations", melting.max_iterations, INTEGER, "", 1, 1e6, MELT | LIVE, NULL,                     \
      "of conjugate gradients in a substep")                                                                        \
    X("melting.density", melting.density, CHOICE, "", 0, 1, MELT, "continuity summation",                           \
      "density integrated, or the sum of m W")                                                                      \
    X("melting.laplacian", melting.laplacian, CHOICE, "", 0, 1, MELT | LIVE, "first second",                        \
      "of the temperature, from first or second derivatives of the kernel")                                         \
    X("melting.flow", melting.flow, CHOICE, "", 0, 1, MELT, "on frozen", "frozen: nothing moves, heat alone flows") \
    X("melting.wall", melting.wall, CHOICE, "", 0, 1, MELT | LIVE, "no-slip free-slip",                             \
      "what the fluid does along walls")                                                                            \
    X("paper.kernel", paper.kernel, CHOICE, "", 0, 1, MELT | LIVE, "off on",                                        \
      "as printed: 3/(359 pi h^3) for 1/(120 pi h^3)")                                                              \
    X("paper.jump", paper.jump, CHOICE, "", 0, 1, MELT | LIVE, "off on", "as printed: the sign of J(T)")            \
    X("paper.artificial_viscosity", paper.artificial_viscosity, CHOICE, "", 0, 1, MELT | LIVE, "off on",            \
      "as printed: Eq. 8")                                                                                          \
    X("paper.courant", paper.courant, CHOICE, "", 0, 1, MELT | LIVE, "off on", "as printed: Eq. 10")                \
    X("paper.xsph", paper.xsph, CHOICE, "", 0, 1, MELT, "off on", "as printed: Eq. 9 changes velocities")           \
    X("paper.heat", paper.heat, CHOICE, "", 0, 1, MELT | LIVE, "off on",                                            \
      "as printed: the weight of the heat equation")                                                                \
    X("paper.leapfrog", paper.leapfrog, CHOICE, "", 0, 1, MELT, "off on", "as printed: Algorithm 1")

typedef struct table_entry {
    rheo_parameter parameter;
    size_t offset;
} table_entry;

#define MODELS(flags)                                      \
    ((flags)&THICK  ? UINT32_C(1) << RHEO_MODEL_THICKENING \
     : (flags)&MELT ? UINT32_C(1) << RHEO_MODEL_MELTING    \
                    : UINT32_C(1) << RHEO_MODEL_THICKENING | UINT32_C(1) << RHEO_MODEL_MELTING)
#define ENTRY(path, member, type, unit, minimum, maximum, flags, choices, about)                 \
    {{path, unit, about, choices, minimum, maximum, RHEO_PARAMETER_##type, ((flags)&ABOVE) != 0, \
      ((flags)&BELOW) != 0, ((flags)&LIVE) != 0, MODELS(flags)},                                 \
     offsetof(rheo_world_def, member)},
static const table_entry table[] = {PARAMETERS(ENTRY)};
enum { COUNT = sizeof table / sizeof *table };

/* One mutable member of a definition. */
static void *member(const rheo_world_def *def, const rheo_parameter *parameter)
{
    const table_entry *entry = (const table_entry *)(const void *)parameter;
    return (char *)(uintptr_t)def + entry->offset;
}

size_t rheo_parameter_count(void)
{
    return COUNT;
}

const rheo_parameter *rheo_parameter_at(size_t index)
{
    return index < COUNT ? &table[index].parameter : NULL;
}

const rheo_parameter *rheo__parameter_find(const char *path)
{
    for (size_t i = 0; i < COUNT; i++)
        if (strcmp(table[i].parameter.path, path) == 0)
            return &table[i].parameter;
    return NULL;
}

/* Edit distance of two names (Levenshtein), each cut at 63 characters. */
static size_t distance(const char *a, const char *b)
{
    size_t row[64], length = strlen(b) < 63 ? strlen(b) : 63;
    for (size_t j = 0; j <= length; j++)
        row[j] = j;
    for (size_t i = 1; a[i - 1] && i < 64; i++) {
        size_t corner = row[0];
        row[0] = i;
        for (size_t j = 1; j <= length; j++) {
            size_t change = corner + (a[i - 1] != b[j - 1]);
            corner = row[j];
            row[j] = row[j] < row[j - 1] ? row[j] + 1 : row[j - 1] + 1;
            row[j] = change < row[j] ? change : row[j];
        }
    }
    return row[length];
}

const char *rheo_parameter_nearest(const char *path)
{
    size_t best = SIZE_MAX;
    const char *nearest = table[0].parameter.path;
    for (size_t i = 0; i < COUNT; i++) {
        /* Often only the group is missing: "stiffness" for "springs.stiffness". */
        const char *known = table[i].parameter.path, *last = strchr(known, '.');
        size_t whole = distance(path, known), tail = last ? distance(path, last + 1) + 1 : SIZE_MAX;
        size_t d = whole < tail ? whole : tail;
        if (d < best) {
            best = d;
            nearest = known;
        }
    }
    return nearest;
}

uint32_t rheo__parameter_values(const rheo_world_def *def, const rheo_parameter *parameter, double values[3])
{
    const void *from = member(def, parameter);
    uint64_t whole;
    uint32_t small;
    values[0] = values[1] = values[2] = 0;
    switch (parameter->type) {
    case RHEO_PARAMETER_REAL:
        memcpy(values, from, sizeof *values);
        return 1;
    case RHEO_PARAMETER_VECTOR:
        memcpy(values, from, 3 * sizeof *values);
        return 3;
    case RHEO_PARAMETER_INTEGER:
        memcpy(&whole, from, sizeof whole);
        values[0] = (double)whole;
        return 1;
    case RHEO_PARAMETER_CHOICE:
        memcpy(&small, from, sizeof small);
        values[0] = small;
        return 1;
    case RHEO_PARAMETER_WINDOW:
        values[0] = def->history.window;
        values[1] = def->history.window_seconds;
        return 2;
    }
    return 0;
}

/* Says why a number will not do, or RHEO_OK. */
static rheo_result check_value(const rheo_parameter *p, double value, rheo_error *error)
{
    bool low = p->above_minimum ? !(value > p->minimum) : !(value >= p->minimum);
    bool high = p->below_maximum ? !(value < p->maximum) : !(value <= p->maximum);
    bool whole = p->type != RHEO_PARAMETER_INTEGER || (!low && !high && value == (double)(int64_t)value);
    if (!low && !high && whole)
        return RHEO_OK;
    char given[32], minimum[32], maximum[32];
    rheo__text_from_double(value, given);
    rheo__text_from_double(p->minimum, minimum);
    rheo__text_from_double(p->maximum, maximum);
    if (p->maximum >= LARGE && p->minimum > -LARGE)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "%s is %s; it must be a finite number %s %s", p->path, given,
                          p->above_minimum ? "above" : "of at least", minimum);
    if (p->maximum >= LARGE)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "%s is %s; it must be a finite number", p->path, given);
    return rheo__fail(error, RHEO_ERROR_ARGUMENT, "%s is %s; it must be a %snumber %s %s and %s %s", p->path, given,
                      p->type == RHEO_PARAMETER_INTEGER ? "whole " : "", p->above_minimum ? "above" : "of at least",
                      minimum, p->below_maximum ? "below" : "at most", maximum);
}

/* A window is given in steps or, when the second value is positive, in seconds. */
static rheo_result check_window(const rheo_parameter *p, const double values[3], rheo_error *error)
{
    if (values[1] > 0 && values[1] <= LARGE)
        return RHEO_OK;
    if (values[1] != 0)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                          "%s must be a number of seconds above 0, as in \"2.5 s\", or a whole number of steps",
                          p->path);
    if (values[0] >= p->minimum && values[0] <= p->maximum && values[0] == (double)(uint32_t)values[0])
        return RHEO_OK;
    char given[32];
    rheo__text_from_double(values[0], given);
    return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                      "%s is %s; it must be a whole number of steps from 1 to 1000000, or seconds as in \"2.5 s\"",
                      p->path, given);
}

static rheo_result check_values(const rheo_parameter *p, const double values[3], rheo_error *error)
{
    if (p->type == RHEO_PARAMETER_WINDOW)
        return check_window(p, values, error);
    for (uint32_t i = 0; i < (p->type == RHEO_PARAMETER_VECTOR ? 3 : 1); i++)
        RHEO__TRY(check_value(p, values[i], error));
    return RHEO_OK;
}

rheo_result rheo__parameter_assign(rheo_world_def *def, const rheo_parameter *p, const double given[3],
                                   rheo_error *error)
{
    void *to = member(def, p);
    double values[3] = {given[0], given[1], given[2]};
    if (p->type == RHEO_PARAMETER_REAL)
        values[0] += 0.0; /* -0, which would divide with the other sign, becomes 0 */
    RHEO__TRY(check_values(p, values, error));
    switch (p->type) {
    case RHEO_PARAMETER_REAL:
        memcpy(to, values, sizeof *values);
        break;
    case RHEO_PARAMETER_VECTOR:
        memcpy(to, values, 3 * sizeof *values);
        break;
    case RHEO_PARAMETER_INTEGER: {
        uint64_t whole = (uint64_t)values[0];
        memcpy(to, &whole, sizeof whole);
        break;
    }
    case RHEO_PARAMETER_CHOICE: {
        uint32_t choice = (uint32_t)values[0];
        memcpy(to, &choice, sizeof choice);
        break;
    }
    case RHEO_PARAMETER_WINDOW:
        def->history.window_seconds = values[1];
        if (values[1] == 0)
            def->history.window = (uint32_t)values[0];
        break;
    }
    return RHEO_OK;
}

rheo_result rheo__parameters_check(const rheo_world_def *def, rheo_error *error)
{
    for (size_t i = 0; i < COUNT; i++) {
        double values[3];
        rheo__parameter_values(def, &table[i].parameter, values);
        RHEO__TRY(check_values(&table[i].parameter, values, error));
    }
    return RHEO_OK;
}

/* ---- As text ---- */

static const char *skip_blanks(const char *text)
{
    return text + strspn(text, " \t");
}

static rheo_result bad_text(const rheo_parameter *p, const char *value, rheo_error *error)
{
    switch (p->type) {
    case RHEO_PARAMETER_VECTOR:
        return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                          "%s cannot be \"%.60s\"; it is three numbers, as in [0, -9.81, 0]", p->path, value);
    case RHEO_PARAMETER_CHOICE:
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "%s cannot be \"%.60s\"; it is one of: %s", p->path, value,
                          p->choices);
    case RHEO_PARAMETER_WINDOW:
        return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                          "%s cannot be \"%.60s\"; it is a number of steps, as in 150, or seconds, as in \"2.5 s\"",
                          p->path, value);
    default:
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "%s cannot be \"%.60s\"; it is a number", p->path, value);
    }
}

static bool read_choice(const rheo_parameter *p, const char *value, double *index)
{
    size_t length = strcspn(value, " \t");
    *index = 0;
    for (const char *word = p->choices; *word; ++*index) {
        size_t word_length = strcspn(word, " ");
        if (word_length == length && strncmp(word, value, length) == 0)
            return *skip_blanks(value + length) == 0;
        word = skip_blanks(word + word_length);
    }
    return false;
}

rheo_result rheo_world_def_set(rheo_world_def *def, const char *path, const char *value, rheo_error *error)
{
    const rheo_parameter *p = rheo__parameter_find(path);
    if (!p)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "there is no parameter \"%.60s\"; the nearest is \"%s\"", path,
                          rheo_parameter_nearest(path));
    if (!(p->models >> def->model & 1))
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "%s is no parameter of the model %s", path,
                          rheo_model_name(def->model));
    double values[3] = {0, 0, 0};
    const char *at = skip_blanks(value), *end;
    if (p->type == RHEO_PARAMETER_CHOICE) {
        if (!read_choice(p, at, &values[0]))
            return bad_text(p, value, error);
        return rheo__parameter_assign(def, p, values, error);
    }
    uint32_t count = p->type == RHEO_PARAMETER_VECTOR ? 3 : 1;
    bool bracket = count == 3 && *at == '[';
    at += bracket;
    for (uint32_t i = 0; i < count; i++) {
        at = skip_blanks(at);
        values[i] = rheo__text_to_double(at, &end);
        if (end == at)
            return bad_text(p, value, error);
        at = skip_blanks(end);
        if (i + 1 < count) {
            if (*at != ',')
                return bad_text(p, value, error);
            at++;
        }
    }
    if (bracket && *at++ != ']')
        return bad_text(p, value, error);
    if (p->type == RHEO_PARAMETER_WINDOW && *at == 's') {
        at++;
        if (!(values[0] > 0)) /* 0 would mean steps */
            return bad_text(p, value, error);
        values[1] = values[0];
        values[0] = 0;
    }
    if (*skip_blanks(at) != 0)
        return bad_text(p, value, error);
    return rheo__parameter_assign(def, p, values, error);
}

rheo_result rheo_world_def_get(const rheo_world_def *def, const char *path, char *value, size_t size)
{
    const rheo_parameter *p = rheo__parameter_find(path);
    if (!p)
        return RHEO_ERROR_ARGUMENT;
    double values[3] = {0, 0, 0};
    char text[3][32];
    uint32_t count = rheo__parameter_values(def, p, values);
    for (uint32_t i = 0; i < 3; i++)
        rheo__text_from_double(values[i], text[i]);
    int length = 0;
    if (p->type == RHEO_PARAMETER_CHOICE) {
        const char *word = p->choices;
        for (uint32_t i = 0; i < (uint32_t)values[0]; i++)
            word = skip_blanks(word + strcspn(word, " "));
        length = snprintf(value, size, "%.*s", (int)strcspn(word, " "), word);
    } else if (p->type == RHEO_PARAMETER_WINDOW) {
        length = values[1] > 0 ? snprintf(value, size, "%s s", text[1]) : snprintf(value, size, "%s", text[0]);
    } else if (count == 3) {
        length = snprintf(value, size, "[%s, %s, %s]", text[0], text[1], text[2]);
    } else {
        length = snprintf(value, size, "%s", text[0]);
    }
    return length >= 0 && (size_t)length < size ? RHEO_OK : RHEO_ERROR_ARGUMENT;
}
