/*
 * The state: one table of fields. Every piece of state that the next step reads is a line of RHEO_FIELDS; allocating,
 * hashing, saving, loading, comparing and undoing are loops over that table.
 *
 * Between stages, particle fields stand in the order of ids. Springs stand in the rank order of the step that made
 * them (core/springs.h), the ring of histories and the modes of a memory in blocks (core/ring.h); all are seen from
 * outside in the order of ids.
 */
#ifndef RHEO_CORE_STATE_H
#define RHEO_CORE_STATE_H

#include "rheolog/world.h"
#include "core/memory.h"
#include "core/ring.h"
#include "core/springs.h"

#if RHEO_DOUBLE
#define RHEO_ELEMENT_REAL RHEO_ELEMENT_F64
#else
#define RHEO_ELEMENT_REAL RHEO_ELEMENT_F32
#endif

/* name, C type, element, components, per, storage */
#define RHEO_FIELDS(X)                                                                   \
    X(step, uint64_t, RHEO_ELEMENT_U64, 1, RHEO_PER_WORLD, RHEO_FLAT)                    \
    X(step_origin, uint64_t, RHEO_ELEMENT_U64, 1, RHEO_PER_WORLD, RHEO_FLAT)             \
    X(time_origin, double, RHEO_ELEMENT_F64, 1, RHEO_PER_WORLD, RHEO_FLAT)               \
    X(position, rheo_real, RHEO_ELEMENT_REAL, 3, RHEO_PER_PARTICLE, RHEO_FLAT)           \
    X(velocity, rheo_real, RHEO_ELEMENT_REAL, 3, RHEO_PER_PARTICLE, RHEO_FLAT)           \
    X(spring_ends, uint32_t, RHEO_ELEMENT_U32, 2, RHEO_PER_SPRING, RHEO_SPRING)          \
    X(spring_rest_length, rheo_real, RHEO_ELEMENT_REAL, 1, RHEO_PER_SPRING, RHEO_SPRING) \
    X(ball_position, rheo_real, RHEO_ELEMENT_REAL, 3, RHEO_PER_BODY, RHEO_FLAT)          \
    X(ball_velocity, rheo_real, RHEO_ELEMENT_REAL, 3, RHEO_PER_BODY, RHEO_FLAT)          \
    X(ball_spin, rheo_real, RHEO_ELEMENT_REAL, 3, RHEO_PER_BODY, RHEO_FLAT)              \
    X(ball_orientation, rheo_real, RHEO_ELEMENT_REAL, 4, RHEO_PER_BODY, RHEO_FLAT)       \
    X(source_position, rheo_real, RHEO_ELEMENT_REAL, 2, RHEO_PER_SOURCE, RHEO_FLAT)      \
    X(source_phase, rheo_real, RHEO_ELEMENT_REAL, 1, RHEO_PER_SOURCE, RHEO_FLAT)         \
    X(source_frequency, rheo_real, RHEO_ELEMENT_REAL, 1, RHEO_PER_SOURCE, RHEO_FLAT)     \
    X(random, uint64_t, RHEO_ELEMENT_U64, 1, RHEO_PER_WORLD, RHEO_FLAT)                  \
    X(history_rows, uint64_t, RHEO_ELEMENT_U64, 1, RHEO_PER_WORLD, RHEO_FLAT)            \
    X(history_velocity, rheo_real, RHEO_ELEMENT_REAL, 3, RHEO_PER_PARTICLE, RHEO_RING)   \
    X(history_modes, rheo_real, RHEO_ELEMENT_REAL, 3, RHEO_PER_PARTICLE, RHEO_MODES)     \
    X(density, rheo_real, RHEO_ELEMENT_REAL, 1, RHEO_PER_PARTICLE, RHEO_FLAT)            \
    X(temperature, rheo_real, RHEO_ELEMENT_REAL, 1, RHEO_PER_PARTICLE, RHEO_FLAT)        \
    X(start_position, rheo_real, RHEO_ELEMENT_REAL, 3, RHEO_PER_PARTICLE, RHEO_FLAT)     \
    X(substeps, uint64_t, RHEO_ELEMENT_U64, 1, RHEO_PER_WORLD, RHEO_FLAT)                \
    X(iterations, uint64_t, RHEO_ELEMENT_U64, 1, RHEO_PER_WORLD, RHEO_FLAT)

typedef enum rheo_field_id {
#define X(name, type, element, components, per, storage) RHEO_FIELD_##name,
    RHEO_FIELDS(X)
#undef X
        RHEO_FIELD_COUNT
} rheo_field_id;

#define RHEO_BIT(name) (UINT32_C(1) << RHEO_FIELD_##name)
_Static_assert(RHEO_FIELD_COUNT <= 32, "sets of fields are 32-bit masks");

/* Modes: a fixed number of rows that lie as those of a ring do, all of which change in a step. */
typedef enum rheo_storage { RHEO_FLAT, RHEO_SPRING, RHEO_RING, RHEO_MODES } rheo_storage;

typedef struct rheo_field {
    const char *name;
    size_t offset; /* of the pointer to a flat field's values in rheo_state */
    rheo_element element;
    uint32_t components;
    rheo_per per;
    rheo_storage storage;
} rheo_field;

extern const rheo_field rheo_field_table[RHEO_FIELD_COUNT];

/* Why a stage will not go on with the state that it finds, and what of it is to blame. */
typedef struct rheo_refusal {
    rheo_field_id field;
    uint64_t item;
    char why[192];
} rheo_refusal;

typedef struct rheo_state {
    rheo_allocator allocator;
    uint32_t present; /* set of fields this world has */
    uint32_t particles, capacity;
    uint32_t bodies, sources;

    /* One pointer a field; NULL where the world does not have it and for springs, rings and modes. */
#define X(name, type, element, components, per, storage) type *name;
    RHEO_FIELDS(X)
#undef X
    /* The same flat fields as they were when the step began: xprev of the model, and what a failed step goes back to.
     */
    void *before[RHEO_FIELD_COUNT];

    rheo_springs springs;       /* the springs */
    rheo_springs springs_other; /* those before this step, or the list that is being built */
    bool springs_stepped;       /* this step has exchanged the two */
    rheo_ring ring;
    rheo_ring modes; /* a ring that never turns: its rows stay filled, and where they are */

    rheo_refusal refusal; /* of the last stage that returned RHEO_ERROR_STATE */

    rheo_real *grip; /* derived, by id: how much of its history stiffness a particle holds to walls with; or NULL */
} rheo_state;

size_t rheo_element_size(rheo_element element);
/* The bits of value `index`, and what number they are. */
uint64_t rheo_element_bits(rheo_element element, const void *values, size_t index);
double rheo_element_number(rheo_element element, uint64_t bits);
/* How many numbers of the type lie between two: units in the last place. UINT64_MAX for a NaN. */
uint64_t rheo_element_distance(rheo_element element, uint64_t a, uint64_t b);
static inline bool rheo_state_has(const rheo_state *s, rheo_field_id field)
{
    return (s->present >> field) & 1;
}

/* Prepares an empty state with these fields. window: d, if there is a ring; modes: rows, if there are modes. */
void rheo_state_init(rheo_state *s, const rheo_allocator *allocator, uint32_t present, uint32_t window,
                     uint32_t modes);
void rheo_state_release(rheo_state *s);
/* Sets the numbers of particles, bodies and sources; new items are zero. On failure nothing has changed. */
bool rheo_state_resize(rheo_state *s, uint32_t particles, uint32_t bodies, uint32_t sources);

/* Items of a field (particles, springs, ...), filled rows (1 but for rings and modes), bytes of a row. */
uint64_t rheo_state_items(const rheo_state *s, rheo_field_id field);
uint64_t rheo_state_rows(const rheo_state *s, rheo_field_id field);
size_t rheo_state_row_bytes(const rheo_state *s, rheo_field_id field);

/* Whether a field lies in rows, and those rows. */
static inline bool rheo_in_rows(rheo_field_id field)
{
    return rheo_field_table[field].storage == RHEO_RING || rheo_field_table[field].storage == RHEO_MODES;
}
static inline const rheo_ring *rheo_state_ring(const rheo_state *s, rheo_field_id field)
{
    return rheo_field_table[field].storage == RHEO_RING ? &s->ring : &s->modes;
}

/*
 * Speeds that a memory of modes can bear: their sums, which no step can take back, stay finite. What is loaded may be
 * as large as the sums get.
 */
#if RHEO_DOUBLE
#define RHEO_LARGEST_SPEED 0x1p960
#define RHEO_LARGEST_MODE 0x1p1000
#else
#define RHEO_LARGEST_SPEED 0x1p90F
#define RHEO_LARGEST_MODE 0x1p124F
#endif

/* Values of a flat field; what the pointer points to is in the order of ids. */
static inline void *rheo_state_values(const rheo_state *s, rheo_field_id field)
{
    void *values;
    __builtin_memcpy(&values, (const char *)s + rheo_field_table[field].offset, sizeof values);
    return values;
}

/* One row in the order of ids (springs by smaller, then larger id; ring rows by lag, 0 the newest; modes by number).
 * False: no memory.
 */
bool rheo_state_read_row(const rheo_state *s, rheo_field_id field, uint64_t row, void *values);
/* Sets one row of a flat field, a ring (whose history_rows must be set first) or modes. Springs: rheo_springs_set().
 */
void rheo_state_write_row(rheo_state *s, rheo_field_id field, uint64_t row, const void *values);

/* Remembers the flat fields at the start of a step, and goes back to them. */
void rheo_state_begin(rheo_state *s);
void rheo_state_undo(rheo_state *s);

/* ---- Hashes (core/field_hash.c) ---- */

/* The hash of a whole field. */
uint64_t rheo_state_hash_field(const rheo_state *s, rheo_field_id field);
/* The hashes of a set of fields, in the order of the table; of a ring row 0 alone, as a plain field of that one row;
 * of modes all rows. */
void rheo_state_hash_newest(const rheo_state *s, uint32_t fields, uint64_t *hashes);
/* The hash of everything. */
uint64_t rheo_state_hash(const rheo_state *s);

/* One component that has another value elsewhere; of springs 1 and 0 say who has it. */
typedef struct rheo_solution {
    uint64_t id, other_id; /* other_id: larger id of a spring */
    uint32_t component;    /* of modes: row x 3 + axis */
    uint64_t own, other;   /* bits */
    uint64_t count;        /* items that differ */
} rheo_solution;

/*
 * Which one component (or spring), had it another value, would give this hash of row 0, of modes of all rows? False:
 * none, so more than one differs; or no memory. With 20 000 particles a wrong answer has a chance of 5e-7 or less.
 */
bool rheo_state_solve(const rheo_state *s, rheo_field_id field, uint64_t other_hash, rheo_solution *solution);

/* Looks for a NaN or an infinity in the flat fields, and for a speed that modes cannot bear; false and where it is,
 * if there is one. */
bool rheo_state_finite(const rheo_state *s, rheo_field_id *field, uint64_t *item, uint32_t *component);

#endif
