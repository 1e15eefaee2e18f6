/* The thickening model of a world: for the files of this folder that know the model, and for tests. */
#ifndef RHEO__WORLD_MODEL_THICKENING_H
#define RHEO__WORLD_MODEL_THICKENING_H

#include "thickening/thickening.h"
#include "world/measure.h"
#include "world/model.h"

extern const rheo__model_type rheo__model_thickening;
extern const rheo__measures rheo__measures_summed, rheo__measures_sequential, rheo__measures_positions;
/* Values of measures of several schemes. */
bool rheo__measure_ball_speed(const rheo__observation *observation, double *value);
bool rheo__measure_ball_stop(const rheo__observation *observation, double *value);
/* How far vibrators move the fluid in a step, in supports; of schemes without substeps. */
bool rheo__measure_vibrator_step(const rheo__observation *observation, double *value);
bool rheo__measure_energy_jump(const rheo__observation *observation, double *value);

/* NULL if the world has another model. */
static inline rheo__thickening *rheo__thickening_of(const rheo_world *world)
{
    return world->type == &rheo__model_thickening ? world->model : NULL;
}

/* Queries (world/query_thickening.c); see rheo__model_type. */
double rheo__thickening_weight(const rheo_world *world, double distance);
double rheo__thickening_density_share(const rheo_world *world, double distance, double *near_share);
void rheo__thickening_query_particle(const rheo_world *world, uint32_t id, const uint32_t *neighbour, size_t count,
                                     rheo_particle_state *state);
void rheo__thickening_query_springs(const rheo_world *world, uint32_t id, rheo_particle_state *state);
void rheo__thickening_query_all_springs(const rheo_world *world, rheo_particle_state *states);
rheo_result rheo__thickening_offer_springs(const rheo_world *world, struct rheo__query_list *list, rheo_error *error);
void rheo__thickening_query_spring(const rheo_world *world, uint32_t a, uint32_t b, rheo_spring_state *state);
uint32_t rheo__thickening_query_modes(const rheo_world *world, uint32_t id, rheo_mode_state *modes);
extern const rheo_quantity rheo__thickening_quantities[];
extern const rheo_ranking rheo__thickening_rankings[];

/* Numbers that follow from a definition (world/derived_thickening.c). */
enum { RHEO__THICKENING_DERIVED = 15 };
extern const rheo__derived_number rheo__thickening_derived[RHEO__THICKENING_DERIVED];
/* Sum of kappa over the springs of a particle in fluid at rest, for a substep of this duration. */
double rheo__stiffness_sum_at_rest(const rheo_world_def *def, double substep);

/* rheo__model_type.foresee (world/preflight_thickening.c). */
void rheo__thickening_foresee(const rheo_world_def *def, const rheo__start *start, struct rheo_preflight *preflight);
/* Substeps of a step while the fluid rests (world/preflight_thickening.c). */
double rheo__thickening_substeps_at_rest(const rheo_world_def *def);
/* Warns through def->log of parameters that are set without effect (world/idle_thickening.c). */
void rheo__thickening_warn_of_idle(const rheo_world_def *def);

/* rheo__model_type.check, .warn and .most_substeps (world/check_thickening.c); only scheme summed has several substeps. */
rheo_result rheo__thickening_check(const rheo_world_def *def, rheo_error *error);
void rheo__thickening_warn(const rheo_world_def *def);
double rheo__thickening_most_substeps(const rheo_world_def *def);
bool rheo__thickening_has_plates(const rheo_world_def *def);
/* Largest speed of an upper plate whose velocity is given. */
double rheo__thickening_plate_speed(const rheo_world_def *def);

#endif
