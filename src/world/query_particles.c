/*
 * Queries of particles, computed from the present state as its stages would find it. They keep nothing and change
 * nothing, so they also work in the middle of a step. Parts that depend on the model are in query_MODEL.c.
 *
 * Neighbours are decided in the number type of the state, as in the neighbour list; distances and sums are in double.
 * Sums run over the neighbours by ascending id, so that one particle and all particles get the same bits.
 */
#include "world/query_particles.h"

#include "space/neighbours.h"
#include "world/model.h"

/* ---- Neighbours and densities ---- */

bool rheo__query_is_neighbour(const rheo_world *w, uint32_t a, uint32_t b)
{
    const rheo_real *xa = w->state.position + 3 * (size_t)a, *xb = w->state.position + 3 * (size_t)b;
    rheo_real support = (rheo_real)rheo__def_support(&w->def);
    return a != b && rheo__period_distance2(&w->period, xa, xb) < support * support;
}

/* Distance of two particles, or of one from the nearest image of the other. */
static double length_between(const rheo__period *period, const rheo_real *xa, const rheo_real *xb)
{
    double r2 = 0;
    for (int axis = 0; axis < 3; axis++) {
        double d = (double)xb[axis] - (double)xa[axis];
        if (period && period->length[axis] > 0)
            d -= rheo__periods_away(d, period->length[axis]) * (double)period->length[axis];
        r2 += d * d;
    }
    return __builtin_sqrt(r2);
}

double rheo__query_distance(const rheo_world *w, uint32_t a, uint32_t b)
{
    return length_between(&w->period, w->state.position + 3 * (size_t)a, w->state.position + 3 * (size_t)b);
}

double rheo__query_displacement(const rheo_world *w, uint32_t id)
{
    return length_between(NULL, w->state.start_position + 3 * (size_t)id, w->state.position + 3 * (size_t)id);
}

double rheo_world_weight(const rheo_world *w, double distance)
{
    return w->type->weight ? w->type->weight(w, distance) : 0;
}

const char *rheo_world_weight_name(const rheo_world *w)
{
    return w->type->weight_name;
}

static rheo_result check_id(const rheo_world *w, uint32_t id, rheo_error *error)
{
    if (id < w->state.particles)
        return RHEO_OK;
    if (w->state.particles == 0)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "there is no particle %u; the world has none", id);
    return rheo__fail(error, RHEO_ERROR_ARGUMENT, "there is no particle %u; ids go from 0 to %u", id,
                      w->state.particles - 1);
}

rheo_result rheo_world_neighbours(const rheo_world *w, uint32_t id, uint32_t *ids, double *distances, size_t capacity,
                                  size_t *count, rheo_error *error)
{
    RHEO__TRY(check_id(w, id, error));
    size_t found = 0;
    for (uint32_t other = 0; other < w->state.particles; other++) {
        if (!rheo__query_is_neighbour(w, id, other))
            continue;
        if (ids && found < capacity)
            ids[found] = other;
        if (distances && found < capacity)
            distances[found] = rheo__query_distance(w, id, other);
        found++;
    }
    *count = found;
    return RHEO_OK;
}

/* The neighbours of all particles, by ascending id: those of `id` are neighbour[start[id]] .. neighbour[start[id + 1] - 1]. */
typedef struct all_neighbours {
    size_t *start;
    uint32_t *neighbour;
} all_neighbours;

static void release_neighbours(const rheo_world *w, all_neighbours *all)
{
    rheo__release(&w->def.allocator, all->start);
    rheo__release(&w->def.allocator, all->neighbour);
}

/* The rank of a partner; in periodic space it may be an image. */
static uint32_t particle_of(const rheo__neighbours *list, const rheo__pairs *pairs, uint32_t partner)
{
    return partner < pairs->rows ? partner : list->image[partner - pairs->rows].at.home;
}

/* Rows of a list have another order. Visited by ascending id, a particle is appended to the lists of its neighbours. */
static void sort_neighbours(const rheo__neighbours *list, const rheo__pairs *pairs, all_neighbours *all)
{
    for (uint32_t id = 0; id < pairs->rows; id++) {
        const uint32_t rank = pairs->rank_of[id];
        all->start[id + 1] = all->start[id] + (list->row_start[rank + 1] - list->row_start[rank]);
    }
    for (uint32_t id = 0; id < pairs->rows; id++) {
        const uint32_t rank = pairs->rank_of[id];
        for (uint32_t k = list->row_start[rank]; k < list->row_start[rank + 1]; k++)
            all->neighbour[all->start[pairs->id_of[particle_of(list, pairs, list->row[k])]]++] = id;
    }
    for (uint32_t id = pairs->rows; id > 0; id--) /* each start has moved to its end */
        all->start[id] = all->start[id - 1];
    all->start[0] = 0;
}

static rheo_result find_neighbours(const rheo_world *w, all_neighbours *all, rheo_error *error)
{
    const rheo_allocator *allocator = &w->def.allocator;
    const size_t particles = w->state.particles;
    rheo__neighbours list = {0};
    rheo__pairs pairs = {0};
    *all = (all_neighbours){0};
    const uint32_t count = w->state.particles;
    const double support = rheo__def_support(&w->def);
    bool enough = w->period.axes
                      ? rheo__neighbours_build_rows(&list, &pairs, allocator, count, w->state.position, support, NULL,
                                                    &w->period)
                      : rheo__neighbours_build(&list, &pairs, allocator, count, w->state.position, support, true);
    if (enough) {
        all->start = rheo__allocate(allocator, particles + 1, sizeof *all->start);
        all->neighbour = rheo__allocate(allocator, (size_t)list.row_start[particles] + 1, sizeof *all->neighbour);
        enough = all->start && all->neighbour;
    }
    if (enough)
        sort_neighbours(&list, &pairs, all);
    rheo__neighbours_release(&list, allocator);
    rheo__pairs_release(&pairs, allocator);
    if (enough)
        return RHEO_OK;
    release_neighbours(w, all);
    return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for the list of neighbours");
}

double rheo__query_density(const rheo_world *w, uint32_t id, const uint32_t *neighbour, size_t count,
                           double *near_density)
{
    const rheo__model_type *type = w->type;
    double near_share, density = 0;
    *near_density = 0;
    if (!type->density_share)
        return 0;
    if (type->counts_itself)
        density = type->density_share(w, 0, &near_share);
    for (size_t k = 0; k < count; k++) {
        density += type->density_share(w, rheo__query_distance(w, id, neighbour[k]), &near_share);
        *near_density += near_share;
    }
    return type->wall_density ? density + type->wall_density(w, id) : density;
}

rheo_result rheo_world_densities(const rheo_world *w, double *density, double *near_density, rheo_error *error)
{
    all_neighbours all;
    RHEO__TRY(find_neighbours(w, &all, error));
    for (uint32_t id = 0; id < w->state.particles; id++) {
        const size_t first = all.start[id], count = all.start[id + 1] - first;
        double near_sum;
        const double sum = rheo__query_density(w, id, all.neighbour + first, count, &near_sum);
        if (density)
            density[id] = sum;
        if (near_density)
            near_density[id] = near_sum;
    }
    release_neighbours(w, &all);
    return RHEO_OK;
}

/* ---- States of particles ---- */

static double speed(const rheo_world *w, uint32_t id)
{
    double v2 = 0;
    for (size_t axis = 0; axis < 3; axis++) {
        double v = (double)w->state.velocity[3 * (size_t)id + axis];
        v2 += v * v;
    }
    return __builtin_sqrt(v2);
}

static void read_particle(const rheo_world *w, uint32_t id, const uint32_t *neighbour, size_t count,
                          rheo_particle_state *state)
{
    *state = (rheo_particle_state){.speed = speed(w, id), .neighbours = (uint32_t)count};
    for (size_t axis = 0; axis < 3; axis++) {
        state->position[axis] = (double)w->state.position[3 * (size_t)id + axis];
        state->velocity[axis] = (double)w->state.velocity[3 * (size_t)id + axis];
    }
    if (w->type->query_particle)
        w->type->query_particle(w, id, neighbour, count, state);
}

rheo_result rheo_world_particle(const rheo_world *w, uint32_t id, rheo_particle_state *state, rheo_error *error)
{
    RHEO__TRY(check_id(w, id, error));
    uint32_t *neighbour = rheo__allocate(&w->def.allocator, w->state.particles, sizeof *neighbour);
    if (!neighbour)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for the neighbours of a particle");
    size_t count = 0;
    for (uint32_t other = 0; other < w->state.particles; other++)
        if (rheo__query_is_neighbour(w, id, other))
            neighbour[count++] = other;
    read_particle(w, id, neighbour, count, state);
    rheo__release(&w->def.allocator, neighbour);
    if (w->type->query_springs)
        w->type->query_springs(w, id, state);
    return RHEO_OK;
}

rheo_result rheo_world_particles(const rheo_world *w, rheo_particle_state *states, rheo_error *error)
{
    all_neighbours all;
    RHEO__TRY(find_neighbours(w, &all, error));
    for (uint32_t id = 0; id < w->state.particles; id++)
        read_particle(w, id, all.neighbour + all.start[id], all.start[id + 1] - all.start[id], &states[id]);
    release_neighbours(w, &all);
    if (w->type->query_all_springs)
        w->type->query_all_springs(w, states);
    return RHEO_OK;
}

/* ---- Lists ---- */

/* Whether a comes before b. NaN comes first. */
static bool is_before(const rheo_top_entry *a, const rheo_top_entry *b)
{
    double x = a->value == a->value ? a->value : __builtin_inf();
    double y = b->value == b->value ? b->value : __builtin_inf();
    if (x != y)
        return x > y;
    return a->id != b->id ? a->id < b->id : a->other_id < b->other_id;
}

static void swap_entries(rheo_top_entry *a, rheo_top_entry *b)
{
    rheo_top_entry swap = *a;
    *a = *b;
    *b = swap;
}

static void sink(rheo_top_entry *entry, size_t count)
{
    for (size_t at = 0, last; 2 * at + 1 < count; at = last) {
        last = 2 * at + 1;
        if (last + 1 < count && is_before(&entry[last], &entry[last + 1]))
            last++;
        if (is_before(&entry[last], &entry[at]))
            return;
        swap_entries(&entry[at], &entry[last]);
    }
}

void rheo__query_offer(rheo__query_list *l, rheo_top_entry entry)
{
    if (l->count < l->capacity) {
        size_t at = l->count++;
        l->entry[at] = entry;
        for (; at && is_before(&l->entry[(at - 1) / 2], &l->entry[at]); at = (at - 1) / 2)
            swap_entries(&l->entry[at], &l->entry[(at - 1) / 2]);
    } else if (l->capacity && is_before(&entry, &l->entry[0])) {
        l->entry[0] = entry;
        sink(l->entry, l->count);
    }
}

static void sort(rheo__query_list *l)
{
    for (size_t left = l->count; left > 1; left--) {
        swap_entries(&l->entry[0], &l->entry[left - 1]);
        sink(l->entry, left - 1);
    }
}

static void offer_field(const rheo_world *w, rheo__query_list *l, const rheo_real *values)
{
    for (uint32_t id = 0; id < w->state.particles && values; id++)
        rheo__query_offer(l, (rheo_top_entry){id, 0, (double)values[id]});
}

/* Densities of a model that keeps none in its state. */
static rheo_result offer_densities(const rheo_world *w, rheo__query_list *l, rheo_error *error)
{
    const rheo_allocator *allocator = &w->def.allocator;
    double *density = rheo__allocate(allocator, w->state.particles, sizeof *density);
    if (!density)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for the densities");
    rheo_result result = rheo_world_densities(w, density, NULL, error);
    for (uint32_t id = 0; result == RHEO_OK && id < w->state.particles; id++)
        rheo__query_offer(l, (rheo_top_entry){id, 0, density[id]});
    rheo__release(allocator, density);
    return result;
}

static rheo_result offer_all(const rheo_world *w, rheo_top top, rheo__query_list *l, rheo_error *error)
{
    const rheo__state *s = &w->state;
    switch (top) {
    case RHEO_TOP_FASTEST:
        for (uint32_t id = 0; id < s->particles; id++)
            rheo__query_offer(l, (rheo_top_entry){id, 0, speed(w, id)});
        return RHEO_OK;
    case RHEO_TOP_DENSEST:
        if (!s->density && w->type->density_share)
            return offer_densities(w, l, error);
        offer_field(w, l, s->density);
        return RHEO_OK;
    case RHEO_TOP_STIFFEST:
        return w->type->offer_springs ? w->type->offer_springs(w, l, error) : RHEO_OK;
    case RHEO_TOP_HOTTEST:
        offer_field(w, l, s->temperature);
        return RHEO_OK;
    case RHEO_TOP_FURTHEST:
        for (uint32_t id = 0; id < s->particles && s->start_position; id++)
            rheo__query_offer(l, (rheo_top_entry){id, 0, rheo__query_displacement(w, id)});
        return RHEO_OK;
    }
    return rheo__fail(error, RHEO_ERROR_ARGUMENT, "there is no list %d", (int)top);
}

rheo_result rheo_world_top(const rheo_world *w, rheo_top top, size_t capacity, rheo_top_entry *entries, size_t *count,
                           rheo_error *error)
{
    rheo__query_list l = {entries, 0, capacity};
    *count = 0;
    RHEO__TRY(offer_all(w, top, &l, error));
    sort(&l);
    *count = l.count;
    return RHEO_OK;
}

/* ---- Tables of the model ---- */

const rheo_quantity *rheo_world_quantity(const rheo_world *w, uint32_t index)
{
    const rheo_quantity *row = w->type->quantities;
    while (row->name && index-- > 0)
        row++;
    return row->name ? row : NULL;
}

const rheo_ranking *rheo_world_ranking(const rheo_world *w, uint32_t index)
{
    const rheo_ranking *row = w->type->rankings;
    while (row->name && index-- > 0)
        row++;
    return row->name ? row : NULL;
}
