/*
 * The account of one particle: what stages added to its values, and for whom, in the order of the additions. Made again
 * from its lines, the values have the bits of the state, so nothing is missing (rheo__account_replay()).
 *
 * Stages keep it only while a state has an account. Loops that are compiled for SIMD variants (core/simd.h) keep it in
 * a further variant `account`, with one lane. In all others rheo__keeps_account() is false for the compiler, which
 * leaves out what depends on it.
 *
 * A number of the account is an entry: a field of the particle, or one of the sums that stages make before they change
 * a field. Entries are triples of reals; those of scalars use the first.
 */
#ifndef RHEO__CORE_ACCOUNT_H
#define RHEO__CORE_ACCOUNT_H

#include "rheolog/why.h"
#include "core/state.h"

/* Fields that have an account. */
#define RHEO__ACCOUNT_FIELDS \
    (RHEO__BIT(position) | RHEO__BIT(velocity) | RHEO__BIT(density) | RHEO__BIT(temperature) | RHEO__BIT(derivative))

/* Sums over the pairs and walls of a particle: name, what it is. */
#define RHEO__ACCOUNT_SUMS(X)                               \
    X(pressure, "acceleration by pressure")                 \
    X(springs, "acceleration by springs")                   \
    X(acceleration, "acceleration")                         \
    X(viscosity, "loss of velocity to neighbours")          \
    X(correction, "displacement by the density constraint") \
    X(displacement, "displacement by all iterations")       \
    X(drift, "velocity of XSPH")                            \
    X(motion, "velocity with that of XSPH")                 \
    X(number_density, "particles per volume")               \
    X(density_rate, "rate of density")                      \
    X(drift_rate, "rate of density by XSPH")                \
    X(heat_rate, "Laplacian of the temperature")            \
    X(past, "weighted sum over the past")

enum rheo__account_entry {
    RHEO__ACCOUNT_FIRST_SUM = RHEO__FIELD_COUNT,
    RHEO__ACCOUNT_BEFORE_SUMS = RHEO__FIELD_COUNT - 1,
#define X(name, meaning) RHEO__SUM_##name,
    RHEO__ACCOUNT_SUMS(X)
#undef X
        RHEO__ACCOUNT_ENTRIES
};

typedef enum rheo__account_operation {
    RHEO__ACCOUNT_SET,   /* entry = value */
    RHEO__ACCOUNT_ADD,   /* entry += value */
    RHEO__ACCOUNT_APPLY, /* entry += value[0] x other entry */
    RHEO__ACCOUNT_SCALE, /* entry *= value[0] */
} rheo__account_operation;

typedef struct rheo__account_line {
    uint8_t operation, entry, other; /* other: of APPLY */
    uint8_t source;                  /* rheo_source */
    uint32_t item;                   /* of the source */
    rheo_real value[3];
} rheo__account_line;

typedef rheo_real rheo__account_values[RHEO__ACCOUNT_ENTRIES][3];

/* What a stage run did to the particle. */
typedef struct rheo__account_stage {
    char name[32];                      /* of the stage run */
    size_t first, end;                  /* its lines */
    bool holds;                         /* made again from the lines, the fields have the bits of the state */
    rheo__account_values before, after; /* of the fields; the sums are as the lines leave them */
} rheo__account_stage;

typedef struct rheo__account {
    rheo_allocator allocator;
    uint32_t id; /* the particle */
    rheo__account_line *line;
    size_t count, capacity;
    rheo__account_stage *stage;
    size_t stages, stage_capacity;
    bool no_memory; /* something is missing */
} rheo__account;

/* Whether this code is compiled to keep accounts. */
#ifdef RHEO__KEEPS_ACCOUNTS
#define RHEO__ACCOUNTS_HERE 1
#else
#define RHEO__ACCOUNTS_HERE 0
#endif

/* Whether a SIMD loop keeps the account of the particle with this rank. */
static inline bool rheo__keeps_account(const rheo__state *s, const rheo__pairs *pairs, uint32_t rank)
{
    return RHEO__ACCOUNTS_HERE && s->account && rank < pairs->rows && pairs->id_of[rank] == s->account->id;
}
/* Whether a particle of the state has an account; for any code, since it is asked for once in a stage. */
static inline bool rheo__has_account(const rheo__state *s)
{
    return s->account && s->account->id < s->particles;
}

/* Adds a line. The item of a source is explained in rheolog/why.h. */
void rheo__account_set(const rheo__state *s, uint32_t entry, rheo_source source, uint32_t item, rheo_real x,
                       rheo_real y, rheo_real z);
void rheo__account_add(const rheo__state *s, uint32_t entry, rheo_source source, uint32_t item, rheo_real x,
                       rheo_real y, rheo_real z);
void rheo__account_apply(const rheo__state *s, uint32_t entry, rheo_source source, rheo_real by, uint32_t other);
void rheo__account_scale(const rheo__state *s, uint32_t entry, rheo_real by);
/* Adds to a value of the field what the lines of the stage run so far lack of `to`, bit for bit. */
void rheo__account_add_rest(const rheo__state *s, rheo__field_id field, rheo_source source, const rheo_real to[3]);
/* A sum begins. */
static inline void rheo__account_begin(const rheo__state *s, uint32_t sum)
{
    rheo__account_set(s, sum, RHEO_SOURCE_NONE, 0, 0, 0, 0);
}
/* The field becomes `by` times a sum. -0 + x is x, also for x = -0. */
static inline void rheo__account_renew(const rheo__state *s, uint32_t field, rheo_source source, rheo_real by,
                                       uint32_t sum)
{
    const rheo_real nothing = -RHEO__R(0.0);
    rheo__account_set(s, field, RHEO_SOURCE_NONE, 0, nothing, nothing, nothing);
    rheo__account_apply(s, field, source, by, sum);
}

/* Are called before and after a stage run of a state with an account; without the particle they do nothing. */
void rheo__account_open(const rheo__state *s, const char *name);
void rheo__account_close(const rheo__state *s);
/* Does the operations of lines [from, to). */
void rheo__account_replay(const rheo__account *account, size_t from, size_t to, rheo__account_values values);
void rheo__account_release(rheo__account *account);

#endif
