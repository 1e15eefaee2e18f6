/* Camera and floors of pictures and of scenes for POV-Ray. */
#ifndef RHEO__VIEW_CAMERA_H
#define RHEO__VIEW_CAMERA_H

#include "core/error.h"
#include "rheolog/view.h"

/* The centre is that of the extent. The three directions are unit vectors at right angles. */
typedef struct rheo__camera {
    double centre[3], eye[3], forward[3], aside[3], up[3];
    double turn[2]; /* cosine and sine of how far it is turned around y from the default direction */
    double size;    /* half the diagonal of the extent */
    double lens;    /* the slopes of the picture are so many times those that were asked for */
} rheo__camera;

/*
 * Chooses the distance of the eye so that the picture contains every corner of the extent, unless `how` makes it larger;
 * NULL: the default camera. The slopes are half the width and half the height of the picture at distance 1.
 */
rheo__camera rheo__camera_for(const rheo_extent *extent, const rheo_camera *how, double slope_aside, double slope_up);
/* Refuses numbers that are out of range. */
rheo_result rheo__camera_check(const rheo_camera *how, rheo_error *error);

/*
 * Whether a wall is drawn as a floor: its unit normal has y > 0.5, while other walls would hide the fluid. The floor is the
 * plane normal * x = *offset.
 */
bool rheo__is_floor(const rheo_world_def *def, uint32_t wall, double normal[3], double *offset);

#endif
