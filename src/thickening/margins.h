/* Margins of the list of stage neighbours (docs/model.md, 1): what a particle needs, and whether a list still lasts. */
#ifndef RHEO__THICKENING_MARGINS_H
#define RHEO__THICKENING_MARGINS_H

#include "core/simd.h"
#include "core/state.h"

/* The widest margin, in supports. */
#define RHEO__MOST_MARGIN 0.125

/* Quantities of a step that all particles need. Motion common to all of them brings no pair together. */
typedef struct rheo__motion {
    rheo_real velocity[3], displacement[3]; /* mean velocity, and mean displacement since the list was made */
    rheo_real fall, step, most;             /* |g| step, a part of the step, and the most that a step may need */
    uint32_t balls;
    /* Positions and squared speeds of balls; they may hit particles within these squared distances. */
    rheo_real ball[RHEO_MAX_BALLS][3], ball2[RHEO_MAX_BALLS], near2[RHEO_MAX_BALLS];
} rheo__motion;

/* Whether no particle can use up its margin in the coming step. A margin of 0 asks for another list. */
typedef bool rheo__list_lasts_function(const rheo__state *s, const rheo__motion *motion);
RHEO__DECLARE_VARIANTS(rheo__list_lasts_function, list_lasts)

/* Sets all margins to what the coming step needs. Returns the largest. */
typedef rheo_real rheo__needs_of_step_function(rheo__state *s, const rheo__motion *motion);
RHEO__DECLARE_VARIANTS(rheo__needs_of_step_function, needs_of_step)

#endif
