/*
 * Queries of the thickening model: particles and springs (docs/model.md, 2, 3, 6), and the modes of histories. All
 * derivatives have the bits of stage fractional_derivative.
 */
#include "world/model_thickening.h"
#include "world/query_particles.h"

static bool has_history(const rheo_world *w)
{
    return rheo__state_has(&w->state, RHEO__FIELD_history_rows);
}
static bool has_lengths(const rheo_world *w)
{
    return rheo__state_has(&w->state, RHEO__FIELD_history_position);
}

double rheo__thickening_weight(const rheo_world *w, double distance)
{
    /* Rounding may make neighbours of two particles that are a support apart. */
    double weight = 1 - distance / rheo__def_support(&w->def);
    return weight > 0 ? weight : 0;
}

double rheo__thickening_density_share(const rheo_world *w, double distance, double *near_share)
{
    const double weight = rheo__thickening_weight(w, distance);
    *near_share = weight * weight * weight;
    return weight * weight;
}

void rheo__thickening_query_particle(const rheo_world *w, uint32_t id, const uint32_t *neighbour, size_t count,
                                     rheo_particle_state *state)
{
    rheo_real derivative[3] = {0, 0, 0};
    if (has_history(w) && !has_lengths(w))
        rheo__particle_derivative(&w->state, w->model, id, derivative);
    for (size_t axis = 0; axis < 3; axis++)
        state->derivative[axis] = (double)derivative[axis];
    state->material = w->state.material ? w->state.material[id] : 0;
    state->density = rheo__query_density(w, id, neighbour, count, &state->near_density);
    if (w->def.scheme == RHEO_SCHEME_POSITIONS) /* its constraint has no pressures */
        return;
    state->pressure = w->def.fluid.stiffness * (state->density - w->def.fluid.rest_density);
    state->near_pressure = w->def.fluid.near_stiffness * state->near_density;
}

/* |D^q| of the history of a spring; from those of its ends, or from its lengths. */
static rheo_real rate_from(const rheo_world *w, uint32_t a, uint32_t b, const rheo_real of_a[3],
                           const rheo_real of_b[3])
{
    if (has_lengths(w))
        return rheo__length_derivative(&w->state, w->model, a, b);
    return rheo__sqrt(rheo__length2(of_a[0] - of_b[0], of_a[1] - of_b[1], of_a[2] - of_b[2]));
}
static rheo_real rate_of(const rheo_world *w, uint32_t a, uint32_t b)
{
    rheo_real of_a[3] = {0, 0, 0}, of_b[3] = {0, 0, 0};
    if (has_history(w) && !has_lengths(w)) {
        rheo__particle_derivative(&w->state, w->model, a, of_a);
        rheo__particle_derivative(&w->state, w->model, b, of_b);
    }
    return rate_from(w, a, b, of_a, of_b);
}

/* Notes the spring a:b, with |D^q| of its history, that ends at a particle. */
static void note_spring(const rheo_world *w, uint32_t a, uint32_t b, rheo_real rate, rheo_particle_state *state)
{
    const double stiffness = (double)rheo__spring_stiffness(&w->state, w->model, a, b, rate),
                 kappa = (double)rheo__spring_kappa(&w->state, w->model, a, b, rate);
    state->springs++;
    state->stiffness = stiffness > state->stiffness ? stiffness : state->stiffness;
    state->kappa = kappa > state->kappa ? kappa : state->kappa;
}

void rheo__thickening_query_springs(const rheo_world *w, uint32_t id, rheo_particle_state *state)
{
    const rheo__pairs *p = &w->state.springs.pairs;
    if (id >= p->rows) /* added after the last step */
        return;
    const uint32_t rank = p->rank_of[id];
    for (uint32_t i = 0; i < p->rows; i++)
        RHEO__EACH_SPRING(&w->state.springs, i, k)
        {
            const uint32_t partner = rheo__pairs_partner(p, k);
            if (i != rank && partner != rank)
                continue;
            note_spring(w, p->id_of[i], p->id_of[partner], rate_of(w, p->id_of[i], p->id_of[partner]), state);
        }
}

void rheo__thickening_query_all_springs(const rheo_world *w, rheo_particle_state *states)
{
    const rheo__pairs *p = &w->state.springs.pairs;
    for (uint32_t i = 0; i < p->rows; i++)
        RHEO__EACH_SPRING(&w->state.springs, i, k)
        {
            const uint32_t ids[2] = {p->id_of[i], p->id_of[rheo__pairs_partner(p, k)]};
            rheo_particle_state *a = &states[ids[0]], *b = &states[ids[1]];
            rheo_real of_a[3], of_b[3];
            for (size_t axis = 0; axis < 3; axis++) {
                of_a[axis] = (rheo_real)a->derivative[axis];
                of_b[axis] = (rheo_real)b->derivative[axis];
            }
            const rheo_real rate = rate_from(w, ids[0], ids[1], of_a, of_b);
            note_spring(w, ids[0], ids[1], rate, a);
            note_spring(w, ids[0], ids[1], rate, b);
        }
}

rheo_result rheo__thickening_offer_springs(const rheo_world *w, rheo__query_list *l, rheo_error *error)
{
    const rheo_allocator *allocator = &w->def.allocator;
    const rheo__pairs *p = &w->state.springs.pairs;
    rheo_real *derivative = rheo__allocate(allocator, w->state.particles, 3 * sizeof *derivative); /* zeros */
    if (!derivative)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for the fractional derivatives");
    if (has_history(w) && !has_lengths(w))
        rheo__derivatives(&w->state, w->model, derivative);
    for (uint32_t i = 0; i < p->rows; i++)
        RHEO__EACH_SPRING(&w->state.springs, i, k)
        {
            uint32_t a = p->id_of[i], b = p->id_of[rheo__pairs_partner(p, k)];
            const rheo_real rate = rate_from(w, a, b, derivative + 3 * (size_t)a, derivative + 3 * (size_t)b);
            rheo__query_offer(l, (rheo_top_entry){a < b ? a : b, a < b ? b : a,
                                                  (double)rheo__spring_kappa(&w->state, w->model, a, b, rate)});
        }
    rheo__release(allocator, derivative);
    return RHEO_OK;
}

void rheo__thickening_query_spring(const rheo_world *w, uint32_t a, uint32_t b, rheo_spring_state *state)
{
    const rheo__thickening *t = w->model;
    const rheo_real rate = rate_of(w, a, b);
    state->history_rate = (double)rate;
    state->stiffness = (double)rheo__spring_stiffness(&w->state, t, a, b, rate);
    state->kappa = (double)rheo__spring_kappa(&w->state, t, a, b, rate);
}

uint32_t rheo__thickening_query_modes(const rheo_world *w, uint32_t id, rheo_mode_state *modes)
{
    const rheo__state *s = &w->state;
    if (!rheo__state_has(s, RHEO__FIELD_history_modes))
        return 0;
    const rheo__modes *fitted = &rheo__thickening_of(w)->modes;
    const uint32_t first = s->ring.length == 0; /* row of the first mode */
    for (uint32_t k = 0; modes && k < fitted->count; k++) {
        modes[k] = (rheo_mode_state){.decay = (double)fitted->decay[k], .weight = (double)fitted->weight[k]};
        for (size_t axis = 0; axis < 3; axis++) {
            const size_t value = 3 * (size_t)id + axis;
            modes[k].sum[axis] = (double)rheo__ring_value(&s->modes, first + k, value);
            if (k < fitted->slow)
                modes[k].sum[axis] += (double)rheo__ring_value(&s->modes, first + fitted->count + k, value);
        }
    }
    return fitted->count;
}

const rheo_quantity rheo__thickening_quantities[] = {
    RHEO__QUANTITY(position, 3, "L", "position"),
    RHEO__QUANTITY(velocity, 3, "L/T", "velocity"),
    RHEO__QUANTITY(speed, 1, "L/T", "|velocity|"),
    RHEO__QUANTITY(density, 1, "1", "rho, sum over the neighbours of (1 - r/h)^2"),
    RHEO__QUANTITY(near_density, 1, "1", "rho_near, sum over the neighbours of (1 - r/h)^3"),
    RHEO__QUANTITY(pressure, 1, "L/T^2", "k (rho - rho0)"),
    RHEO__QUANTITY(near_pressure, 1, "L/T^2", "k_near rho_near"),
    RHEO__QUANTITY(derivative, 3, "L/T^q",
                   "fractional derivative D^q x from the present history; 0 with history.of length"),
    RHEO__QUANTITY(stiffness, 1, "1/T^2", "largest K of its springs, from the present history"),
    RHEO__QUANTITY(kappa, 1, "1", "largest kappa of its springs, from the present history"),
    {NULL, NULL, NULL, 0, 0},
};

const rheo_ranking rheo__thickening_rankings[] = {
    {RHEO_TOP_DENSEST, "densest", "density", "1", "sum of (1 - r/h)^2"},
    {RHEO_TOP_FASTEST, "fastest", "speed", "L/T", "|velocity|"},
    {RHEO_TOP_STIFFEST, "stiffest", "kappa", "1", "substep^2 K of a spring, from the present history"},
    {0, NULL, NULL, NULL, NULL},
};
