/*
 * Examines the steps of a run by the measures of its world (world/measure.h): while it settles, while it runs, and when
 * its recording is read. A caller gives the metrics of each step, and the examination says which measures are out of
 * range, since when, how far, and where.
 */
#ifndef RHEO__WORLD_EXAMINATION_H
#define RHEO__WORLD_EXAMINATION_H

#include "world/measure.h"

typedef struct rheo__examination {
    rheo_allocator allocator;
    const rheo__measures *measures;
    rheo__metric_name *names;
    double *values; /* metrics of the step and of the one before, which change places */
    int column[RHEO_MAX_FINDINGS], id_column[RHEO_MAX_FINDINGS], other_column[RHEO_MAX_FINDINGS]; /* -1: not there */
    uint32_t particles;                                                                           /* of a world */

    /* ---- The step that was examined last ---- */

    rheo__observation observation; /* the caller sets def, begins, unfinished and added before rheo__examine() */
    uint64_t step;
    bool started; /* a step was examined */
    bool measured[RHEO_MAX_FINDINGS];
    double value[RHEO_MAX_FINDINGS]; /* of those that were measured */
    bool severe;                     /* a severe measure is out of range */

    /* ---- All steps so far ---- */

    rheo_finding
        last[RHEO_MAX_FINDINGS]; /* each measure when it was measured last, in range or not; steps is 0: never */
    rheo_finding finding[RHEO_MAX_FINDINGS]; /* steps is 0: never out of range */
    bool unhealthy;
    rheo_finding first; /* the first severe measure that left its range */
    /* The first state, which no examined step led to, has a measure out of range that leads up to failures. */
    bool ill_start;
    rheo_finding start; /* a severe one, or else the first */
} rheo__examination;

/*
 * Begins without a step. The caller fills in `names`, of `count` metrics, and calls rheo__examination_find_columns().
 * False: no memory.
 */
bool rheo__examination_begin(rheo__examination *x, const rheo_allocator *allocator, const rheo_world_def *def,
                             uint32_t features, uint32_t count);
void rheo__examination_find_columns(rheo__examination *x);
/* Begins with the metrics of a world, and without a step. False: no memory. */
bool rheo__examination_begin_world(rheo__examination *x, const rheo_allocator *allocator, const rheo_world *world);
void rheo__examination_end(rheo__examination *x);

/* Where the caller puts the metrics of the next step. */
double *rheo__examination_next(rheo__examination *x);
/* Examines the step whose metrics were put there. */
void rheo__examine(rheo__examination *x, uint64_t step);
/* Examines the present state of a world. */
void rheo__examine_world(rheo__examination *x, const rheo_world *world);

/*
 * Finding of a measure that was measured in this step. Of a measure without a particle, the particle is the one that
 * the measure `seen` has.
 */
rheo_finding rheo__examination_finding(const rheo__examination *x, uint32_t measure, double limit);
/* Sets the particle of a finding to that of the measure `seen`, as it was measured last. */
void rheo__examination_show(const rheo__examination *x, uint32_t measure, rheo_finding *finding);

/* Sets the particle of a finding to that of another. */
void rheo__finding_place(rheo_finding *finding, const rheo_finding *from);

#endif
