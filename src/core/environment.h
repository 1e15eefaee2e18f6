/* Checks of the floating-point environment, on which reproducible bits depend. */
#ifndef RHEO__CORE_ENVIRONMENT_H
#define RHEO__CORE_ENVIRONMENT_H

#include "rheolog/base.h"

/*
 * Checks that arithmetic rounds to nearest, keeps denormals, uses no wider type and contracts nothing. Otherwise
 * RHEO_ERROR_ENVIRONMENT.
 */
rheo_result rheo__check_environment(rheo_error *error);

#endif
