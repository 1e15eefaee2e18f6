/*
 * Members: runs of one recording that begin with slightly other positions, as a seed says. Their metrics show how much of a
 * result is chance. Where a run amplifies rounding, positions are moved by one unit in the last place; elsewhere rounding
 * would stay rounding, so they are moved by a part of the spacing: as if the fluid had been filled in once more. A golden
 * recording can hold the members of the program that made it (MEMB).
 */
#ifndef RHEO__RECORD_MEMBERS_H
#define RHEO__RECORD_MEMBERS_H

#include "record/rank_test.h"
#include "record/recording.h"
#include "record/same.h"

_Static_assert((int)RHEO_MOST_SAME_MEMBERS <= (int)RHEO__RANK_MOST, "their ranks have a place");

enum {
    RHEO__MEMBER_VALUES = 1024, /* most values of a member */
    RHEO__MEMBER_PARTS = 4,     /* equal parts of a run; the values of the first one show only how the spread grows */
};

/* What is measured of a metric. The numbers are those of the file. */
typedef enum rheo__member_kind {
    RHEO__MEMBER_MEAN = 0, /* its mean over the steps from + 1 to `to` */
    RHEO__MEMBER_PASSES,   /* the first step, with a fraction, at which it passes `level` */
    RHEO__MEMBER_LEAST,    /* the step of its least value */
    RHEO__MEMBER_LARGEST,  /* the step of its largest value */
    RHEO__MEMBER_KINDS
} rheo__member_kind;

typedef struct rheo__member_value {
    char metric[64];
    rheo__member_kind kind;
    uint64_t from, to;
    double level;
    double counts; /* differences of means up to this are none: rounding of a run without chaos has as much */
} rheo__member_value;

typedef struct rheo__members {
    uint64_t seed; /* of the first member; the next ones count on */
    double moved;  /* largest move of a coordinate in spacings; 0: one unit in the last place */
    uint32_t count, values;
    rheo__member_value *value; /* values */
    double *result;            /* result[i * count + k] is value i of member k */
    char build[256];           /* that made them */
} rheo__members;

/* Their contents. */
void rheo__members_release(rheo__members *members);
/*
 * Makes the members of a recording that this build reproduces: chooses their values and how far they are moved, and runs
 * them.
 */
rheo_result rheo__members_make(rheo_recording *r, uint32_t count, uint64_t seed, rheo__members *members,
                               rheo_error *error);
/* Room for other members with the same values. */
rheo_result rheo__members_like(const rheo__members *from, uint32_t count, uint64_t seed, rheo__members *members,
                               rheo_error *error);
/*
 * Runs all members with this build, from the first keyframe of the recording and with its commands. `options`, for the
 * parameters that are set, may be NULL. RHEO_ERROR_STATE: one of them goes bad.
 */
rheo_result rheo__members_run(rheo_recording *r, const rheo_same_options *options, rheo__members *members,
                              rheo_error *error);

/* ---- Their chunk (record/members_file.c) ---- */

rheo_result rheo__members_write(rheo__writer *writer, const rheo__members *members, rheo_error *error);

#endif
