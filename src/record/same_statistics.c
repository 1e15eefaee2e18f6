/* Rung statistics (record/same.h). */
#include "record/same.h"

rheo_result rheo__same_statistics(rheo_recording *golden, const rheo_same_options *options,
                                  rheo_same_statistics *result, rheo_error *error)
{
    *result = (rheo_same_statistics){0};
    (void)golden, (void)options;
    return rheo__fail(error, RHEO_ERROR_UNSUPPORTED, "this build cannot compare statistics");
}
