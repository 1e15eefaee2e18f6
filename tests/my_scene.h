/* The code that the examples of golden tests guard, in place of yours: a scene, and what a program does to it. */
#ifndef MY_SCENE_H
#define MY_SCENE_H

#include <rheolog/rheolog.h>

enum { MY_SCENE_STEPS = 60 };

/* A ball that falls into a heap of fluid on a floor. */
rheo_result my_scene_create(rheo_world **world, rheo_error *error);

/* What the program does before each step: it kicks the ball once, and later tilts the floor. */
rheo_result my_scene_act(rheo_world *world, rheo_error *error);

#endif
