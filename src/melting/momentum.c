/*
 * Stage momentum, docs/melting.md (3, 4): all accelerations except viscosity,
 *
 *     dv_i/dt = g - sum m (p_i/rho_i^2 + p_j/rho_j^2 + Pi_ij) grad W + sum a_rep (1 - r/r_rep) x_ij/r
 *     Pi_ij = (-alpha c mu + beta mu^2)/((rho_i + rho_j)/2),  mu = h v_ij.x_ij/(r^2 + 0.01 h^2)  where v_ij.x_ij < 0
 *
 * with p = c^2 (rho - rho0), and a weak repulsion of pairs closer than r_rep = 0.7 spacings, since an integrated
 * density does not detect clumps of particles. The two terms of a pair (pressure.h) are opposite to the last bit, so
 * momentum is conserved to round-off. The stage also finds the gradients at the start of the substep; gradients.c makes
 * both sums over pairs in one loop.
 */
#include "melting/gradients.h"

/* Pushes coinciding particles apart, along a direction that depends on their ids. */
static void separate_coinciding(const rheo__state *s, rheo__melting *m, const rheo__pressure *c)
{
    for (uint32_t i = 0; i < m->pairs.rows; i++)
        for (uint32_t k = 0; k < m->rows.length[i]; k++) {
            const uint32_t block = i / RHEO__BLOCK_ROWS;
            const uint32_t j =
                m->rows.partner[((size_t)m->rows.start[block] + k) * RHEO__BLOCK_ROWS + i % RHEO__BLOCK_ROWS] /
                RHEO__POINT_VALUES;
            const rheo__point x = m->point[i].at, y = m->point[j].at;
            if (j < i || rheo__length2(x.x - y.x, x.y - y.y, x.z - y.z) != 0)
                continue;
            rheo_real direction[3];
            rheo__part_direction(m->pairs.id_of[i], m->pairs.id_of[j], direction);
            rheo__point *a = &m->acceleration[i], *b = &m->acceleration[j];
            rheo__rank_adds(s, m, i, RHEO__SUM_acceleration, RHEO_SOURCE_PARTING, m->pairs.id_of[j],
                            -(c->repulsion * direction[0]), -(c->repulsion * direction[1]),
                            -(c->repulsion * direction[2]));
            rheo__rank_adds(s, m, j, RHEO__SUM_acceleration, RHEO_SOURCE_PARTING, m->pairs.id_of[i],
                            c->repulsion * direction[0], c->repulsion * direction[1], c->repulsion * direction[2]);
            a->x -= c->repulsion * direction[0];
            a->y -= c->repulsion * direction[1];
            a->z -= c->repulsion * direction[2];
            b->x += c->repulsion * direction[0];
            b->y += c->repulsion * direction[1];
            b->z += c->repulsion * direction[2];
        }
}

/*
 * Near a wall the sums over the fluid lack the share of W behind the plane. Their component along the wall is
 * continued there. Without this, a pressure that grows downwards carries less than the weight of fluid at an upright
 * wall, and the fluid sinks along it for ever.
 */
static void complete_along_walls(const rheo__state *s, rheo__melting *m)
{
    for (uint32_t k = 0; k < m->contacts; k++) {
        const rheo__contact *contact = &m->contact[k];
        const rheo_real *n = m->planes->plane[contact->wall].normal;
        rheo__point *a = &m->acceleration[contact->rank];
        const rheo_real normal = n[0] * a->x + n[1] * a->y + n[2] * a->z;
        const rheo_real more = contact->integral.weight / (1 - contact->integral.weight);
        rheo__rank_adds(s, m, contact->rank, RHEO__SUM_acceleration, RHEO_SOURCE_WALL, contact->wall,
                        more * (a->x - normal * n[0]), more * (a->y - normal * n[1]), more * (a->z - normal * n[2]));
        a->x += more * (a->x - normal * n[0]);
        a->y += more * (a->y - normal * n[1]);
        a->z += more * (a->z - normal * n[2]);
    }
}

/*
 * Pressure of walls: behind a plane it continues as in fluid at rest, p_w = p_i - rho (g.n) z, but never pulls. A
 * particle below a wall that no pressure holds there is detached: the wall has no effect on it. Otherwise a cold body
 * would stick to a ceiling by viscosity alone.
 */
static void find_wall_pressures(rheo__melting *m, const rheo__pressure *c)
{
    for (uint32_t k = 0; k < m->contacts; k++) {
        rheo__contact *contact = &m->contact[k];
        const rheo_real *n = m->planes->plane[contact->wall].normal, *g = c->gravity;
        const rheo__point *v = &m->velocity[contact->rank];
        const rheo_real density = v->w, pressure = c->c2 * (density - c->rest_density);
        const rheo_real fall = n[0] * g[0] + n[1] * g[1] + n[2] * g[2];
        const rheo_real approach = rheo__min(n[0] * v->x + n[1] * v->y + n[2] * v->z, 0);
        contact->push = rheo__max(2 * (pressure - density * c->sound_speed * approach) * contact->integral.gradient -
                                      density * fall * contact->integral.moment,
                                  0) /
                        density;
        contact->detached = fall > 0 && !(contact->push > 0);
    }
}

/* Walls also repel as a mirrored particle would. */
static void press_walls(const rheo__state *s, rheo__melting *m, const rheo__pressure *c)
{
    for (uint32_t k = 0; k < m->contacts; k++) {
        const rheo__contact *contact = &m->contact[k];
        const rheo_real *n = m->planes->plane[contact->wall].normal;
        const rheo_real gap = 2 * rheo__max(contact->distance, 0);
        const rheo_real push = contact->push + rheo__max(c->repulsion * (1 - gap * c->inverse_range), 0);
        rheo__point *a = &m->acceleration[contact->rank];
        rheo__rank_adds(s, m, contact->rank, RHEO__SUM_acceleration, RHEO_SOURCE_WALL, contact->wall, push * n[0],
                        push * n[1], push * n[2]);
        a->x += push * n[0];
        a->y += push * n[1];
        a->z += push * n[2];
    }
}

rheo_result RHEO__VARIANT(stage_momentum)(rheo__state *s, void *context)
{
    rheo__melting *m = context;
    const rheo_world_def *def = m->def;
    const double c_sound = def->melting.sound_speed, range = 0.7 * def->fluid.spacing, h = m->smoothing_length;
    const rheo__pressure c = {
        .mass = (rheo_real)rheo__melting_mass(def),
        .sound_speed = (rheo_real)c_sound,
        .c2 = (rheo_real)(c_sound * c_sound),
        .rest_density = (rheo_real)def->melting.rest_density,
        .h = (rheo_real)h,
        .alpha_c = (rheo_real)(def->melting.alpha * c_sound),
        .beta = (rheo_real)def->melting.beta,
        .repulsion = (rheo_real)(def->melting.repulsion * c_sound * c_sound / def->fluid.spacing),
        .inverse_range = (rheo_real)(1 / range),
        .range2 = def->melting.repulsion > 0 ? (rheo_real)(range * range) : 0,
        .gravity = {(rheo_real)def->gravity[0], (rheo_real)def->gravity[1], (rheo_real)def->gravity[2]},
        .artificial = def->melting.alpha > 0 || def->melting.beta > 0,
        .printed = def->paper.artificial_viscosity};
    const bool shear = rheo__needs_shear_rate(m), heat = m->heat && rheo__corrects_heat(def);
    rheo__gradients gradients = RHEO__VARIANT(begin_gradients)(m, shear, heat, &c);
    RHEO__IN_ACCOUNT(gradients.state = s);
    find_wall_pressures(m, &c);
    for (uint32_t block = 0; block < m->rows.blocks; block++)
        RHEO__VARIANT(find_gradients)(m, &gradients, block);
    if (gradients.finds_kernels)
        rheo__kernels_end(m, &gradients.kernels);
    if (m->coinciding)
        separate_coinciding(s, m, &c);
    complete_along_walls(s, m); /* before press_walls(): completes fluid sums only */
    press_walls(s, m, &c);
    for (uint32_t i = 0; i < s->particles; i++) {
        const rheo__point a = m->acceleration[i], v = m->velocity[i];
        rheo__rank_adds(s, m, i, RHEO__SUM_acceleration, RHEO_SOURCE_GRAVITY, 0, c.gravity[0], c.gravity[1],
                        c.gravity[2]);
        rheo__rank_applies(s, m, i, RHEO__FIELD_velocity, m->substep, RHEO__SUM_acceleration);
        m->velocity_before[i] = v;
        m->velocity[i] =
            (rheo__point){v.x + m->substep * (a.x + c.gravity[0]), v.y + m->substep * (a.y + c.gravity[1]),
                          v.z + m->substep * (a.z + c.gravity[2]), v.w};
    }
    rheo__scatter(s->velocity, m->velocity, m->pairs.id_of, s->particles);
    return RHEO_OK;
}
