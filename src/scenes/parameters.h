/* Parameters that only the making of a scene knows. */
#ifndef RHEO__SCENES_PARAMETERS_H
#define RHEO__SCENES_PARAMETERS_H

#include "rheolog/scene.h"

void rheo__scene_set_defaults(rheo_scene *scene);
/* Refuses what is out of its range, or set although the scene's model does not have it. */
rheo_result rheo__scene_parameters_check(const rheo_scene *scene, rheo_error *error);

#endif
