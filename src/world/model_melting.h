/* The melting model of a world: for the files of this folder that know the model, and for tests. */
#ifndef RHEO__WORLD_MODEL_MELTING_H
#define RHEO__WORLD_MODEL_MELTING_H

#include "melting/melting.h"
#include "world/measure.h"
#include "world/model.h"

/* Marks the features of this model's worlds; recordings store it. */
enum { RHEO__FEATURE_MELTING = 256 };

extern const rheo__model_type rheo__model_melting;
/* rheo__model_type.foresee (world/preflight_melting.c). */
void rheo__melting_foresee(const rheo_world_def *def, const rheo__start *start, struct rheo_preflight *preflight);
const rheo__measures *rheo__measures_melting(const rheo_world_def *def);

/* NULL if the world has another model. */
static inline rheo__melting *rheo__melting_of(const rheo_world *world)
{
    return world->type == &rheo__model_melting ? world->model : NULL;
}

/* Queries (world/query_melting.c); see rheo__model_type. */
double rheo__melting_weight(const rheo_world *world, double distance);
double rheo__melting_density_share(const rheo_world *world, double distance, double *near_share);
double rheo__melting_wall_density(const rheo_world *world, uint32_t id);
void rheo__melting_query_particle(const rheo_world *world, uint32_t id, const uint32_t *neighbour, size_t count,
                                  rheo_particle_state *state);
extern const rheo_quantity rheo__melting_quantities[];
extern const rheo_ranking rheo__melting_rankings[];

#endif
