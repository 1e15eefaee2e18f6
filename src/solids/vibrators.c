/*
 * Stage vibrators: advances the vibrators under the floor, each with a phase and a frequency f that walks at random
 * within f0 (1 +- spread) (docs/model.md, Vibrators). The phase is in turns. The kind RHEO_VIBRATOR_FORCE pushes
 * particles below `height` here; the kind RHEO_VIBRATOR_FLOOR moves the floor, which stage walls reads.
 */
#include "solids/solids.h"

#include "core/account.h"
#include "core/math.h"

static const double TWO_PI = 6.28318530717958647692;

/* splitmix64 (Steele, Lea, Flood 2014); a number in [0, 1) with 24 bits, exact in float. */
static rheo_real random_unit(uint64_t *random)
{
    uint64_t x = *random += UINT64_C(0x9E3779B97F4A7C15);
    x = (x ^ x >> 30) * UINT64_C(0xBF58476D1CE4E5B9);
    x = (x ^ x >> 27) * UINT64_C(0x94D049BB133111EB);
    x ^= x >> 31;
    return (rheo_real)(uint32_t)(x >> 40) * RHEO__R(1.0 / (1 << 24));
}

void rheo__vibrators_begin(const rheo__solids *solids, rheo__state *s)
{
    const rheo_real frequency = (rheo_real)solids->def->vibrators.frequency,
                    spread = (rheo_real)solids->def->vibrators.spread;
    for (uint32_t i = 0; i < s->vibrators; i++)
        s->vibrator_frequency[i] = frequency * (1 + spread * (2 * random_unit(s->random) - 1));
}

static void advance(rheo__state *s, rheo__solids *solids, uint32_t i)
{
    const rheo_world_def *def = solids->def;
    const rheo_real frequency = (rheo_real)def->vibrators.frequency, spread = (rheo_real)def->vibrators.spread,
                    step = *solids->substep, wander = (rheo_real)def->vibrators.wander * rheo__sqrt(step);
    const rheo_real lowest = frequency * (1 - spread), highest = frequency * (1 + spread);
    rheo_real f = s->vibrator_frequency[i];
    f += frequency * wander * (2 * random_unit(s->random) - 1);
    /* Reflected at the ends of the band; clamped in case a command has narrowed it. */
    f = f > highest ? 2 * highest - f : f;
    f = f < lowest ? 2 * lowest - f : f;
    f = rheo__min(rheo__max(f, lowest), highest);
    s->vibrator_frequency[i] = f;

    rheo_real phase = s->vibrator_phase[i] + rheo__min(f * step, 1 << 20);
    phase -= (rheo_real)(int32_t)phase;
    s->vibrator_phase[i] = phase;
    solids->wave[i] = (rheo_real)rheo__sin_turns((double)phase);
    solids->wave_rate[i] = (rheo_real)(TWO_PI * (double)f * rheo__cos_turns((double)phase));
}

static void push(rheo__state *s, const rheo__solids *solids)
{
    const rheo_world_def *def = solids->def;
    const rheo_real step = *solids->substep, amplitude = (rheo_real)def->vibrators.amplitude,
                    radius = (rheo_real)def->vibrators.radius, radius2 = radius * radius,
                    height = (rheo_real)def->vibrators.height;
    rheo_real gain[RHEO_MAX_VIBRATORS];
    for (uint32_t i = 0; i < s->vibrators; i++) {
        rheo_real rate = (rheo_real)(TWO_PI * (double)s->vibrator_frequency[i]);
        gain[i] = step * amplitude * (rate * rate) * solids->wave[i];
    }
    for (uint32_t id = 0; id < s->particles; id++) {
        const rheo_real *x = s->position + 3 * (size_t)id;
        if (!(x[1] < height))
            continue;
        for (uint32_t i = 0; i < s->vibrators; i++) {
            rheo_real dx = x[0] - s->vibrator_position[2 * i], dz = x[2] - s->vibrator_position[2 * i + 1];
            rheo_real distance2 = dx * dx + dz * dz;
            if (!(distance2 < radius2))
                continue;
            const rheo_real by = gain[i] * (1 - distance2 / radius2);
            s->velocity[3 * (size_t)id + 1] += by;
            if (rheo__has_account(s) && s->account->id == id) /* adding -0 changes nothing */
                rheo__account_add(s, RHEO__FIELD_velocity, RHEO_SOURCE_VIBRATOR, i, -RHEO__R(0.0), by, -RHEO__R(0.0));
        }
    }
}

rheo_result rheo__stage_vibrators(rheo__state *s, void *context)
{
    rheo__solids *solids = context;
    for (uint32_t i = 0; i < s->vibrators; i++)
        advance(s, solids, i);
    if (solids->def->vibrators.kind == RHEO_VIBRATOR_FORCE)
        push(s, solids);
    return RHEO_OK;
}
