/*
 * Where, when and why a run went bad, from the metrics and parameters that a recording holds. The measures, their
 * ranges and how they were found: docs/debugging.md.
 *
 * A stage that moves a particle by half a support or more in one step throws it past its neighbours: no run that was
 * watched came back from that unharmed, and none that stayed well did it. These measures are grave. Others tell
 * earlier what is coming, but come and go in healthy runs too: a spring that is too stiff for the step does no harm
 * while it is not stretched. They are signs: they count if they lead up to a grave one, or to a step that fails,
 * without a gap. Conditions are numbers of the parameters alone (and of the speed of the ball, and of substeps).
 * Beyond its second limit a condition is what is wrong, whatever shows it first: under too stiff a pressure it is
 * springs that tear.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/text.h"
#include "melting/melting.h"
#include "record/recording.h"

typedef enum kind { NOTICE, PRECURSOR, SEVERE, CONDITION } kind;

typedef enum measure_id {
    PRESSURE_NUMBER,
    NEAR_PRESSURE_NUMBER,
    PLASTICITY_NUMBER,
    VIBRATOR_SPEED,
    BALL_SPEED,
    STIFFNESS_NUMBER,
    STIFFNESS_SUM,
    MAX_SPRING_DISPLACEMENT,
    MAX_PRESSURE_DISPLACEMENT,
    SPEED_JUMP,
    COURANT_NUMBER,
    MAX_DENSITY,
    ENERGY_JUMP,
    /* From here on of worlds that melt. */
    SUBSTEP_COURANT_NUMBER,
    VISCOUS_NUMBER,
    HEAT_NUMBER,
    MACH_NUMBER,
    MAX_DENSITY_ERROR,
    DENSITY_ERROR,
    SPEED_RISE,
    ENERGY_RISE,
    SOLVER_SHARE,
    MEASURES
} measure_id;

typedef struct measure {
    const char *name;
    kind kind;
    double limit;
    const char *stage;
    const char *id, *other_id; /* metrics that name its particle or the ends of its spring */
    const char *meaning;
    double certain;  /* of a condition: its second limit */
    measure_id seen; /* of a condition: the measure that says where it shows */
} measure;

/* The order of this table decides between measures that leave their ranges in the same step: causes first. */
static const measure TABLE[MEASURES] = {
    [PRESSURE_NUMBER] = {"pressure_number", CONDITION, 0.16, "density", NULL, NULL,
                         "fluid.stiffness step^2 / support", 0.2, MAX_PRESSURE_DISPLACEMENT},
    [NEAR_PRESSURE_NUMBER] = {"near_pressure_number", CONDITION, 0.4, "density", NULL, NULL,
                              "fluid.near_stiffness step^2 / support", 0.44, MAX_PRESSURE_DISPLACEMENT},
    [PLASTICITY_NUMBER] = {"plasticity_number", CONDITION, 1, "springs", NULL, NULL,
                           "springs.plasticity step (1 + springs.yield_ratio): how far rest lengths flow in a step",
                           1.9, STIFFNESS_NUMBER},
    [VIBRATOR_SPEED] = {"vibrator_speed", CONDITION, 0.5, "vibrators", NULL, NULL,
                        "how far vibrators move the fluid in a step, in supports", 1, SPEED_JUMP},
    [BALL_SPEED] = {"ball_speed", CONDITION, 0.5, "ball", NULL, NULL, "how far the ball moves in a step, in supports",
                    0.75, SPEED_JUMP},
    [STIFFNESS_NUMBER] = {"stiffness_number", PRECURSOR, 2.4, "spring_displacement", "stiffness_a", "stiffness_b",
                          "kappa of the stiffest spring, step^2 (k_min + k_hist |D^q|)", 0, 0},
    [STIFFNESS_SUM] = {"stiffness_sum", PRECURSOR, 45, "spring_displacement", "stiffness_sum_id", NULL,
                       "sum of kappa over the springs of a particle", 0, 0},
    [MAX_SPRING_DISPLACEMENT] = {"max_spring_displacement", SEVERE, 0.5, "spring_displacement",
                                 "max_spring_displacement_id", NULL,
                                 "how far springs moved a particle in a step, in supports", 0, 0},
    [MAX_PRESSURE_DISPLACEMENT] = {"max_pressure_displacement", SEVERE, 0.5, "density",
                                   "max_pressure_displacement_id", NULL,
                                   "how far pressure moved a particle in a step, in supports", 0, 0},
    [SPEED_JUMP] = {"speed_jump", SEVERE, 1, "velocity", "max_speed_id", NULL,
                    "rise of the largest speed in a step, in supports a step", 0, 0},
    [COURANT_NUMBER] = {"courant_number", NOTICE, 0.5, "velocity", "max_speed_id", NULL,
                        "how far the fastest particle moves in a step, in supports", 0, 0},
    [MAX_DENSITY] = {"max_density", NOTICE, 2, "density", "max_density_id", NULL,
                     "density of the densest particle, in rest densities", 0, 0},
    [ENERGY_JUMP] = {"energy_jump", NOTICE, 2, "velocity", "max_speed_id", NULL,
                     "energy gained in a step, as a part of what there was", 0, 0},
    [SUBSTEP_COURANT_NUMBER] = {"substep_courant_number", CONDITION, 2, "integration", NULL, NULL,
                                "substep (melting.sound_speed + max_speed) / smoothing length", 2.35,
                                MAX_DENSITY_ERROR},
    [VISCOUS_NUMBER] = {"viscous_number", CONDITION, 1, "viscosity", NULL, NULL,
                        "substep of the explicit solver, in those that the largest viscosity allows", 1.3,
                        MAX_DENSITY_ERROR},
    [HEAT_NUMBER] = {"heat_number", CONDITION, 0.4, "integration", NULL, NULL,
                     "substep melting.diffusivity / smoothing length^2", 0.5, MAX_DENSITY_ERROR},
    [MACH_NUMBER] = {"mach_number", PRECURSOR, 0.3, "momentum", "max_speed_id", NULL,
                     "largest speed, in melting.sound_speed", 0, 0},
    [MAX_DENSITY_ERROR] = {"max_density_error", PRECURSOR, 0.2, "integration", "max_density_id", NULL,
                           "how far a particle's density is from that at rest, in rest densities", 0, 0},
    [DENSITY_ERROR] = {"density_error", SEVERE, 0.2, "integration", "max_density_id", NULL,
                       "the same, mean over the particles", 0, 0},
    [SPEED_RISE] = {"speed_rise", SEVERE, 0.5, "momentum", "max_speed_id", NULL,
                    "rise of the largest speed in a step, in melting.sound_speed", 0, 0},
    [ENERGY_RISE] = {"energy_jump", SEVERE, 0.5, "momentum", "max_speed_id", NULL,
                     "energy gained in a step, as a part of what there was", 0, 0},
    [SOLVER_SHARE] = {"solver_share", NOTICE, 0.99, "viscosity", NULL, NULL,
                      "mean iterations of the solver of viscosity in a substep, in melting.max_iterations", 0, 0},
};
_Static_assert((int)MEASURES <= (int)RHEO_MAX_FINDINGS, "a diagnosis has room for every measure");

/* Signs further apart than this do not belong together. */
enum { GAP = 10 };
/* Supports a step: below this the energy of motion is so small that its changes mean nothing. */
static const double LIVELY = 0.1;
/* Far away positions are coarse, and so are the speeds taken from them: a jump is at least so many times the speed.
 */
static const double GROWN = 1.5;

typedef struct examination {
    rheo_recording *recording;
    rheo_diagnosis *diagnosis;
    int column[MEASURES], id_column[MEASURES], other_column[MEASURES]; /* -1: not recorded */
    int max_speed, courant_number, substeps, iterations, ball[3];
    rheo_world_def def;         /* in force in the step at hand */
    const double *now, *before; /* metrics; before: NULL at the first step */
    bool unfinished;            /* the step could not be made: what it has not measured is as it was before */
    bool moves;                 /* commands brought particles with speeds of their own */
    uint64_t step;

    rheo_finding finding[MEASURES];
    bool found[MEASURES];
    uint64_t certain_step[MEASURES]; /* last step at which a condition was beyond its second limit */
    bool certain[MEASURES];
    rheo_finding shown[MEASURES]; /* of conditions: value then, and where it showed */

    bool running;       /* an unbroken run of signs */
    rheo_finding begin; /* what it began with */
    measure_id begin_with;
    uint64_t last_sign;
    double kappa, push;  /* the largest in it, up to the grave step */
    double speed, error; /* the largest max_speed and density_error so far, up to there too */
    bool unhealthy;
    rheo_world_def unhealthy_def; /* in force at the grave step, or the last one */
} examination;

/* ---- What is measured ---- */

static int column_of(const rheo_recording *r, const char *name)
{
    for (uint32_t i = 0; name && i < rheo_recording_metric_count(r); i++)
        if (strcmp(rheo_recording_metric_name(r, i), name) == 0)
            return (int)i;
    return -1;
}

static double vibrator_speed(const rheo_world_def *def)
{
    double a = def->vibrators.amplitude, angular = 2 * 3.14159265358979323846 * def->vibrators.frequency,
           step = def->step;
    double length =
        def->vibrators.kind == RHEO_VIBRATOR_FLOOR ? a * angular * step : a * angular * angular * step * step;
    return length / def->fluid.support;
}

static double speed(const double *v, const int column[3])
{
    double x = v[column[0]], y = v[column[1]], z = v[column[2]];
    return sqrt(x * x + y * y + z * z);
}

/* ---- In worlds that melt ---- */

/* The duration of a substep; false if it is not known. */
static bool substep_of(const examination *e, double *substep)
{
    double count = e->unfinished || e->substeps < 0 ? 0 : e->now[e->substeps];
    if (!(count > 0)) /* what a step begins with has made none */
        count = (double)e->def.melting.substeps;
    *substep = e->def.step / count;
    return count > 0;
}

/* The largest apparent viscosity that a particle can have. */
static double largest_viscosity(const examination *e)
{
    const rheo_world_def *def = &e->def;
    if (def->melting.rheology == RHEO_RHEOLOGY_NEWTONIAN)
        return def->melting.viscosity;
    const double jump = e->recording->head.features & RHEO__FEATURE_TEMPERATURE
                            ? fmax(def->melting.jump_number_min, def->melting.jump_number_max)
                            : rheo__melting_jump(def, def->melting.temperature);
    return 1.35 * def->melting.viscosity * (jump + 1);
}

/* Substeps that viscosity allows at most, in rho0 h^2 / eta: measured, docs/debugging.md. */
static double viscous_limit(const rheo_world_def *def)
{
    return def->melting.stress == RHEO_STRESS_NESTED ? 1 : 0.16;
}

static bool value_of_melting(const examination *e, measure_id m, double *value)
{
    const rheo_world_def *def = &e->def;
    const double h = rheo__melting_smoothing_length(def), c = def->melting.sound_speed;
    const bool moves = def->melting.flow == RHEO_FLOW_ON;
    double substep;
    switch (m) {
    case SUBSTEP_COURANT_NUMBER:
        if (!moves || e->max_speed < 0 || !substep_of(e, &substep))
            return false;
        *value = substep * (c + e->now[e->max_speed]) / h;
        return true;
    case VISCOUS_NUMBER:
        if (!moves || def->melting.solver == RHEO_VISCOSITY_IMPLICIT || !substep_of(e, &substep))
            return false;
        *value = substep * largest_viscosity(e) / (def->melting.rest_density * h * h * viscous_limit(def));
        return true;
    case HEAT_NUMBER:
        if (!(e->recording->head.features & RHEO__FEATURE_HEAT) || !substep_of(e, &substep))
            return false;
        *value = substep * def->melting.diffusivity / (h * h);
        return true;
    case MACH_NUMBER:
        if (e->max_speed < 0)
            return false;
        *value = e->now[e->max_speed] / c;
        return true;
    case SPEED_RISE:
        if (!e->before || e->unfinished || e->moves || e->max_speed < 0 ||
            e->now[e->max_speed] <= GROWN * e->before[e->max_speed])
            return false;
        *value = (e->now[e->max_speed] - e->before[e->max_speed]) / c;
        return true;
    case SOLVER_SHARE:
        if (e->unfinished || e->iterations < 0 || e->substeps < 0 || !(e->now[e->substeps] > 0))
            return false;
        *value = e->now[e->iterations] / e->now[e->substeps] / (double)def->melting.max_iterations;
        return true;
    default:
        return e->column[m] >= 0;
    }
}

static bool value_of_thickening(const examination *e, measure_id m, double *value)
{
    const rheo_world_def *def = &e->def;
    double per_step = def->step / def->fluid.support;
    switch (m) {
    case PRESSURE_NUMBER:
        *value = def->fluid.stiffness * def->step * per_step;
        return true;
    case NEAR_PRESSURE_NUMBER:
        *value = def->fluid.near_stiffness * def->step * per_step;
        return true;
    case PLASTICITY_NUMBER:
        *value = def->springs.plasticity * def->step * (1 + def->springs.yield_ratio);
        return def->springs.stiffness > 0;
    case VIBRATOR_SPEED:
        *value = vibrator_speed(def);
        return def->vibrators.count > 0;
    case BALL_SPEED:
        if (e->ball[0] < 0 || e->ball[1] < 0 || e->ball[2] < 0)
            return false;
        *value = speed(e->now, e->ball) * per_step;
        return true;
    case STIFFNESS_NUMBER:
    case STIFFNESS_SUM:
        return e->column[m] >= 0 && def->springs.solver == RHEO_SOLVER_EXPLICIT;
    case SPEED_JUMP:
        if (!e->before || e->unfinished || e->moves || e->max_speed < 0)
            return false;
        if (e->now[e->max_speed] <= GROWN * e->before[e->max_speed])
            return false;
        *value = (e->now[e->max_speed] - e->before[e->max_speed]) * per_step;
        return true;
    case ENERGY_JUMP:
        return e->column[m] >= 0 && def->vibrators.count == 0 && e->courant_number >= 0 &&
               !(e->now[e->courant_number] < LIVELY);
    default:
        return e->column[m] >= 0;
    }
}

/* False: it is not measured here, has no meaning, or is of the other model. */
static bool value_of(const examination *e, measure_id m, double *value)
{
    const bool melting = m >= SUBSTEP_COURANT_NUMBER;
    if (melting != (e->def.model == RHEO_MODEL_MELTING))
        return false;
    if (e->column[m] >= 0) {
        *value = e->now[e->column[m]];
        if (e->unfinished && memcmp(value, &e->before[e->column[m]], sizeof *value) == 0)
            return false;
    }
    return melting ? value_of_melting(e, m, value) : value_of_thickening(e, m, value);
}

static int64_t id_of(const examination *e, int column)
{
    double id = column >= 0 ? e->now[column] : -1;
    return id >= 0 && id <= (double)UINT32_MAX ? (int64_t)id : -1;
}

static rheo_finding finding_of(const examination *e, measure_id m, double value)
{
    const measure *table = &TABLE[m];
    return (rheo_finding){.measure = table->name,
                          .stage = table->stage,
                          .meaning = table->meaning,
                          .limit = table->limit,
                          .step = e->step,
                          .value = value,
                          .id = id_of(e, e->id_column[m]),
                          .other_id = id_of(e, e->other_column[m]),
                          .peak_step = e->step,
                          .peak = value,
                          .severe = table->kind == SEVERE};
}

/* ---- A step ---- */

static void note(examination *e, measure_id m, double value)
{
    rheo_finding *f = &e->finding[m];
    if (!e->found[m]) {
        *f = finding_of(e, m, value);
        e->found[m] = true;
    }
    f->steps++;
    if (value > f->peak || isnan(f->peak)) {
        f->peak = value;
        f->peak_step = e->step;
    }
    if (TABLE[m].kind == CONDITION && !e->unhealthy && !(value <= TABLE[m].certain)) {
        e->certain[m] = true;
        e->certain_step[m] = e->step;
        e->shown[m] = finding_of(e, m, value);
        e->shown[m].limit = TABLE[m].certain;
    }
}

static void examine_step(examination *e)
{
    bool grave = false;
    for (measure_id m = 0; m < MEASURES; m++) {
        double value = 0;
        if (!value_of(e, m, &value) || value <= TABLE[m].limit) /* what is no number is out of range */
            continue;
        note(e, m, value);
        if (TABLE[m].kind != PRECURSOR && TABLE[m].kind != SEVERE)
            continue;
        grave = grave || TABLE[m].kind == SEVERE;
        if (e->unhealthy)
            continue;
        if (!e->running || e->step > e->last_sign + GAP) {
            e->running = true;
            e->begin = finding_of(e, m, value);
            e->begin_with = m;
            e->kappa = e->push = 0;
        }
        e->last_sign = e->step;
    }
    if (e->unhealthy)
        return;
    double value;
    if (e->running && value_of(e, STIFFNESS_NUMBER, &value))
        e->kappa = fmax(e->kappa, value);
    for (measure_id m = MAX_SPRING_DISPLACEMENT; m <= MAX_PRESSURE_DISPLACEMENT; m++)
        if (e->running && value_of(e, m, &value))
            e->push = fmax(e->push, value);
    if (value_of(e, MACH_NUMBER, &value))
        e->speed = fmax(e->speed, value * e->def.melting.sound_speed);
    if (value_of(e, DENSITY_ERROR, &value))
        e->error = fmax(e->error, value);
    if (grave) {
        e->unhealthy = true;
        e->diagnosis->unhealthy_step = e->step;
        e->unhealthy_def = e->def;
    }
}

/* Where a condition shows: the particle, or spring, that its measure names in the step at hand. */
static void show_conditions(examination *e)
{
    for (measure_id m = 0; m < MEASURES; m++)
        if (TABLE[m].kind == CONDITION && e->certain[m]) {
            measure_id seen = TABLE[m].seen;
            e->shown[m].step = e->step;
            e->shown[m].id = id_of(e, e->id_column[seen]);
            e->shown[m].other_id = id_of(e, e->other_column[seen]);
        }
}

/* Of the step that could not be made there is what its stages had found before it went bad, and its commands. */
static rheo_result examine_steps(examination *e, double *values, uint32_t count, rheo_error *error)
{
    rheo_diagnosis *d = e->diagnosis;
    rheo_recording *r = e->recording;
    double *now = values, *before = values + count;
    const uint64_t end = d->last_step + d->failed;
    for (e->step = d->first_step; e->step <= end; e->step++) {
        e->moves = false;
        e->before = e->step > d->first_step ? before : NULL;
        e->unfinished = e->step > d->last_step;
        RHEO__TRY(rheo_recording_metrics(r, e->step, now, error));
        if (e->before)
            RHEO__TRY(rheo__recording_define(r, e->unfinished ? &r->failed : &r->steps[e->step - d->first_step - 1],
                                             e->step, &e->def, &e->moves, error));
        e->now = now;
        bool was_ill = e->unhealthy;
        examine_step(e);
        if (!was_ill && (e->unhealthy || e->step == end))
            show_conditions(e);
        double *other = now;
        now = before;
        before = other;
    }
    if (!e->unhealthy)
        e->unhealthy_def = e->def;
    return RHEO_OK;
}

/* ---- The cause ---- */

/* A condition that was certain when the run went bad, or shortly before: a ball is slow again after it has hit. */
static bool certain_condition(const examination *e, uint64_t begin, measure_id *cause)
{
    for (measure_id m = 0; m < MEASURES; m++)
        if (e->certain[m] && e->certain_step[m] + GAP >= begin) {
            *cause = m;
            return true;
        }
    return false;
}

/* MEASURES: none; the failure itself is all that is known. */
static measure_id find_cause(examination *e)
{
    rheo_diagnosis *d = e->diagnosis;
    if (d->failed && !e->unhealthy) {
        d->unhealthy_step = d->failure.step;
        e->running = e->running && e->last_sign + GAP >= d->unhealthy_step;
    }
    measure_id cause = MEASURES;
    if (certain_condition(e, e->running ? e->begin.step : d->unhealthy_step, &cause)) {
        d->cause = e->shown[cause];
    } else if (e->running) {
        cause = e->begin_with;
        d->cause = e->begin;
    } else {
        d->cause = (rheo_finding){
            .measure = "", .stage = "", .meaning = "", .step = d->failure.step, .id = -1, .other_id = -1};
        d->cause.limit = d->cause.value = d->cause.peak = NAN;
        if (d->failure.location == RHEO_LOCATION_PARTICLE)
            d->cause.id = (int64_t)d->failure.id;
    }
    if (cause < MEASURES) {
        d->cause.peak = e->finding[cause].peak;
        d->cause.peak_step = e->finding[cause].peak_step;
        d->cause.steps = e->finding[cause].steps;
    } else {
        d->cause.stage = d->failure.stage;
    }
    d->cause.severe = true;
    return cause;
}

/* ---- Advice ---- */

/* So many digits, the same in every locale; down: rounded towards 0. */
static const char *brief(double value, int digits, bool down, char text[32])
{
    double most = 1, scale = 1, size = fabs(value);
    for (int i = 1; i < digits; i++)
        most *= 10;
    if (size > 0 && size < 1e300) {
        while (size * scale < most && scale < 1e300)
            scale *= 10;
        while (size * scale >= 10 * most)
            scale /= 10;
        size = floor(size * scale + (down ? 1e-9 : 0.5));
        size = scale >= 1 ? size / scale : size * floor(1 / scale + 0.5);
    }
    if (isfinite(value))
        rheo__text_from_double(value < 0 ? -size : size, text);
    else
        snprintf(text, 32, "%s", isnan(value) ? "not a number" : "infinite");
    return text;
}

static void advise(rheo_diagnosis *d, const char *path, double value, const char *text)
{
    if (d->advice_count == RHEO_MAX_ADVICE || !(value > 0 && value < 1e300))
        return;
    rheo_advice *a = &d->advice[d->advice_count++];
    char number[32];
    snprintf(a->set, sizeof a->set, "%s=%s", path, brief(value, 2, true, number));
    snprintf(a->text, sizeof a->text, "%s", text);
}

static void advise_words(rheo_diagnosis *d, const char *set, const char *text)
{
    rheo_advice *a = &d->advice[d->advice_count++];
    snprintf(a->set, sizeof a->set, "%s", set);
    snprintf(a->text, sizeof a->text, "%s", text);
}

/*
 * The stiffness that a blow-up has shown when it is found is not the largest that the impact would have brought: half
 * of what a pair at rest bears is on the safe side.
 */
static void advise_springs(const examination *e, rheo_diagnosis *d)
{
    const rheo_world_def *def = &e->unhealthy_def;
    const double target = 0.5, kappa = fmax(e->kappa, 2 * target),
                 least = def->springs.stiffness * def->step * def->step;
    if (def->springs.solver == RHEO_SOLVER_IMPLICIT) {
        advise(d, "step", def->step * fmin(0.25 / e->push, 0.5),
               "a smaller step, so that springs stretch less in one");
        return;
    }
    advise_words(d, "springs.solver=implicit", "bears any stiffness; springs act more softly within a step");
    advise(d, "step", def->step * sqrt(target / kappa), "brings kappa down to 0.5, by step^2");
    if (least < target)
        advise(d, "history.stiffness", def->history.stiffness * (target - least) / (kappa - least),
               "brings kappa down to 0.5, if the fluid moves as it did");
    else
        advise(d, "springs.stiffness", target / (def->step * def->step),
               "brings kappa of springs at rest down to 0.5");
}

static void advise_pressure(const examination *e, rheo_diagnosis *d)
{
    const rheo_world_def *def = &e->unhealthy_def;
    if (d->cause.step <= d->first_step + 1)
        advise_words(d, "",
                     "the particles began too close to each other, or moving apart: leave a spacing between them");
    if (e->push > 0)
        advise(d, "step", def->step * fmin(0.25 / e->push, 0.5),
               "a smaller step, so that particles enter each other less");
}

/* So many substeps as bring a number that grows with their duration down to a target. */
static void advise_substeps(const examination *e, double number, double target, rheo_diagnosis *d)
{
    const rheo_world_def *def = &e->unhealthy_def;
    char set[64];
    if (!def->melting.substeps) {
        advise(d, "melting.courant_number", def->melting.courant_number * fmin(target / number, 0.5),
               "shorter substeps");
        return;
    }
    advise_words(d, "melting.substeps=0", "as many substeps as the state asks for");
    const double substeps = ceil((double)def->melting.substeps * fmax(number / target, 2));
    if (!(substeps <= 1e9))
        return;
    snprintf(set, sizeof set, "melting.substeps=%.0f", substeps);
    advise_words(d, set, "shorter substeps");
}

/* What is pressed together, or moves nearly as fast as sound: errors of density are as 1/c^2. */
static void advise_sound(const examination *e, rheo_diagnosis *d)
{
    const double c = e->unhealthy_def.melting.sound_speed, error = 0.02;
    advise(d, "melting.sound_speed", fmax(10 * e->speed, c * sqrt(fmax(e->error, 4 * error) / error)),
           "stiffer against pressure; ten times what anything moves at is usual. Substeps are as many more");
}

/* The step needs more substeps than are allowed, or compressed the fluid until a density was not above 0. */
static void advise_failed(const examination *e, rheo_diagnosis *d)
{
    const rheo_failure *f = &d->failure;
    char set[64];
    if (f->reason == RHEO_FAILURE_SUBSTEPS_FOR_VISCOSITY)
        advise_words(d, "melting.solver=implicit", "bears any viscosity with the substeps that sound asks for");
    if (f->reason == RHEO_FAILURE_SUBSTEPS_FOR_PRINTED_VISCOSITY)
        advise_words(d, "paper.courant=off", "bears any viscosity, if it is solved implicitly");
    if (!(f->limit > 0)) {
        advise_substeps(e, 2, 1, d);
        return;
    }
    const double needed = ceil(f->required * 1.25);
    if (!(needed > 0 && needed <= rheo__parameter_find("melting.max_substeps")->maximum))
        return;
    snprintf(set, sizeof set, "melting.max_substeps=%.0f", needed);
    advise_words(d, set, "takes the time that the step asks for");
}

static void advise_melting(const examination *e, measure_id cause, rheo_diagnosis *d)
{
    const double number = d->cause.value;
    switch (cause) {
    case SUBSTEP_COURANT_NUMBER:
        advise_substeps(e, number, 1, d);
        return;
    case VISCOUS_NUMBER:
        advise_words(d, "melting.solver=implicit", "bears any viscosity");
        advise_substeps(e, number, 0.8, d);
        return;
    case HEAT_NUMBER:
        advise_substeps(e, number, 0.1, d);
        return;
    case MACH_NUMBER:
    case MAX_DENSITY_ERROR:
    case DENSITY_ERROR:
        advise_sound(e, d);
        return;
    default:
        advise_failed(e, d);
    }
}

static void advise_all(const examination *e, measure_id cause, rheo_diagnosis *d)
{
    const rheo_world_def *def = &e->unhealthy_def;
    if (def->model == RHEO_MODEL_MELTING) {
        advise_melting(e, cause, d);
        return;
    }
    double step = def->step, number = d->cause.value, h = def->fluid.support;
    switch (cause) {
    case PRESSURE_NUMBER:
        advise(d, "step", step * sqrt(0.16 / number), "brings pressure_number down to 0.16");
        advise(d, "fluid.stiffness", 0.16 * h / (step * step), "the same; near_stiffness in proportion");
        return;
    case NEAR_PRESSURE_NUMBER:
        advise(d, "step", step * sqrt(0.27 / number), "brings near_pressure_number down to 0.27");
        advise(d, "fluid.near_stiffness", 0.27 * h / (step * step), "the same");
        return;
    case PLASTICITY_NUMBER:
        advise(d, "springs.plasticity", 1 / (step * (1 + def->springs.yield_ratio)),
               "rest lengths no longer overshoot");
        advise(d, "step", step / number, "the same");
        return;
    case VIBRATOR_SPEED:
        advise(d, "vibrators.amplitude", def->vibrators.amplitude * 0.5 / number,
               "moves the fluid by half a support a step");
        return;
    case BALL_SPEED:
        advise(d, "step", step * 0.5 / number, "the ball then moves half a support a step; or let it be slower");
        return;
    case STIFFNESS_NUMBER:
    case STIFFNESS_SUM:
    case MAX_SPRING_DISPLACEMENT:
        advise_springs(e, d);
        return;
    case MAX_PRESSURE_DISPLACEMENT:
        advise_pressure(e, d);
        return;
    default:
        advise(d, "step", step / 2, "a smaller step is what helps most often");
    }
}

/* ---- In words ---- */

static void tell_cause(const rheo_diagnosis *d, char *text, size_t size)
{
    const rheo_finding *c = &d->cause;
    char value[32], limit[32], where[64] = "";
    if (c->other_id >= 0)
        snprintf(where, sizeof where, ", spring %lld:%lld", (long long)c->id, (long long)c->other_id);
    else if (c->id >= 0)
        snprintf(where, sizeof where, ", particle %lld", (long long)c->id);
    if (c->measure[0])
        snprintf(text, size, "unhealthy: step %llu, stage %s: %s (%s) is %s, more than %s%s",
                 (unsigned long long)c->step, c->stage, c->measure, c->meaning, brief(c->value, 3, false, value),
                 brief(c->limit, 3, false, limit), where);
    else
        snprintf(text, size, "unhealthy: every measure was in range up to the end");
}

static void tell(rheo_diagnosis *d)
{
    size_t size = sizeof d->why;
    if (d->healthy)
        snprintf(d->why, size, "healthy: %s in step %llu to %llu",
                 d->finding_count ? "nothing grave" : "every measure is in range", (unsigned long long)d->first_step,
                 (unsigned long long)d->last_step);
    else
        tell_cause(d, d->why, size);
    size_t used = strlen(d->why);
    if (d->failed) {
        char message[512];
        rheo_failure_message(&d->failure, message, sizeof message);
        snprintf(d->why + used, size - used, "; %s", message);
    }
    used = strlen(d->why);
    if (!d->complete)
        snprintf(d->why + used, size - used, "; the recording is truncated after step %llu",
                 (unsigned long long)d->last_step);
}

/* In the order in which measures left their ranges; in one step, that of the table. */
static void list_findings(const examination *e, rheo_diagnosis *d)
{
    for (measure_id m = 0; m < MEASURES; m++) {
        if (!e->found[m])
            continue;
        uint32_t place = d->finding_count++;
        for (; place > 0 && d->findings[place - 1].step > e->finding[m].step; place--)
            d->findings[place] = d->findings[place - 1];
        d->findings[place] = e->finding[m];
    }
}

static rheo_result diagnose(examination *e, rheo_error *error)
{
    rheo_diagnosis *d = e->diagnosis;
    uint32_t count = rheo_recording_metric_count(e->recording);
    double *values = calloc(2 * (size_t)count + 1, sizeof *values);
    if (!values)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for the metrics of a recording");
    rheo_result result = examine_steps(e, values, count, error);
    free(values);
    RHEO__TRY(result);
    d->healthy = !e->unhealthy && !d->failed;
    if (!d->healthy)
        advise_all(e, find_cause(e), d);
    list_findings(e, d);
    tell(d);
    return RHEO_OK;
}

rheo_result rheo_diagnose(rheo_recording *recording, rheo_diagnosis *diagnosis, rheo_error *error)
{
    *diagnosis = (rheo_diagnosis){0};
    rheo_recording_info info = rheo_recording_get_info(recording);
    diagnosis->complete = info.complete;
    diagnosis->first_step = info.first_step;
    diagnosis->last_step = info.last_step;
    examination *e = calloc(1, sizeof *e); /* two definitions are large for a stack */
    if (!e)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory to examine a recording");
    e->recording = recording;
    e->diagnosis = diagnosis;
    e->def = *rheo_recording_definition(recording);
    e->max_speed = column_of(recording, "max_speed");
    e->courant_number = column_of(recording, "courant_number");
    e->substeps = column_of(recording, "substeps");
    e->iterations = column_of(recording, "iterations");
    diagnosis->failed = rheo_recording_failure(recording, &diagnosis->failure);
    for (int axis = 0; axis < 3; axis++)
        e->ball[axis] = column_of(recording, (const char *[]){"ball_vx", "ball_vy", "ball_vz"}[axis]);
    for (measure_id m = 0; m < MEASURES; m++) {
        e->column[m] = column_of(recording, TABLE[m].name);
        e->id_column[m] = column_of(recording, TABLE[m].id);
        e->other_column[m] = column_of(recording, TABLE[m].other_id);
    }
    rheo_result result = diagnose(e, error);
    free(e);
    return result;
}
