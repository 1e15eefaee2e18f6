/* How large a recording is, and how large it will become, from the numbers of items in the world. */
#include "record/recorder.h"

uint64_t rheo_recorder_bytes(const rheo_recorder *r)
{
    return r->unresumed ? r->resume : r->writer.written;
}

enum { SPRINGS = 12 }; /* of a particle in a fluid */

/* Estimated bytes of a keyframe with so many rows of history; springs: they have formed. Flat fields shrink by about a quarter. */
static double keyframe_bytes(const rheo_world *world, uint64_t rows, bool springs)
{
    const rheo__state *s = &world->state;
    double flat = 0;
    for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT; f++)
        if (rheo__state_has(s, f) && !rheo__in_rows(f) &&
            (springs || rheo__field_table[f].location != RHEO_LOCATION_SPRING))
            flat += 0.75 * (double)rheo__state_row_bytes(s, f);
    if (springs && rheo__state_has(s, RHEO__FIELD_spring_ends) &&
        s->springs.count == 0) /* they form in the first steps */
        flat += 0.75 * (8 + sizeof(rheo_real)) * SPRINGS * (double)s->particles;
    return flat + 3. * sizeof(rheo_real) * (double)s->particles * ((double)s->modes.length + (double)rows);
}

/* Bytes of all keyframes in the next steps, after those that were made. The ring fills by a row a step. */
static double all_keyframes_bytes(const rheo_world *world, uint64_t spacing, uint64_t made, uint64_t steps)
{
    const rheo__state *s = &world->state;
    const uint64_t end = made + steps;
    uint64_t rows = s->present & RHEO__RING_FIELDS ? *s->history_rows : 0;
    double sum = 0;
    uint64_t at = made, next = made - made % spacing + spacing;
    while (next <= end && rows < s->ring.length) {
        rows = s->ring.length - rows < next - at ? s->ring.length : rows + (next - at);
        sum += keyframe_bytes(world, rows, true);
        at = next;
        if (next > UINT64_MAX - spacing)
            return sum;
        next += spacing;
    }
    const double left = next <= end ? (double)((end - next) / spacing + 1) : 0;
    return sum + left * keyframe_bytes(world, s->ring.length, true);
}

/* Bytes of a step before any is written: hashes of its substeps, metrics, and what --full adds to each particle. */
static double first_step_bytes(const rheo_world *world, double substeps, bool full)
{
    double hashes = 0;
    for (uint32_t i = 0; i < world->stage_count; i++)
        hashes += __builtin_popcountll(world->stage[i].writes) *
                  (rheo__world_phase(world, i) == RHEO__IN_SUBSTEPS ? substeps : 1);
    return 44 + 8. * (hashes + rheo_world_metric_count(world)) +
           (full ? 12. * sizeof(rheo_real) * world->state.particles : 0);
}

static double step_bytes(const rheo_recorder *r)
{
    return r->steps ? (double)r->step_bytes / (double)r->steps : first_step_bytes(r->world, 2, r->full);
}

double rheo_recorder_expected_bytes(const rheo_recorder *r, uint64_t steps)
{
    return (double)rheo_recorder_bytes(r) +
           all_keyframes_bytes(r->world, r->spacing, r->step - r->first_step, steps) + (double)steps * step_bytes(r) +
           100;
}

double rheo_recorder_expected_fewest_bytes(const rheo_recorder *r, uint64_t steps)
{
    const double keyframes = all_keyframes_bytes(r->world, r->spacing, r->step - r->first_step, steps) +
                             (double)rheo__limit_removable_bytes(r),
                 newest = keyframe_bytes(r->world, r->world->state.ring.length, true);
    return rheo_recorder_expected_bytes(r, steps) - keyframes + (keyframes < newest ? keyframes : newest);
}

uint64_t rheo__recorder_spacing(const rheo_world *world)
{
    const rheo__state *s = &world->state;
    bool springs = rheo__state_has(s, RHEO__FIELD_spring_ends);
    uint64_t rows = (uint64_t)s->ring.length + s->modes.length;
    uint64_t spacing = rheo__keyframe_cost(sizeof(rheo_real), rows, springs) / (RHEO__STEP_COST * 2 / 100) + 1;
    return spacing < 16 ? 16 : spacing;
}

/*
 * The first keyframe has no history, but the rows of decaying sums, which do not shrink. Of a lattice that has not
 * settled it has no springs and no velocities, either.
 */
double rheo_recording_expected_bytes(const rheo_world *world, uint64_t steps, bool settled, double particles,
                                     double substeps)
{
    const uint64_t spacing = rheo__recorder_spacing(world);
    const double own = (double)world->state.particles, head = 4096,
                 sums = 3. * sizeof(rheo_real) * own * (double)world->state.modes.length,
                 first = sums + (settled ? 0.45 : 0.25) * (keyframe_bytes(world, 0, settled) - sums),
                 keyframes = first + all_keyframes_bytes(world, spacing, 0, steps);
    return head + keyframes * (own > 0 ? particles / own : 1) +
           (double)steps * first_step_bytes(world, substeps > 0 ? substeps : 2, false);
}
