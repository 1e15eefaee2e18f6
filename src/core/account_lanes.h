/* Accounts in loops over rows and pairs, within one SIMD variant; in all but `account` nothing is left of them. */
#ifndef RHEO__CORE_ACCOUNT_LANES_H
#define RHEO__CORE_ACCOUNT_LANES_H

#include "core/account.h"
#include "core/lane_points.h"

/* The row of the particle that has an account; `state` is NULL for other rows. */
typedef struct rheo__keeper {
    const rheo__state *state;
    const rheo__pairs *pairs;
} rheo__keeper;

static inline rheo__keeper rheo__keeper_of(const rheo__state *s, const rheo__pairs *pairs, uint32_t rank)
{
    return (rheo__keeper){rheo__keeps_account(s, pairs, rank) ? s : NULL, pairs};
}
static inline bool rheo__keeps(const rheo__keeper *keeper)
{
    return RHEO__ACCOUNTS_HERE && keeper->state;
}
/* Whether a stage keeps an account at all. */
static inline bool rheo__keeps_any(const rheo__state *s)
{
    return RHEO__ACCOUNTS_HERE && rheo__has_account(s);
}
static inline void rheo__keep_begin(const rheo__keeper *keeper, uint32_t sum)
{
    if (rheo__keeps(keeper))
        rheo__account_begin(keeper->state, sum);
}
static inline void rheo__keep_scale(const rheo__keeper *keeper, uint32_t sum, rheo_real by)
{
    if (rheo__keeps(keeper))
        rheo__account_scale(keeper->state, sum, by);
}
/* The first lane of a vector. */
static inline void rheo__account_add_lanes(const rheo__state *s, uint32_t entry, rheo_source source, uint32_t item,
                                           rheo__lanes3 v)
{
    rheo__account_add(s, entry, source, item, RHEO__LANE(v.x, 0), RHEO__LANE(v.y, 0), RHEO__LANE(v.z, 0));
}
/*
 * The entry of a row adds by x d to a sum. An idle entry adds 0, which has no line, or NaN if the squared distance of the
 * row from RHEO__NOWHERE overflows. It has no partner, so that is told of the particle itself.
 */
static inline void rheo__keep_pair(const rheo__keeper *keeper, uint32_t sum, rheo_source source, size_t entry,
                                   rheo__lanes by, rheo__lanes3 d)
{
    if (!rheo__keeps(keeper))
        return;
    const uint32_t partner = rheo__pairs_partner(keeper->pairs, entry);
    rheo__account_add(keeper->state, sum, source,
                      partner < keeper->pairs->rows ? keeper->pairs->id_of[partner] : keeper->state->account->id,
                      RHEO__LANE(by, 0) * RHEO__LANE(d.x, 0), RHEO__LANE(by, 0) * RHEO__LANE(d.y, 0),
                      RHEO__LANE(by, 0) * RHEO__LANE(d.z, 0));
}
/* One pair of a list of width 1: rank i loses something of a field, and rank j gains it. */
static inline void rheo__keep_exchange(const rheo__state *s, const rheo__pairs *pairs, rheo__field_id field,
                                       rheo_source source, uint32_t i, uint32_t j, rheo__lanes3 loses)
{
    if (rheo__keeps_account(s, pairs, i))
        rheo__account_add_lanes(s, field, source, pairs->id_of[j], (rheo__lanes3){-loses.x, -loses.y, -loses.z});
    if (rheo__keeps_account(s, pairs, j))
        rheo__account_add_lanes(s, field, source, pairs->id_of[i], loses);
}

#endif
