/* The floating-point environment that the same bits everywhere rest on. */
#ifndef RHEO__CORE_ENVIRONMENT_H
#define RHEO__CORE_ENVIRONMENT_H

#include "rheolog/base.h"

/* Rounds to nearest, keeps denormals, evaluates in the type itself, contracts nothing: RHEO_OK, or says what is off.
 */
rheo_result rheo__check_environment(rheo_error *error);

#endif
