/* One weight of the history term, for callers that need only some. */
#ifndef RHEO__THICKENING_WEIGHTS_H
#define RHEO__THICKENING_WEIGHTS_H

#include "rheolog/history.h"

/* c_m or b_m, by the series of memory_weights.c; 0 < q < 1. */
double rheo__memory_weight(double q, size_t lag, rheo_weights kind);

#endif
