/* Arrays of scenes. */
#ifndef RHEO__SCENES_ARRAYS_H
#define RHEO__SCENES_ARRAYS_H

#include "rheolog/scene.h"

/* Allocates the arrays of an empty scene. The rooms are powers of two. False: no memory; release the scene. */
bool rheo__scene_reserve(rheo_scene *scene, uint32_t fills, uint32_t walls, uint32_t vibrators);

#endif
