/* Weights of the history term: one of them, for callers that need only some; and checks of curves. */
#ifndef RHEO__THICKENING_WEIGHTS_H
#define RHEO__THICKENING_WEIGHTS_H

#include "rheolog/history.h"

/* c_m or b_m, by the series of memory_weights.c; 0 < q < 1. */
double rheo__memory_weight(double q, size_t lag, rheo_weights kind);

/* Refuses a curve; and one point of it, whose predecessors are good. */
rheo_result rheo__curve_check(const rheo_curve_point *curve, size_t points, double step, rheo_error *error);
rheo_result rheo__curve_check_point(const rheo_curve_point *curve, size_t index, rheo_error *error);

#endif
