/* Looking closer at a world of the thickening model (world/query.c): docs/model.md, 5 to 7. */
#include "world/model_thickening.h"
#include "world/query.h"

double rheo__query_thickening_weight(const rheo_world *w, double distance)
{
    /* Not below 0 where rounding makes neighbours of two that are a support apart. */
    double weight = 1 - distance / rheo__def_support(&w->def);
    return weight > 0 ? weight : 0;
}

double rheo__query_thickening_share(const rheo_world *w, double distance, double *near_share)
{
    const double of = rheo__query_thickening_weight(w, distance);
    *near_share = of * of * of;
    return of * of;
}

static uint32_t springs_of(const rheo_world *w, uint32_t id)
{
    const rheo__pairs *p = &w->state.springs.pairs;
    if (id >= p->rows) /* added after the last step */
        return 0;
    uint32_t rank = p->rank_of[id], count = p->start[rank + 1] - p->start[rank];
    for (uint32_t k = 0; k < p->start[rank]; k++) /* rows of lower ranks */
        count += p->partner[k] == rank;
    return count;
}

void rheo__query_thickening(const rheo_world *w, uint32_t id, rheo_particle_state *state)
{
    rheo_real derivative[3] = {0, 0, 0};
    if (w->features & RHEO__FEATURE_HISTORY)
        rheo__particle_derivative(&w->state, rheo__thickening_of(w), id, derivative);
    for (size_t axis = 0; axis < 3; axis++)
        state->derivative[axis] = (double)derivative[axis];
    state->springs = springs_of(w, id);
    for (uint32_t other = 0; other < w->state.particles; other++) {
        if (!rheo__query_is_neighbour(w, id, other))
            continue;
        double near_share;
        state->density += rheo__query_thickening_share(w, rheo__query_distance(w, id, other), &near_share);
        state->near_density += near_share;
    }
    state->pressure = w->def.fluid.stiffness * (state->density - w->def.fluid.rest_density);
    state->near_pressure = w->def.fluid.near_stiffness * state->near_density;
}

rheo_result rheo__query_offer_springs(const rheo_world *w, rheo__query_list *l, rheo_error *error)
{
    const rheo_allocator *allocator = &w->def.allocator;
    const rheo__pairs *p = &w->state.springs.pairs;
    rheo_real *derivative = rheo__allocate(allocator, w->state.particles, 3 * sizeof *derivative); /* zeros */
    if (!derivative)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for the fractional derivatives");
    if (w->features & RHEO__FEATURE_HISTORY)
        rheo__derivatives(&w->state, rheo__thickening_of(w), derivative);
    for (uint32_t i = 0; i < p->rows; i++)
        for (uint32_t k = p->start[i]; k < p->start[i + 1]; k++) {
            uint32_t a = p->id_of[i], b = p->id_of[p->partner[k]];
            rheo_real d[3];
            for (size_t axis = 0; axis < 3; axis++)
                d[axis] = derivative[3 * (size_t)a + axis] - derivative[3 * (size_t)b + axis];
            rheo__query_offer(l, (rheo_top_entry){a < b ? a : b, a < b ? b : a,
                                                  (double)rheo__spring_kappa(rheo__thickening_of(w), d)});
        }
    rheo__release(allocator, derivative);
    return RHEO_OK;
}
