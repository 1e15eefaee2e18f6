/*
 * Needs of particles, many at a time (thickening/margins.h). In the coming step particle i needs the margin
 *
 *     n_i = min(step' (speed + |g| step), most)
 *
 * where speed is relative to the mean velocity, or that of a ball if that is larger and the ball may hit the particle.
 */
#include "thickening/margins.h"

#include "space/row_blocks.h"

static rheo__lanes length2(rheo__lanes3 a, const rheo_real *less)
{
    const rheo__lanes x = a.x - less[0], y = a.y - less[1], z = a.z - less[2];
    return x * x + y * y + z * z;
}

static rheo__lanes need_of_step(const rheo__motion *m, rheo__lanes3 x, rheo__lanes3 v)
{
    rheo__lanes speed2 = length2(v, m->velocity);
    for (uint32_t ball = 0; ball < m->balls; ball++) {
        const rheo__lanes of_ball = rheo__lanes_keep_less(length2(x, m->ball[ball]), rheo__lanes_all(m->near2[ball]),
                                                          rheo__lanes_all(m->ball2[ball]));
        speed2 = rheo__lanes_max(speed2, of_ball);
    }
    return rheo__lanes_min(m->step * (rheo__lanes_sqrt(speed2) + m->fall), rheo__lanes_all(m->most));
}

/* Triples of particles from i on. Where there are no more, the last particle stands for them. */
static rheo__lanes3 triples_at(const rheo_real *triple, uint32_t i, uint32_t particles)
{
    if (i + RHEO__LANES <= particles)
        return rheo__lanes_load_triples(triple + 3 * (size_t)i);
    rheo_real values[3 * RHEO__LANES];
    for (uint32_t lane = 0; lane < RHEO__LANES; lane++)
        memcpy(values + 3 * lane, triple + 3 * (size_t)(i + lane < particles ? i + lane : particles - 1),
               3 * sizeof *values);
    return rheo__lanes_load_triples(values);
}
static rheo__lanes values_at(const rheo_real *value, uint32_t i, uint32_t particles)
{
    if (i + RHEO__LANES <= particles)
        return rheo__lanes_at(value, i);
    rheo_real values[RHEO__LANES];
    for (uint32_t lane = 0; lane < RHEO__LANES; lane++)
        values[lane] = value[i + lane < particles ? i + lane : particles - 1];
    return rheo__lanes_at(values, 0);
}

bool RHEO__VARIANT(list_lasts)(const rheo__state *s, const rheo__motion *m)
{
    enum { CHUNK = 256 }; /* particles between two decisions */
    const rheo__lanes one = rheo__lanes_all(1);
    const uint32_t n = s->particles;
    for (uint32_t first = 0; first < n; first += CHUNK) {
        rheo__lanes lasts = one; /* 0 where a margin may be used up, or something is NaN */
        for (uint32_t i = first; i < n && i < first + CHUNK; i += RHEO__LANES) {
            const rheo__lanes3 x = triples_at(s->position, i, n), v = triples_at(s->velocity, i, n),
                               from = triples_at(s->list_position, i, n);
            const rheo__lanes moved = rheo__lanes_sqrt(length2(rheo__lanes3_minus(x, from), m->displacement));
            lasts = rheo__lanes_keep_less(moved + need_of_step(m, x, v), values_at(s->list_margin, i, n), lasts);
        }
        if (rheo__lanes_any(lasts < one))
            return false;
    }
    return true;
}

rheo_real RHEO__VARIANT(needs_of_step)(rheo__state *s, const rheo__motion *m)
{
    const uint32_t n = s->particles;
    rheo__lanes most = rheo__lanes_all(0);
    for (uint32_t i = 0; i < n; i += RHEO__LANES) {
        const rheo__lanes need = need_of_step(m, triples_at(s->position, i, n), triples_at(s->velocity, i, n));
        rheo_real of_lane[RHEO__LANES];
        rheo__lanes_put(of_lane, 0, need);
        memcpy(s->list_margin + i, of_lane, (n - i < RHEO__LANES ? n - i : RHEO__LANES) * sizeof *of_lane);
        most = rheo__lanes_max(most, need);
    }
    rheo_real largest = 0;
    for (int lane = 0; lane < RHEO__LANES; lane++)
        largest = rheo__max(largest, RHEO__LANE(most, lane));
    return largest;
}
