/* Looking closer at a world: what look.c and the files of the models share. */
#ifndef RHEO_WORLD_LOOK_H
#define RHEO_WORLD_LOOK_H

#include "world/world.h"

/* The largest entries so far, as a heap: the one that is left out next is at its root. */
typedef struct rheo_look_list {
    rheo_top_entry *entry;
    size_t count, capacity;
} rheo_look_list;
void rheo_look_offer(rheo_look_list *list, rheo_top_entry entry);

bool rheo_look_is_neighbour(const rheo_world *world, uint32_t a, uint32_t b);
double rheo_look_distance(const rheo_world *world, uint32_t a, uint32_t b);
/* How far a particle of a world that melts is from where it began. */
double rheo_look_displacement(const rheo_world *world, uint32_t id);

/* What the model has of a particle; all that both have is there already. */
void rheo_look_thickening(const rheo_world *world, uint32_t id, rheo_particle_state *state);
void rheo_look_melting(const rheo_world *world, uint32_t id, rheo_particle_state *state);

/* The weight of a pair, and its share in rho, and in rho_near. */
double rheo_look_thickening_weight(const rheo_world *world, double distance);
double rheo_look_thickening_share(const rheo_world *world, double distance, double *near_share);
/* Summation densities: what a particle has of itself, of a partner, and of the walls. */
double rheo_look_melting_weight(const rheo_world *world, double distance);
double rheo_look_melting_own(const rheo_world *world);
double rheo_look_melting_share(const rheo_world *world, double distance);
double rheo_look_melting_walls(const rheo_world *world, uint32_t id);

rheo_result rheo_look_offer_springs(const rheo_world *world, rheo_look_list *list, rheo_error *error);

#endif
