/*
 * Corrected gradients and pair factors, docs/melting.md (4, 5, 6). A sum over neighbours lacks those beyond a free
 * surface or a wall, and on a lattice it is biased. The second moments of the neighbours correct gradients, so that
 * they are exact for any linear field:
 *
 *     B_i = -m/rho_i sum x_ij (x) grad W,   grad f = B_i^-1 m/rho_i sum (f_j - f_i) grad W
 *
 * Pairs exchange momentum and heat with a factor (c_i + c_j)/2. c_i makes the sum over the pairs of particle i
 * dissipate as much as the continuum does in the linear field with the gradient of i:
 *
 *     heat       c_i = |g|^2/(g.B_i g),  g = grad T
 *     viscosity  c_i = f_i (D:D/2 + (tr D)^2/4)/(sum 5/4 V |slope| (x_ij.D x_ij)^2/(r^2 + 0.01 h^2) + walls)
 *
 * f_i = tr B_i/3, with the second moments of walls, is 1 except at free surfaces. There the sums of the pressure lack
 * neighbours too. With f_i = 1 they could not balance viscosity, and free surfaces would be too stiff.
 *
 * Both are independent of the size of the gradient. The factor of a pair is symmetric, so momentum and heat are
 * conserved. It is positive, so heat flows downhill and viscosity dissipates.
 */
#include "melting/gradients.h"
#include "melting/rows.h"

/* A factor is at most twice that of an isotropic neighbourhood, 3/tr B: layers one particle thick have no B across. */
#define MOST_FACTOR RHEO__R(2.0)

/* Sums of walls over the rows of a block: second moments, and gradient of the velocity by rows. */
typedef struct wall_sums {
    bool any;
    rheo_real trace[RHEO__BLOCK_ROWS]; /* of the second moments of the wall */
    rheo_real moment[6][RHEO__BLOCK_ROWS], gradient[9][RHEO__BLOCK_ROWS];
} wall_sums;

/* Sums of a vector of rows. */
typedef struct sums {
    rheo__lanes6 moment;
    rheo__lanes3 x, y, z, temperature; /* gradients of the components of the velocity, and of the temperature */
    rheo__lanes3 acceleration;
} sums;

/* The sums that are made. */
typedef struct terms {
    bool velocity, temperature, acceleration, artificial, kernels;
} terms;

/*
 * So many pairs of a row are summed together, in two loops. They are shorter than one loop would be, so the processor
 * works on more pairs at a time, and fewer sums leave the registers.
 */
enum { TOGETHER = 8 };

/* rheo__rows.scratch: values of the pairs of a vector of rows, at entry k from its first one. */
enum { OFFSET_X, OFFSET_Y, OFFSET_Z, BY_STRETCHING };
static inline rheo_real *scratch(const rheo__rows *rows, uint32_t value, size_t k)
{
    return (rheo_real *)rows->scratch + (4 * k + value) * RHEO__LANES;
}

rheo__gradients RHEO__VARIANT(begin_gradients)(rheo__melting *m, bool velocity, bool temperature,
                                               const rheo__pressure *pressure)
{
    for (uint32_t i = 0; i <= m->pairs.rows; i++) {
        const rheo__point v = m->velocity[i];
        m->point[i].at.w = v.w;
        m->point[i].more = (rheo__point){v.x, v.y, v.z, temperature && i < m->pairs.rows ? m->temperature[i] : 0};
    }
    const double h = m->smoothing_length;
    const rheo_real viscous_support = (rheo_real)m->viscous_support;
    return (rheo__gradients){.velocity = velocity,
                             .temperature = temperature,
                             .pressure = pressure,
                             .mass = (rheo_real)rheo__melting_mass(m->def),
                             .softening = (rheo_real)(0.01 * h * h),
                             .viscous_support2 = rheo__lanes_all(viscous_support * viscous_support),
                             .finds_kernels = !rheo__needs_kernels_early(m->def),
                             .kernels = rheo__kernels_begin(m)};
}

/* ---- Sums over neighbours ---- */

RHEO__FOR_EACH_CASE void scale(sums *sum, rheo__lanes by, terms needed)
{
    for (int i = 0; i < 6; i++)
        sum->moment.of[i] *= by;
    if (needed.velocity) {
        sum->x = rheo__lanes3_times(by, sum->x);
        sum->y = rheo__lanes3_times(by, sum->y);
        sum->z = rheo__lanes3_times(by, sum->z);
    }
    if (needed.temperature)
        sum->temperature = rheo__lanes3_times(by, sum->temperature);
}

/* The particles of a vector of rows. */
typedef struct particles {
    rheo__wide_lanes point; /* position and density, velocity and temperature */
    rheo__lanes pressure_term;
} particles;

/* Values of a pair for the second loop. */
typedef struct pair_values {
    rheo__lanes3 u, grad;
    rheo__lanes temperatures; /* T_i - T_j */
    rheo__pair_state state;
    RHEO__IN_ACCOUNT(const uint32_t *partner;)
} pair_values;

/* First loop: loads the partners of an entry, number k of its row. Sums the second moments. */
RHEO__FOR_EACH_CASE void begin_pair(pair_values *pair, sums *sum, rheo__pair_counts *counts, const particles *own,
                                    const rheo__wide_point *point, const rheo__rows *rows, const rheo__gradients *of,
                                    size_t entry, size_t k, size_t bonds, terms needed)
{
    const rheo__wide_lanes other = rheo__lanes_minus_wide_at(&own->point, point, rows->partner + entry);
    const rheo__lanes3 x = other.at, u = other.more;
    const rheo__lanes r2 = rheo__lanes3_dot(x, x);
    if (needed.kernels)
        rheo__count_pairs(counts, &of->kernels, r2);
    const rheo__lanes slope =
        needed.kernels ? rheo__put_kernel(rows, &of->kernels, entry, r2) : rheo__lanes_at(rows->slope, entry);
    const rheo__lanes sum_of_densities = own->point.w + other.w,
                      inverse = 1 / ((r2 + of->softening) * sum_of_densities);
    if (needed.velocity || needed.temperature) {
        const rheo__lanes3 grad = rheo__lanes3_times(slope, x);
        pair->grad = grad;
        sum->moment.of[0] += grad.x * x.x;
        sum->moment.of[1] += grad.y * x.y;
        sum->moment.of[2] += grad.z * x.z;
        sum->moment.of[3] += grad.x * x.y;
        sum->moment.of[4] += grad.x * x.z;
        sum->moment.of[5] += grad.y * x.z;
    }
    if (needed.velocity && k < bonds) {
        const rheo__lanes by = rheo__lanes_keep_less(r2, of->viscous_support2, slope);
        rheo__lanes_put(scratch(rows, OFFSET_X, k), 0, x.x);
        rheo__lanes_put(scratch(rows, OFFSET_Y, k), 0, x.y);
        rheo__lanes_put(scratch(rows, OFFSET_Z, k), 0, x.z);
        rheo__lanes_put(scratch(rows, BY_STRETCHING, k), 0, by * (inverse * sum_of_densities));
    }
    RHEO__IN_ACCOUNT(pair->partner = rows->partner + entry);
    pair->u = u;
    pair->temperatures = own->point.more_w - other.more_w;
    if (needed.acceleration)
        pair->state = (rheo__pair_state){
            .x = x,
            .r2 = r2,
            .inverse = inverse,
            .approach = rheo__lanes3_dot(u, x),
            .slope = slope,
            .sum_of_densities = sum_of_densities,
            .terms = own->pressure_term + rheo__pressure_term(other.w, of->pressure),
        };
}

/* Second loop: all other sums. */
RHEO__FOR_EACH_CASE void end_pair(const pair_values *pair, sums *sum, const particles *own, const rheo__gradients *of,
                                  terms needed)
{
    const rheo__lanes3 u = pair->u, grad = pair->grad;
    if (needed.velocity) {
        rheo__lanes3_add(&sum->x, u.x, grad);
        rheo__lanes3_add(&sum->y, u.y, grad);
        rheo__lanes3_add(&sum->z, u.z, grad);
    }
    if (needed.temperature)
        rheo__lanes3_add(&sum->temperature, pair->temperatures, grad);
    if (needed.acceleration) {
        const rheo__lanes push = rheo__pair_push(&pair->state, own->point.w, of->pressure, needed.artificial);
        RHEO__IN_ACCOUNT(rheo__row_adds(&of->keeper, RHEO__SUM_acceleration, RHEO_SOURCE_PRESSURE, pair->partner,
                                        rheo__lanes3_times(push, pair->state.x)));
        rheo__lanes3_add(&sum->acceleration, push, pair->state.x);
    }
}

RHEO__FOR_EACH_CASE void add_rows(sums *to, const rheo__melting *m, rheo__gradients *of, uint32_t block,
                                  uint32_t first, terms needed)
{
    particles own = {.point = rheo__lanes_load_wide_row(m->point + block * RHEO__BLOCK_ROWS + first)};
    own.pressure_term = needed.acceleration ? rheo__pressure_term(own.point.w, of->pressure) : rheo__lanes_all(0);
    /* Copies, so that no store makes the compiler load them again. */
    const rheo__wide_point *point = m->point;
    const rheo__rows rows = m->rows;
    const rheo__pressure pressure = needed.acceleration ? *of->pressure : (rheo__pressure){0};
    rheo__gradients with = *of;
    with.pressure = &pressure;
    sums sum = {0};
    rheo__pair_counts counts = {0};
    const size_t bonds = needed.velocity ? m->bonds.start[block + 1] - m->bonds.start[block] : 0,
                 count = m->rows.start[block + 1] - m->rows.start[block];
    RHEO__IN_ACCOUNT(with.keeper = rheo__row_keeper(of->state, m, block * RHEO__BLOCK_ROWS + first));
    RHEO__IN_ACCOUNT(rheo__row_begins(&with.keeper, RHEO__SUM_acceleration));
    size_t entry = (size_t)m->rows.start[block] * RHEO__BLOCK_ROWS + first;
    for (size_t k = 0; k < count; k += TOGETHER) {
        pair_values pair[TOGETHER];
        const size_t together = count - k < TOGETHER ? count - k : TOGETHER;
        for (size_t i = 0; i < together; i++)
            begin_pair(&pair[i], &sum, &counts, &own, point, &rows, &with, entry + i * RHEO__BLOCK_ROWS, k + i, bonds,
                       needed);
        for (size_t i = 0; i < together; i++, entry += RHEO__BLOCK_ROWS)
            end_pair(&pair[i], &sum, &own, &with, needed);
    }
    if (needed.kernels)
        rheo__add_counts(&of->kernels, counts);
    scale(&sum, -of->mass / own.point.w, needed);
    *to = sum;
}

/* A wall continues the velocity of the particle and its own, linearly across the wall. Returns the next contact. */
static uint32_t add_walls(const rheo__melting *m, uint32_t contact, uint32_t block, wall_sums *sum)
{
    sum->any = false;
    for (; contact < m->contacts && m->contact[contact].rank / RHEO__BLOCK_ROWS == block; contact++) {
        const rheo__contact *c = &m->contact[contact];
        if (!rheo__is_no_slip(m, c))
            continue;
        if (!sum->any)
            memset(sum, 0, sizeof *sum);
        sum->any = true;
        const uint32_t row = c->rank % RHEO__BLOCK_ROWS;
        const rheo_real *n = m->planes->plane[c->wall].normal, *wall = m->wall_velocity[c->wall];
        const rheo__point *v = &m->velocity[c->rank];
        const rheo_real u[3] = {v->x - wall[0], v->y - wall[1], v->z - wall[2]}, rate = rheo__wall_rate(m, c);
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 3; k++)
                sum->gradient[3 * i + k][row] += rate * u[i] * n[k];
        sum->trace[row] += c->integral.shear + 2 * c->integral.weight;
        static const int ROW[] = {0, 1, 2, 0, 0, 1}, COLUMN[] = {0, 1, 2, 1, 2, 2};
        for (int i = 0; i < 6; i++)
            sum->moment[i][row] += c->integral.shear * n[ROW[i]] * n[COLUMN[i]];
    }
    return contact;
}

/* ---- Tensors ---- */

static inline rheo__lanes trace(const rheo__lanes6 *t)
{
    return t->of[0] + t->of[1] + t->of[2];
}

/* Adjoint of a symmetric tensor. Returns the determinant. */
static inline rheo__lanes adjoint(const rheo__lanes6 *t, rheo__lanes6 *adjoint)
{
    const rheo__lanes xx = t->of[0], yy = t->of[1], zz = t->of[2], xy = t->of[3], xz = t->of[4], yz = t->of[5];
    *adjoint = (rheo__lanes6){{yy * zz - yz * yz, xx * zz - xz * xz, xx * yy - xy * xy, xz * yz - xy * zz,
                               xy * yz - xz * yy, xy * xz - xx * yz}};
    return xx * adjoint->of[0] + xy * adjoint->of[3] + xz * adjoint->of[4];
}

/* Inverse of second moments; those of neighbours in a line or plane are not regular. */
static inline rheo__lanes6 invert(rheo__lanes6 moment)
{
    rheo__lanes6 inverse;
    const rheo_real least = RHEO__R(RHEO__LEAST_DETERMINANT);
    rheo__lanes determinant = adjoint(&moment, &inverse);
    const rheo__mask flat = determinant < least;
    if (rheo__lanes_any(flat)) {
        const rheo__lanes more = rheo__lanes_keep(flat, least - determinant);
        for (int i = 0; i < 3; i++)
            moment.of[i] += more;
        determinant = adjoint(&moment, &inverse);
    }
    const rheo__lanes by = 1 / determinant;
    for (int i = 0; i < 6; i++)
        inverse.of[i] *= by;
    return inverse;
}

/* continuum/pairs, within bounds; 3/tr B without a gradient, and 1 without neighbours. */
static inline rheo__lanes factor(rheo__lanes continuum, rheo__lanes pairs, rheo__lanes trace)
{
    const rheo__lanes isotropic = 3 / trace;
    const rheo__lanes bounded = rheo__lanes_min(continuum / pairs, MOST_FACTOR * isotropic);
    return rheo__lanes_select(trace > 0, rheo__lanes_select((continuum > 0) & (pairs > 0), bounded, isotropic),
                              rheo__lanes_all(1));
}

/* ---- Heat ---- */

static void put_heat(rheo__melting *m, uint32_t rank, const sums *own)
{
    uint32_t own_rank[RHEO__LANES];
    rheo__own_ranks(rank, own_rank);
    const rheo__lanes6 inverse = invert(own->moment);
    const rheo__lanes3 g = rheo__lanes6_times(&inverse, own->temperature),
                       by_pairs = rheo__lanes6_times(&own->moment, g);
    const rheo__lanes c = factor(rheo__lanes3_dot(g, g), rheo__lanes3_dot(g, by_pairs), trace(&own->moment));
    rheo__lanes_store(m->heat_points, own_rank, (rheo__lanes3){rheo__lanes_at(m->temperature, rank), c, c});
}

/* ---- Viscosity ---- */

/* D, from sums with those of walls; keeps the inverse of B. */
static inline rheo__lanes6 strain_rate(rheo__melting *m, uint32_t rank, const sums *own)
{
    const rheo__lanes6 inverse = invert(own->moment);
    for (int i = 0; i < 6; i++)
        rheo__lanes_put(m->inverse_moment[i], rank, inverse.of[i]);
    const rheo__lanes3 x = rheo__lanes6_times(&inverse, own->x), y = rheo__lanes6_times(&inverse, own->y),
                       z = rheo__lanes6_times(&inverse, own->z);
    return (rheo__lanes6){{2 * x.x, 2 * y.y, 2 * z.z, x.y + y.x, x.z + z.x, y.z + z.y}};
}

/* D:D */
static inline rheo__lanes squared(const rheo__lanes6 *d)
{
    const rheo__lanes *t = d->of;
    return t[0] * t[0] + t[1] * t[1] + t[2] * t[2] + 2 * (t[3] * t[3] + t[4] * t[4] + t[5] * t[5]);
}

/* Dissipation of pairs in the linear field with strain rate D, over the viscosity. */
static inline rheo__lanes pair_dissipation(const rheo__melting *m, const rheo__gradients *of, uint32_t block,
                                           rheo__lanes density, const rheo__lanes6 *d)
{
    rheo__lanes sum = rheo__lanes_all(0);
    const size_t entries = m->bonds.start[block + 1] - m->bonds.start[block];
    for (size_t k = 0; k < entries; k++) {
        const rheo__lanes3 x = {rheo__lanes_at(scratch(&m->rows, OFFSET_X, k), 0),
                                rheo__lanes_at(scratch(&m->rows, OFFSET_Y, k), 0),
                                rheo__lanes_at(scratch(&m->rows, OFFSET_Z, k), 0)};
        const rheo__lanes stretching = rheo__lanes3_dot(x, rheo__lanes6_times(d, x));
        sum -= rheo__lanes_at(scratch(&m->rows, BY_STRETCHING, k), 0) * (stretching * stretching);
    }
    return RHEO__R(1.25) * of->mass / density * sum;
}

/* Adds the dissipation at walls. Without slip, the velocity changes across a wall by g = D n - n (n.D n)/2. */
static void add_wall_dissipation(const rheo__melting *m, uint32_t contact, uint32_t block, uint32_t first,
                                 const rheo__lanes6 *strain, rheo__lanes *dissipation)
{
    for (; contact < m->contacts && m->contact[contact].rank / RHEO__BLOCK_ROWS == block; contact++) {
        const rheo__contact *c = &m->contact[contact];
        const uint32_t row = c->rank % RHEO__BLOCK_ROWS;
        if (row < first || row - first >= RHEO__LANES || !rheo__is_no_slip(m, c))
            continue;
        const uint32_t lane = row - first;
        const rheo_real *n = m->planes->plane[c->wall].normal;
        rheo_real d[6];
        for (int i = 0; i < 6; i++)
            d[i] = RHEO__LANE(strain->of[i], lane);
        const rheo_real x = d[0] * n[0] + d[3] * n[1] + d[4] * n[2], y = d[3] * n[0] + d[1] * n[1] + d[5] * n[2],
                        z = d[4] * n[0] + d[5] * n[1] + d[2] * n[2], across = (n[0] * x + n[1] * y + n[2] * z) / 2;
        const rheo_real g2 = rheo__length2(x - across * n[0], y - across * n[1], z - across * n[2]);
        RHEO__LANE(*dissipation, lane) +=
            (c->integral.along * (g2 - across * across) + c->integral.normal * (across * across)) /
            rheo__inverse_wall_distance(m, c);
    }
}

static void put_viscous(rheo__melting *m, const rheo__gradients *of, uint32_t block, uint32_t first, sums own,
                        const wall_sums *walls)
{
    const uint32_t rank = block * RHEO__BLOCK_ROWS + first;
    rheo__lanes moments = trace(&own.moment);
    if (walls->any)
        moments += rheo__lanes_at(walls->trace, first);
    for (int i = 0; walls->any && i < 6; i++)
        own.moment.of[i] += rheo__lanes_at(walls->moment[i], first);
    if (walls->any) {
        rheo__lanes3 *const gradient[] = {&own.x, &own.y, &own.z};
        for (int i = 0; i < 3; i++) {
            gradient[i]->x += rheo__lanes_at(walls->gradient[3 * i], first);
            gradient[i]->y += rheo__lanes_at(walls->gradient[3 * i + 1], first);
            gradient[i]->z += rheo__lanes_at(walls->gradient[3 * i + 2], first);
        }
    }
    rheo__lanes6 d = strain_rate(m, rank, &own);
    const rheo__lanes rate = rheo__lanes_sqrt(squared(&d) / 2);
    rheo__lanes_put(m->shear_rate, rank, rate);
    /* With D of size 1, the squares are in range. */
    const rheo__lanes by = rheo__lanes_keep(rate > 0, 1 / rate);
    for (int i = 0; i < 6; i++)
        d.of[i] *= by;
    const rheo__lanes compression = trace(&d);
    uint32_t own_rank[RHEO__LANES];
    rheo__own_ranks(rank, own_rank);
    rheo__lanes density;
    rheo__lanes_load_w(m->velocity, own_rank, &density);
    rheo__lanes dissipation = pair_dissipation(m, of, block, density, &d);
    if (walls->any)
        add_wall_dissipation(m, of->contact, block, first, &d, &dissipation);
    rheo__lanes_put(m->viscous_factor, rank,
                    factor(moments * RHEO__R(1.0 / 3) * (squared(&d) / 2 + compression * compression / 4),
                           dissipation, trace(&own.moment)));
}

void RHEO__VARIANT(find_gradients)(rheo__melting *m, rheo__gradients *of, uint32_t block)
{
    wall_sums walls;
    const uint32_t next = add_walls(m, of->contact, block, &walls);
    const terms needed = {of->velocity, of->temperature, of->pressure != NULL,
                          of->pressure && of->pressure->artificial, of->finds_kernels},
                all = {true, true, true, true, true}, no_heat = {true, false, true, true, true};
    const bool needs_all = !memcmp(&needed, &all, sizeof needed),
               needs_no_heat = !memcmp(&needed, &no_heat, sizeof needed);
    RHEO__EACH_VECTOR_OF_BLOCK (first) {
        const uint32_t rank = block * RHEO__BLOCK_ROWS + first;
        sums own;
        /* Separate calls, so that each is compiled for its case. */
        if (needs_all)
            add_rows(&own, m, of, block, first, (terms){true, true, true, true, true});
        else if (needs_no_heat)
            add_rows(&own, m, of, block, first, (terms){true, false, true, true, true});
        else
            add_rows(&own, m, of, block, first, needed);
        if (of->temperature)
            put_heat(m, rank, &own);
        if (of->pressure) {
            uint32_t own_rank[RHEO__LANES];
            rheo__own_ranks(rank, own_rank);
            rheo__lanes_store(m->acceleration, own_rank, own.acceleration);
        }
        if (of->velocity)
            put_viscous(m, of, block, first, own, &walls);
    }
    of->contact = next;
}

rheo_result RHEO__VARIANT(stage_gradients)(rheo__state *s, void *context)
{
    (void)s;
    rheo__melting *m = context;
    rheo__gradients of = RHEO__VARIANT(begin_gradients)(m, false, true, NULL);
    RHEO__IN_ACCOUNT(of.state = s);
    for (uint32_t block = 0; block < m->rows.blocks; block++)
        RHEO__VARIANT(find_gradients)(m, &of, block);
    return RHEO_OK;
}
