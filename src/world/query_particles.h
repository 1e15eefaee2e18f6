/* Queries of particles: declarations shared by query_particles.c and the files of the models. */
#ifndef RHEO__WORLD_QUERY_PARTICLES_H
#define RHEO__WORLD_QUERY_PARTICLES_H

#include "world/world.h"

/* The largest entries so far, as a heap with the smallest of them at its root. */
typedef struct rheo__query_list {
    rheo_top_entry *entry;
    size_t count, capacity;
} rheo__query_list;
void rheo__query_offer(rheo__query_list *list, rheo_top_entry entry);

/* Whether the distance of two particles is below the support, decided as in the neighbour list. */
bool rheo__query_is_neighbour(const rheo_world *world, uint32_t a, uint32_t b);
double rheo__query_distance(const rheo_world *world, uint32_t a, uint32_t b);
/* Both sums of rheo_world_densities(), for a particle with these neighbours. */
double rheo__query_density(const rheo_world *world, uint32_t id, const uint32_t *neighbour, size_t count,
                           double *near_density);
/* Distance of a particle from its start_position. The world has that field. */
double rheo__query_displacement(const rheo_world *world, uint32_t id);

#endif
