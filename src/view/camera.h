/* Camera and floors of pictures and of scenes for POV-Ray. */
#ifndef RHEO__VIEW_CAMERA_H
#define RHEO__VIEW_CAMERA_H

#include "rheolog/view.h"

/* It looks from the eye to the centre. The three directions are unit vectors at right angles. */
typedef struct rheo__camera {
    double centre[3], eye[3], forward[3], aside[3], up[3];
    double size; /* half the diagonal of the extent */
} rheo__camera;

/*
 * Chooses the distance of the eye so that the picture contains every corner of the extent. The slopes are half the
 * width and half the height of the picture at distance 1.
 */
rheo__camera rheo__camera_for(const rheo_extent *extent, double slope_aside, double slope_up);

/*
 * Whether a wall is drawn as a floor: its unit normal has y > 0.5, while other walls would hide the fluid. The floor is the
 * plane normal * x = *offset.
 */
bool rheo__is_floor(const rheo_world_def *def, uint32_t wall, double normal[3], double *offset);

#endif
