/* Looking closer at a world: what look.c and the files of the models share. */
#ifndef RHEO__WORLD_LOOK_H
#define RHEO__WORLD_LOOK_H

#include "world/world.h"

/* The largest entries so far, as a heap: the one that is left out next is at its root. */
typedef struct rheo__query_list {
    rheo_top_entry *entry;
    size_t count, capacity;
} rheo__query_list;
void rheo__query_offer(rheo__query_list *list, rheo_top_entry entry);

bool rheo__query_is_neighbour(const rheo_world *world, uint32_t a, uint32_t b);
double rheo__query_distance(const rheo_world *world, uint32_t a, uint32_t b);
/* How far a particle of a world that melts is from where it began. */
double rheo__query_displacement(const rheo_world *world, uint32_t id);

/* What the model has of a particle; all that both have is there already. */
void rheo__query_thickening(const rheo_world *world, uint32_t id, rheo_particle_state *state);
void rheo__query_melting(const rheo_world *world, uint32_t id, rheo_particle_state *state);

/* The weight of a pair, and its share in rho, and in rho_near. */
double rheo__query_thickening_weight(const rheo_world *world, double distance);
double rheo__query_thickening_share(const rheo_world *world, double distance, double *near_share);
/* Summation densities: what a particle has of itself, of a partner, and of the walls. */
double rheo__query_melting_weight(const rheo_world *world, double distance);
double rheo__query_melting_own(const rheo_world *world);
double rheo__query_melting_share(const rheo_world *world, double distance);
double rheo__query_melting_walls(const rheo_world *world, uint32_t id);

rheo_result rheo__query_offer_springs(const rheo_world *world, rheo__query_list *list, rheo_error *error);

#endif
