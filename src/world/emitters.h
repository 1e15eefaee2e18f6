/* The openings of emitters: their lattices, and their rates. */
#ifndef RHEO__WORLD_EMITTERS_H
#define RHEO__WORLD_EMITTERS_H

#include "rheolog/world.h"

/* The lattice of an opening. Site (i, j), 0 <= i < count[0], 0 <= j < count[1], may be outside of a disc. */
typedef struct rheo__opening {
    double direction[3], axis[2][3]; /* unit vectors */
    uint32_t count[2];
    double spacing;
    double radius2; /* of a disc, in spacings, squared; negative: a rectangle */
} rheo__opening;

/* The opening of a valid emitter. */
rheo__opening rheo__emitter_opening(const rheo_world_def *def, const rheo_emitter *emitter);
/* Place of a site relative to the centre, along both axes, L. False: it is outside of the disc. */
bool rheo__opening_site(const rheo__opening *opening, uint32_t i, uint32_t j, double place[2]);
uint64_t rheo__opening_sites(const rheo__opening *opening);
/* Distance along a unit vector from the centre to the site that is farthest in its direction, at most; L. */
double rheo__opening_reach(const rheo__opening *opening, const double along[3]);

/* Whether an emitter gives its particles a temperature. */
bool rheo__emitter_has_temperature(const rheo_emitter *emitter);
/* Particles that all emitters emit until a time if nothing holds them back. */
double rheo__emitted_until(const rheo_world_def *def, double time);
/* Checks the emitters of a definition whose parameters are in range. */
rheo_result rheo__emitters_check(const rheo_world_def *def, rheo_error *error);

#endif
