/*
 * Writes springs as lines between particles, as VTP. Each line has the ids of its ends, its length and rest length, how
 * much longer than at rest it is, and the stiffness that the history gives it.
 */
#include <stdlib.h>
#include <string.h>

#include "view/vtp.h"

enum { VALUES = 6 };
static const char *const NAMES[VALUES] = {"length", "rest_length", "stretch", "history_rate", "stiffness", "kappa"};

static void put_real(rheo__output *out, rheo_real value)
{
#if RHEO_DOUBLE
    uint64_t bits;
#else
    uint32_t bits;
#endif
    _Static_assert(sizeof bits == sizeof value, "the bits of a real");
    memcpy(&bits, &value, sizeof bits);
    rheo__output_little(out, bits, sizeof bits);
}

static rheo_real value_of(const rheo_spring_state *s, int value)
{
    const rheo_real rest_length = s->spring.rest_length;
    const double of[VALUES] = {s->length,       (double)rest_length, s->length - (double)rest_length,
                               s->history_rate, s->stiffness,        s->kappa};
    return (rheo_real)of[value];
}

static void put_values(const rheo__vtp *vtp, const rheo_world *world, const rheo_spring_state *springs, size_t count)
{
    const size_t points = rheo_world_particle_count(world);
    for (int v = 0; v < VALUES; v++) {
        rheo__vtp_begin_array(vtp, (uint64_t)count * sizeof(rheo_real));
        for (size_t i = 0; i < count; i++)
            put_real(vtp->out, value_of(&springs[i], v));
    }
    rheo__vtp_begin_array(vtp, 3 * (uint64_t)points * sizeof(rheo_real));
    for (size_t i = 0; i < points; i++) {
        const rheo_real *x = rheo_world_positions(world) + 3 * i;
        double turned[3] = {(double)x[0], (double)x[1], (double)x[2]};
        rheo__output_turn(vtp->out, turned);
        for (int axis = 0; axis < 3; axis++)
            put_real(vtp->out, (rheo_real)turned[axis]);
    }
    rheo__vtp_begin_array(vtp, (uint64_t)count * 16);
    for (size_t i = 0; i < count; i++) {
        rheo__output_little(vtp->out, springs[i].spring.a, 8);
        rheo__output_little(vtp->out, springs[i].spring.b, 8);
    }
    rheo__vtp_progression(vtp, 2, 2, count, 8);
}

static void write_lines(rheo__output *out, const rheo_world *world, const rheo_spring_state *springs, size_t count)
{
    const rheo_element real = RHEO_DOUBLE ? RHEO_ELEMENT_F64 : RHEO_ELEMENT_F32;
    const uint32_t points = rheo_world_particle_count(world);
    rheo__vtp vtp = rheo__vtp_begin(out, world, points, 0, count, 0);
    rheo__vtp_open(&vtp, "CellData", " Scalars=\"stiffness\"");
    for (int v = 0; v < VALUES; v++)
        rheo__vtp_declare(&vtp, real, NAMES[v], 1, (uint64_t)count * sizeof(rheo_real));
    rheo__vtp_close(&vtp, "CellData");
    rheo__vtp_open(&vtp, "Points", "");
    rheo__vtp_declare(&vtp, real, "position", 3, 3 * (uint64_t)points * sizeof(rheo_real));
    rheo__vtp_close(&vtp, "Points");
    rheo__vtp_declare_cells(&vtp, "Lines", 2 * (uint64_t)count, count);
    rheo__vtp_begin_values(&vtp);
    put_values(&vtp, world, springs, count);
    rheo__vtp_end(&vtp);
}

/* Whether a line between the ends would go the wrong way round periodic space. */
static bool crosses_border(const rheo_world *world, const rheo_spring *spring)
{
    const rheo_real *a = rheo_world_positions(world) + 3 * (size_t)spring->a,
                    *b = rheo_world_positions(world) + 3 * (size_t)spring->b;
    bool crosses = false;
    for (int axis = 0; axis < 3; axis++) {
        const double period = rheo_world_definition(world)->space.period[axis], d = (double)(b[axis] - a[axis]);
        crosses = crosses || (period > 0 && (d > period / 2 || d < -period / 2));
    }
    return crosses;
}

/* Reads the springs that can be drawn as lines; *count, at first the number of all, becomes theirs. */
static rheo_result read_states(const rheo_world *world, rheo_spring *springs, rheo_spring_state *states,
                               size_t *count, rheo_error *error)
{
    const size_t all = *count;
    if (!springs || !states)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for the states of %zu springs", all);
    const rheo_result listed = rheo_world_springs(world, springs, all);
    if (listed != RHEO_OK)
        return rheo__fail(error, listed, "no memory for a list of %zu springs", all);
    *count = 0;
    for (size_t i = 0; i < all; i++) {
        if (crosses_border(world, &springs[i]))
            continue;
        RHEO__TRY(rheo_world_spring(world, springs[i].a, springs[i].b, &states[*count], error));
        ++*count;
    }
    return RHEO_OK;
}

rheo_result rheo__write_springs(rheo__output *out, const rheo_world *world, rheo_error *error)
{
    size_t count = rheo_world_spring_count(world);
    rheo_spring *springs = calloc(count + 1, sizeof *springs);
    rheo_spring_state *states = calloc(count + 1, sizeof *states);
    const rheo_result result = read_states(world, springs, states, &count, error);
    if (result == RHEO_OK)
        write_lines(out, world, states, count);
    free(springs);
    free(states);
    return result;
}
