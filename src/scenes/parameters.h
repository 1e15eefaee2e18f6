/* Parameters that are used only to create a scene. */
#ifndef RHEO__SCENES_PARAMETERS_H
#define RHEO__SCENES_PARAMETERS_H

#include "rheolog/scene.h"

void rheo__scene_set_defaults(rheo_scene *scene);
/* Refuses parameters that are out of range, or changed although the scene's model does not have them. */
rheo_result rheo__scene_parameters_check(const rheo_scene *scene, rheo_error *error);

#endif
