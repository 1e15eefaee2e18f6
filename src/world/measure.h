/*
 * Measures, which `rheolog doctor` examines. A measure is a metric, or a number computed from metrics and parameters,
 * with the largest value that is in range. A model lists its measures as rows; world/examination.h has the engine that
 * reads them. docs/debugging.md explains every measure and how its limits were found.
 */
#ifndef RHEO__WORLD_MEASURE_H
#define RHEO__WORLD_MEASURE_H

#include "rheolog/record.h"
#include "world/world.h"

typedef enum rheo__measure_kind {
    RHEO__NOTICE,    /* reported, never a cause */
    RHEO__PRECURSOR, /* occurs in healthy runs too; a cause if it leads up to a severe measure or a failed step */
    RHEO__SEVERE,    /* makes a run unhealthy */
    RHEO__CONDITION, /* a number of the parameters; beyond `certain` it is the cause, even if others show first */
} rheo__measure_kind;

typedef struct rheo__metric_name {
    char text[48];
} rheo__metric_name;

/* One step of a recording, as a measure sees it. */
typedef struct rheo__observation {
    const rheo_world_def *def; /* definition in force in the step; of the first state, in the step that follows */
    uint32_t features;         /* of the recorded world */
    const rheo__metric_name *names;
    const double *now;    /* metrics of the step, in the order of `names` */
    const double *before; /* metrics of the step before; NULL at the first step */
    uint32_t count;
    bool begins;     /* the first state of a recording: the steps that made it may have had other parameters */
    bool unfinished; /* the step failed: metrics that its stages did not reach are those of the step before */
    bool added;      /* a command added particles, which have speeds of their own */
} rheo__observation;

/* An unhealthy run, for which advice is sought. */
typedef struct rheo__case {
    rheo_diagnosis *diagnosis; /* cause and failure are set; advice is appended */
    const rheo_world_def *def; /* definition in force when the run became unhealthy */
    const rheo__metric_name *names;
    const double *largest; /* largest value of every metric, up to the unhealthy step */
    uint32_t count;
    const struct rheo__measures *measures;
    const double *episode; /* largest value of every measure since the precursors began, at least 0 */
} rheo__case;

typedef struct rheo__measure {
    const char *name; /* of the measure, and of the metric that holds its value, if there is one */
    rheo__measure_kind kind;
    double limit;   /* largest value in range */
    double certain; /* CONDITION: second limit */
    const char *stage;
    const char *id, *other_id; /* metrics with the particle, or the ends of the spring; NULL: none */
    const char *meaning;
    /* Of a number that no particle has: the measure whose particle shows it, or, with `id`, the metric of that particle. */
    const char *seen;
    /* Computes the value. False: it is not recorded or has no meaning in this step. NULL: it is the metric. */
    bool (*value)(const rheo__observation *observation, double *value);
    /* Appends advice for a run with this cause. NULL: the advice of the list. */
    void (*advise)(rheo__case *c);
} rheo__measure;

/* The measures of a model. Among measures that leave their range in the same step, the first row is the cause. */
typedef struct rheo__measures {
    const rheo__measure *row;
    uint32_t count; /* <= RHEO_MAX_FINDINGS */
    /* Appends advice where the cause has none of its own, or no measure was out of range. */
    void (*advise)(rheo__case *c);
} rheo__measures;

/* The measures of a world's model; of a model that lists none, those that have a meaning in any model. */
const rheo__measures *rheo__measures_of(const rheo_world_def *def);
/* Index of a measure; `count` if the list does not have it. */
uint32_t rheo__measure_index(const rheo__measures *measures, const char *name);
/* Index of a metric, or -1. */
int rheo__metric_index(const rheo__metric_name *names, uint32_t count, const char *name);

/* ---- For value() ---- */

/* A metric of the step. False: it is not recorded. */
bool rheo__observed(const rheo__observation *observation, const char *metric, double *value);
/*
 * The rise of max_speed in a step. False where it has no meaning: in the first step, in an unfinished one, after a
 * command that added particles, and below half of the speed before, since far away positions are coarse, and so are
 * the speeds computed from them.
 */
bool rheo__observed_speed_rise(const rheo__observation *observation, double *rise);

/* ---- For advise() ---- */

/* Largest value of a metric up to the unhealthy step; 0 if it is not recorded. */
double rheo__case_metric(const rheo__case *c, const char *metric);
/* Largest value of a measure since the precursors began; 0 if it was not measured. */
double rheo__case_measure(const rheo__case *c, const char *measure);
/* Advises to set a parameter to a value, rounded down to two digits; nothing for a value that it cannot have. */
void rheo__advise(rheo__case *c, const char *path, double value, const char *text);
/* Advises `set`, "springs.solver=implicit", or "" where no parameter helps. */
void rheo__advise_words(rheo__case *c, const char *set, const char *text);
/*
 * For a cause that shows in the first recorded step of a scene: the advice so far is to be followed when the scene is
 * made again, because its first state was made with the parameters that are ill.
 */
void rheo__advise_making(rheo__case *c);
/* Advises half the step. */
void rheo__advise_half_step(rheo__case *c);
/* Advises a step in which the fastest particle moves a quarter of a support. The cause is its way in a step. */
void rheo__advise_runaway(rheo__case *c);

/* ---- Before the first step (world/conditions.c) ---- */

/* A measure that a definition and the first speeds put out of range. */
typedef struct rheo__condition {
    const rheo__measure *measure;
    double value;
    double limit; /* the second limit if the value is beyond it */
    bool certain; /* it is */
    uint32_t advice_count;
    rheo_advice advice[RHEO_MAX_ADVICE]; /* most effective first */
} rheo__condition;

/* Largest speeds that are known before a run: of the particles, and of the ball beyond ball.velocity. */
typedef struct rheo__known_speeds {
    double fluid, ball;
} rheo__known_speeds;

/*
 * Examines a measure of a valid definition, by the index of its row. The step is taken to have as many substeps as it
 * may have. False: the measure is in range, or does not follow from these numbers.
 */
bool rheo__condition_of(const rheo_world_def *def, rheo__known_speeds speeds, uint32_t row,
                        rheo__condition *condition);
/* Writes it as a sentence. */
void rheo__condition_tell(const rheo__condition *condition, char *text, size_t size);

/* ---- Rows for any model ---- */

bool rheo__measure_speed_jump(const rheo__observation *observation, double *value);
bool rheo__measure_runaway_speed(const rheo__observation *observation, double *value);

#define RHEO__MEASURE_SPEED_JUMP(of_stage)                                                                        \
    {                                                                                                             \
        .name = "speed_jump", .kind = RHEO__SEVERE, .limit = 1, .stage = of_stage, .id = "max_speed_id",          \
        .value = rheo__measure_speed_jump, .meaning = "rise of the largest speed in a step, in supports per step" \
    }
/*
 * A state that blew up while it was made may be so thin that nothing throws its particles any more, so that only their
 * speed shows it. Free fall is no illness: at this speed it has lasted so long that floats no longer resolve a support.
 */
#define RHEO__MEASURE_RUNAWAY_SPEED(of_stage)                                                                  \
    {                                                                                                          \
        .name = "runaway_speed", .kind = RHEO__SEVERE, .limit = 1000, .stage = of_stage, .id = "max_speed_id", \
        .value = rheo__measure_runaway_speed, .advise = rheo__advise_runaway,                                  \
        .meaning = "how far the fastest particle moves in a step, in supports"                                 \
    }
/* A first state under a pressure that no state bears, and that moves: it blew up while it was made. */
#define RHEO__MEASURE_START_SPEED(of_stage)                                                                 \
    {                                                                                                       \
        .name = "start_speed", .kind = RHEO__SEVERE, .limit = 0.5, .stage = of_stage, .id = "max_speed_id", \
        .value = start_speed, .advise = rheo__advise_runaway,                                               \
        .meaning = "how far the fastest particle moves in the first step, in supports"                      \
    }
#define RHEO__MEASURE_COURANT_NUMBER(of_stage)                                                                 \
    {                                                                                                          \
        .name = "courant_number", .kind = RHEO__NOTICE, .limit = 0.5, .stage = of_stage, .id = "max_speed_id", \
        .meaning = "how far the fastest particle moves in a step, in supports"                                 \
    }

static inline double rheo__larger(double a, double b)
{
    return a >= b || b != b ? a : b;
}
static inline double rheo__smaller(double a, double b)
{
    return a <= b || b != b ? a : b;
}

#endif
