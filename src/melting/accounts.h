/*
 * Accounts (core/account.h) in the loops over rows, within one SIMD variant. In all but `account` these are macros that
 * leave nothing, so that the compiler makes the same instructions as if there were no accounts.
 */
#ifndef RHEO__MELTING_ACCOUNTS_H
#define RHEO__MELTING_ACCOUNTS_H

#include "core/account_lanes.h"
#include "melting/melting.h"

#ifdef RHEO__KEEPS_ACCOUNTS

/* Members of structs, and code that uses them. */
#define RHEO__IN_ACCOUNT(...) __VA_ARGS__

/* Of the row with this rank. */
static inline rheo__keeper rheo__row_keeper(const rheo__state *s, const rheo__melting *m, uint32_t rank)
{
    return rheo__keeper_of(s, &m->pairs, rank);
}
static inline void rheo__row_begins(const rheo__keeper *keeper, uint32_t sum)
{
    rheo__keep_begin(keeper, sum);
}
/* An entry adds a vector or a number to a sum. `partner`: its place in the partners of rows. Idle entries add 0. */
static inline void rheo__row_adds(const rheo__keeper *keeper, uint32_t sum, rheo_source source,
                                  const uint32_t *partner, rheo__lanes3 value)
{
    if (rheo__keeps(keeper))
        rheo__account_add_lanes(keeper->state, sum, source, keeper->pairs->id_of[*partner / RHEO__POINT_VALUES],
                                value);
}
static inline void rheo__row_adds_number(const rheo__keeper *keeper, uint32_t sum, rheo_source source,
                                         const uint32_t *partner, rheo__lanes value)
{
    const rheo__lanes zero = rheo__lanes_all(0);
    rheo__row_adds(keeper, sum, source, partner, (rheo__lanes3){value, zero, zero});
}
/* A sum begins with a number of the row's own particle. */
static inline void rheo__row_begins_with(const rheo__keeper *keeper, uint32_t sum, rheo_source source,
                                         rheo_real value)
{
    if (rheo__keeps(keeper))
        rheo__account_set(keeper->state, sum, source, keeper->state->account->id, value, 0, 0);
}
static inline void rheo__row_scales(const rheo__keeper *keeper, uint32_t sum, rheo_real by)
{
    rheo__keep_scale(keeper, sum, by);
}
static inline void rheo__row_applies(const rheo__keeper *keeper, uint32_t entry, rheo_real by, uint32_t sum)
{
    if (rheo__keeps(keeper))
        rheo__account_apply(keeper->state, entry, RHEO_SOURCE_SUM, by, sum);
}

/* What the particle with this rank adds. */
static inline void rheo__rank_adds(const rheo__state *s, const rheo__melting *m, uint32_t rank, uint32_t entry,
                                   rheo_source source, uint32_t item, rheo_real x, rheo_real y, rheo_real z)
{
    if (rheo__keeps_account(s, &m->pairs, rank))
        rheo__account_add(s, entry, source, item, x, y, z);
}
static inline void rheo__rank_applies(const rheo__state *s, const rheo__melting *m, uint32_t rank, uint32_t entry,
                                      rheo_real by, uint32_t sum)
{
    if (rheo__keeps_account(s, &m->pairs, rank))
        rheo__account_apply(s, entry, RHEO_SOURCE_SUM, by, sum);
}

/* The wall with the largest share in the density of a particle, whose last contact is `last`. It stands for all. */
static inline uint32_t rheo__nearest_wall(const rheo__melting *m, uint32_t last)
{
    uint32_t nearest = last;
    for (uint32_t k = last; k > 0 && m->contact[k - 1].rank == m->contact[last].rank; k--)
        if (m->contact[k - 1].integral.weight >= m->contact[nearest].integral.weight)
            nearest = k - 1;
    return m->contact[nearest].wall;
}

#else

#define RHEO__IN_ACCOUNT(...)
#define rheo__row_keeper(s, m, rank) ((void)(s), (rheo__keeper){0})
#define rheo__row_begins(keeper, ...) ((void)(keeper))
#define rheo__row_adds(keeper, ...) ((void)(keeper))
#define rheo__row_adds_number(keeper, ...) ((void)(keeper))
#define rheo__row_begins_with(keeper, ...) ((void)(keeper))
#define rheo__row_scales(keeper, ...) ((void)(keeper))
#define rheo__row_applies(keeper, ...) ((void)(keeper))
#define rheo__rank_adds(s, ...) ((void)(s))
#define rheo__rank_applies(s, ...) ((void)(s))

#endif
#endif
