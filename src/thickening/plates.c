/*
 * Stage plates of scheme summed (docs/model.md, Plates): two plates, which are made of particles, take the momentum p that
 * a substep tau gave to theirs, and put these in place. The lower plate rests. The upper one has the displacement D and
 * the velocity V; with control velocity
 *
 *     D += tau V0,  phase += tau f,  D' = D + (A sin(2 pi phase), 0, 0),  V = V0 + (2 pi f A cos(2 pi phase), 0, 0)
 *
 * and with control stress, for M particles of mass 1, the number density n and the area a of a plate,
 *
 *     V_x += (p_x + tau sigma n a)/M,  D_x += tau V_x,  D' = D
 *
 * A particle of it is at x = x0 + D' with velocity V, in periodic space at the image that is nearest to where the
 * particle was when the list was made. All but the particles is in double.
 */
#include "core/account.h"
#include "core/math.h"
#include "thickening/continuum.h"
#include "thickening/thickening.h"

static const double TWO_PI = 6.28318530717958647692;

/* Momentum that each plate has taken, in the order of ids, and the number of its particles. */
typedef struct taken {
    double momentum[RHEO__PLATES][3];
    uint32_t particles[RHEO__PLATES];
} taken;

static taken take_momentum(const rheo__state *s)
{
    taken t = {{{0}}, {0}};
    for (uint32_t id = 0; id < s->particles; id++) {
        if (!s->plate[id])
            continue;
        const uint32_t plate = s->plate[id] - 1;
        t.particles[plate]++;
        for (size_t axis = 0; axis < 3; axis++) {
            /* Subtracted as reals: gcc 12 leaves out the rounding of V where it converts two of them back to double. */
            const rheo_real before = plate == RHEO_PLATE_UPPER ? (rheo_real)s->plate_velocity[axis] : 0;
            t.momentum[plate][axis] += (double)(s->velocity[3 * (size_t)id + axis] - before);
        }
    }
    return t;
}

static void move_at_velocity(rheo__state *s, const rheo_world_def *def, double step)
{
    const double phase = *s->plate_phase + step * def->plates.frequency;
    *s->plate_phase = phase < 0x1p50 ? phase - (double)(int64_t)phase : 0;
    for (int axis = 0; axis < 3; axis++) {
        s->plate_displacement[axis] += step * def->plates.velocity[axis];
        s->plate_velocity[axis] = def->plates.velocity[axis];
    }
    s->plate_velocity[0] += TWO_PI * def->plates.frequency * def->plates.amplitude * rheo__cos_turns(*s->plate_phase);
}

static void move_by_stress(rheo__state *s, const rheo__thickening *t, const taken *from, double step)
{
    const double area = (double)t->period->length[0] * (double)t->period->length[2],
                 force = t->def->plates.stress * rheo__number_density(t->def) * area;
    if (from->particles[RHEO_PLATE_UPPER])
        s->plate_velocity[0] +=
            (from->momentum[RHEO_PLATE_UPPER][0] + step * force) / (double)from->particles[RHEO_PLATE_UPPER];
    s->plate_displacement[0] += step * s->plate_velocity[0];
}

void rheo__plate_displacement(const rheo__state *s, const rheo_world_def *def, double displacement[3])
{
    for (int axis = 0; axis < 3; axis++)
        displacement[axis] = s->plate_displacement[axis];
    if (def->plates.control == RHEO_PLATES_VELOCITY)
        displacement[0] += def->plates.amplitude * rheo__sin_turns(*s->plate_phase);
}

static void put_in_place(rheo__state *s, const rheo__thickening *t)
{
    double displacement[3];
    rheo__plate_displacement(s, t->def, displacement);
    for (uint32_t id = 0; id < s->particles; id++) {
        const bool upper = s->plate[id] == RHEO_PLATE_UPPER + 1;
        for (size_t axis = 0; axis < 3 && s->plate[id]; axis++) {
            const size_t at = 3 * (size_t)id + axis;
            const rheo_real length = t->period->length[axis];
            double x = (double)s->start_position[at] + (upper ? displacement[axis] : 0);
            if (length > 0 && s->list_position)
                x -= rheo__periods_away(x - (double)s->list_position[at], length) * (double)length;
            s->position[at] = (rheo_real)x;
            s->velocity[at] = upper ? (rheo_real)s->plate_velocity[axis] : 0;
        }
        if (s->plate[id] && rheo__has_account(s) && s->account->id == id) {
            const rheo_real *x = s->position + 3 * (size_t)id, *v = s->velocity + 3 * (size_t)id;
            rheo__account_set(s, RHEO__FIELD_position, RHEO_SOURCE_PLATE, upper, x[0], x[1], x[2]);
            rheo__account_set(s, RHEO__FIELD_velocity, RHEO_SOURCE_PLATE, upper, v[0], v[1], v[2]);
        }
    }
}

rheo_result rheo__stage_plates(rheo__state *s, void *context)
{
    rheo__thickening *t = context;
    const double step = (double)t->substep;
    const taken from = take_momentum(s);
    for (int plate = 0; plate < RHEO__PLATES; plate++)
        for (int axis = 0; axis < 3; axis++)
            t->diagnostics.plate_force[plate][axis] += from.momentum[plate][axis] / t->def->step;
    if (t->def->plates.control == RHEO_PLATES_STRESS)
        move_by_stress(s, t, &from, step);
    else
        move_at_velocity(s, t->def, step);
    put_in_place(s, t);
    return RHEO_OK;
}

void rheo__plates_begin(rheo__state *s, const rheo_world_def *def, uint32_t first)
{
    for (uint32_t id = first; id < s->particles; id++) {
        rheo_real *x = s->position + 3 * (size_t)id, *v = s->velocity + 3 * (size_t)id;
        const rheo_real low = (rheo_real)def->plates.lower, high = (rheo_real)def->plates.upper;
        const bool lower = x[1]<low, upper = x[1]> high;
        for (size_t axis = 0; axis < 3; axis++)
            s->start_position[3 * (size_t)id + axis] = x[axis];
        s->plate[id] = first ? 0 : lower ? RHEO_PLATE_LOWER + 1 : upper ? RHEO_PLATE_UPPER + 1 : 0;
        for (size_t axis = 0; axis < 3 && s->plate[id]; axis++)
            v[axis] = 0;
    }
}

bool rheo__plates_query(const rheo__state *s, const rheo__thickening *t, uint32_t plate, rheo_plate *values)
{
    if (plate >= RHEO__PLATES || !rheo__state_has(s, RHEO__FIELD_plate))
        return false;
    *values = (rheo_plate){.particles = 0};
    for (uint32_t id = 0; id < s->particles; id++)
        values->particles += s->plate[id] == plate + 1;
    if (plate == RHEO_PLATE_UPPER) {
        rheo__plate_displacement(s, t->def, values->displacement);
        for (int axis = 0; axis < 3; axis++)
            values->velocity[axis] = s->plate_velocity[axis];
    }
    for (int axis = 0; axis < 3; axis++)
        values->force[axis] = t->diagnostics.plate_force[plate][axis];
    return true;
}
