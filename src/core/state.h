/*
 * The state: one table of fields. Every piece of state that the next step reads is a line of RHEO__FIELDS;
 * allocating, hashing, saving, loading, comparing and undoing are loops over that table.
 *
 * Between stages, particle fields are in the order of ids. Springs are in the rank order of the step that made them
 * (core/springs.h), the ring of histories and the modes of a memory in blocks (core/ring.h). Files and queries see
 * all of them in the order of ids.
 */
#ifndef RHEO__CORE_STATE_H
#define RHEO__CORE_STATE_H

#include "rheolog/world.h"
#include "core/memory.h"
#include "core/ring.h"
#include "core/springs.h"

#if RHEO_DOUBLE
#define RHEO__ELEMENT_REAL RHEO_ELEMENT_F64
#else
#define RHEO__ELEMENT_REAL RHEO_ELEMENT_F32
#endif

/* name, C type, element, components, per, storage */
#define RHEO__FIELDS(X)                                                                                \
    X(step, uint64_t, RHEO_ELEMENT_U64, 1, RHEO_LOCATION_WORLD, RHEO__FLAT)                            \
    X(step_origin, uint64_t, RHEO_ELEMENT_U64, 1, RHEO_LOCATION_WORLD, RHEO__FLAT)                     \
    X(time_origin, double, RHEO_ELEMENT_F64, 1, RHEO_LOCATION_WORLD, RHEO__FLAT)                       \
    X(position, rheo_real, RHEO__ELEMENT_REAL, 3, RHEO_LOCATION_PARTICLE, RHEO__FLAT)                  \
    X(velocity, rheo_real, RHEO__ELEMENT_REAL, 3, RHEO_LOCATION_PARTICLE, RHEO__FLAT)                  \
    X(spring_ends, uint32_t, RHEO_ELEMENT_U32, 2, RHEO_LOCATION_SPRING, RHEO__SPRING)                  \
    X(spring_rest_length, rheo_real, RHEO__ELEMENT_REAL, 1, RHEO_LOCATION_SPRING, RHEO__SPRING)        \
    X(ball_position, rheo_real, RHEO__ELEMENT_REAL, 3, RHEO_LOCATION_BODY, RHEO__FLAT)                 \
    X(ball_velocity, rheo_real, RHEO__ELEMENT_REAL, 3, RHEO_LOCATION_BODY, RHEO__FLAT)                 \
    X(ball_spin, rheo_real, RHEO__ELEMENT_REAL, 3, RHEO_LOCATION_BODY, RHEO__FLAT)                     \
    X(ball_orientation, rheo_real, RHEO__ELEMENT_REAL, 4, RHEO_LOCATION_BODY, RHEO__FLAT)              \
    X(vibrator_position, rheo_real, RHEO__ELEMENT_REAL, 2, RHEO_LOCATION_VIBRATOR, RHEO__FLAT)         \
    X(vibrator_phase, rheo_real, RHEO__ELEMENT_REAL, 1, RHEO_LOCATION_VIBRATOR, RHEO__FLAT)            \
    X(vibrator_frequency, rheo_real, RHEO__ELEMENT_REAL, 1, RHEO_LOCATION_VIBRATOR, RHEO__FLAT)        \
    X(random, uint64_t, RHEO_ELEMENT_U64, 1, RHEO_LOCATION_WORLD, RHEO__FLAT)                          \
    X(history_rows, uint64_t, RHEO_ELEMENT_U64, 1, RHEO_LOCATION_WORLD, RHEO__FLAT)                    \
    X(history_velocity, rheo_real, RHEO__ELEMENT_REAL, 3, RHEO_LOCATION_PARTICLE, RHEO__RING)          \
    X(history_modes, rheo_real, RHEO__ELEMENT_REAL, 3, RHEO_LOCATION_PARTICLE, RHEO__MODES)            \
    X(density, rheo_real, RHEO__ELEMENT_REAL, 1, RHEO_LOCATION_PARTICLE, RHEO__FLAT)                   \
    X(temperature, rheo_real, RHEO__ELEMENT_REAL, 1, RHEO_LOCATION_PARTICLE, RHEO__FLAT)               \
    X(start_position, rheo_real, RHEO__ELEMENT_REAL, 3, RHEO_LOCATION_PARTICLE, RHEO__FLAT)            \
    X(substeps, uint64_t, RHEO_ELEMENT_U64, 1, RHEO_LOCATION_WORLD, RHEO__FLAT)                        \
    X(iterations, uint64_t, RHEO_ELEMENT_U64, 1, RHEO_LOCATION_WORLD, RHEO__FLAT)                      \
    X(derivative, rheo_real, RHEO__ELEMENT_REAL, 3, RHEO_LOCATION_PARTICLE, RHEO__FLAT)                \
    X(list_position, rheo_real, RHEO__ELEMENT_REAL, 3, RHEO_LOCATION_PARTICLE, RHEO__FLAT)             \
    X(list_margin, rheo_real, RHEO__ELEMENT_REAL, 1, RHEO_LOCATION_PARTICLE, RHEO__FLAT)               \
    X(predicted_acceleration, rheo_real, RHEO__ELEMENT_REAL, 3, RHEO_LOCATION_PARTICLE, RHEO__FLAT)    \
    X(material, uint32_t, RHEO_ELEMENT_U32, 1, RHEO_LOCATION_PARTICLE, RHEO__FLAT)                     \
    X(ball_push_phase, double, RHEO_ELEMENT_F64, 1, RHEO_LOCATION_BODY, RHEO__FLAT)                    \
    X(history_position, rheo_real, RHEO__ELEMENT_REAL, 3, RHEO_LOCATION_PARTICLE, RHEO__RING)          \
    X(plate, uint32_t, RHEO_ELEMENT_U32, 1, RHEO_LOCATION_PARTICLE, RHEO__FLAT)                        \
    X(plate_displacement, double, RHEO_ELEMENT_F64, 3, RHEO_LOCATION_WORLD, RHEO__FLAT)                \
    X(plate_velocity, double, RHEO_ELEMENT_F64, 3, RHEO_LOCATION_WORLD, RHEO__FLAT)                    \
    X(plate_phase, double, RHEO_ELEMENT_F64, 1, RHEO_LOCATION_WORLD, RHEO__FLAT)                       \
    X(obstacle_position, double, RHEO_ELEMENT_F64, 3, RHEO_LOCATION_OBSTACLE, RHEO__FLAT)              \
    X(obstacle_rotation, double, RHEO_ELEMENT_F64, 4, RHEO_LOCATION_OBSTACLE, RHEO__FLAT)              \
    X(obstacle_phase, double, RHEO_ELEMENT_F64, 1, RHEO_LOCATION_OBSTACLE, RHEO__FLAT)                 \
    X(emitter_time, double, RHEO_ELEMENT_F64, 1, RHEO_LOCATION_WORLD, RHEO__FLAT)                      \
    X(emitter_way, double, RHEO_ELEMENT_F64, RHEO_MAX_EMITTERS, RHEO_LOCATION_WORLD, RHEO__FLAT)       \
    X(emitter_emitted, uint64_t, RHEO_ELEMENT_U64, RHEO_MAX_EMITTERS, RHEO_LOCATION_WORLD, RHEO__FLAT) \
    X(emitter_blocked, uint64_t, RHEO_ELEMENT_U64, RHEO_MAX_EMITTERS, RHEO_LOCATION_WORLD, RHEO__FLAT)

typedef enum rheo__field_id {
#define X(name, type, element, components, per, storage) RHEO__FIELD_##name,
    RHEO__FIELDS(X)
#undef X
        RHEO__FIELD_COUNT
} rheo__field_id;

typedef uint64_t rheo__fields; /* a set of fields */
#define RHEO__SET_OF(field) (UINT64_C(1) << (field))
#define RHEO__BIT(name) RHEO__SET_OF(RHEO__FIELD_##name)
/* A world has at most one of the fields that are stored in the ring. */
#define RHEO__RING_FIELDS (RHEO__BIT(history_velocity) | RHEO__BIT(history_position))
_Static_assert(RHEO__FIELD_COUNT <= 64, "sets of fields are 64-bit masks");

/* RHEO__MODES: a fixed number of rows, stored like those of a ring; all of them change in a step. */
typedef enum rheo__storage { RHEO__FLAT, RHEO__SPRING, RHEO__RING, RHEO__MODES } rheo__storage;

typedef struct rheo__field {
    const char *name;
    size_t offset; /* of the pointer to a flat field's values in rheo__state */
    rheo_element element;
    uint32_t components;
    rheo_location location;
    rheo__storage storage;
} rheo__field;

extern const rheo__field rheo__field_table[RHEO__FIELD_COUNT];

/* Why a stage refuses to make the step, and the value to blame; members as in rheo_failure. */
typedef struct rheo__refusal {
    rheo__field_id field;
    uint64_t item;
    rheo_failure_reason reason; /* RHEO_FAILURE_NONE: no stage has refused */
    double required, limit;
} rheo__refusal;

/* What springs_next holds of the springs at the start of the step. */
typedef enum rheo__spring_backup {
    RHEO__NO_BACKUP,    /* nothing; they are unchanged */
    RHEO__REST_LENGTHS, /* rest lengths; the pairs are the same */
    RHEO__ALL_SPRINGS,
} rheo__spring_backup;

typedef struct rheo__state {
    rheo_allocator allocator;
    rheo__fields present; /* those this world has */
    uint32_t particles, capacity;
    uint32_t bodies, vibrators;
    uint32_t obstacles; /* fixed; set before the first rheo__state_resize() */

    /* One pointer per field. NULL for fields that the world does not have, and for springs, rings and modes. */
#define X(name, type, element, components, per, storage) type *name;
    RHEO__FIELDS(X)
#undef X
    /* Those flat fields at the start of the step that it has changed: xprev of the model, and what undoes it. */
    void *before[RHEO__FIELD_COUNT];
    rheo__fields changed; /* set of these */

    rheo__springs springs;      /* the springs */
    rheo__springs springs_next; /* memory for the next springs; then the previous ones, or only their rest lengths */
    rheo__spring_backup springs_backup;
    rheo__ring ring;
    rheo__ring modes; /* a ring that never turns: all rows are filled and stay in place */

    /* Times that values were set other than by stages. Not state: tells that derived arrays are out of date. */
    uint64_t rewritten;
    /* Neither are these: times that a stage put other springs in place, and the fields that the stage that runs may
     * write, but leaves as they were. */
    uint64_t springs_exchanged;
    rheo__fields unchanged;
    rheo__spring_sums spring_sums;

    rheo__refusal refusal; /* set by the last stage that returned RHEO_ERROR_STATE */

    struct rheo__account *account; /* kept while stages run (core/account.h); NULL: none */
} rheo__state;

/* The ball that is body `index` of a world. */
static inline const rheo_ball *rheo__ball_of(const rheo_world_def *def, uint32_t index)
{
    return index ? &def->balls.list[index - 1] : &def->ball;
}

size_t rheo__element_size(rheo_element element);
/* Bits of the value at `index`, and bits as a number. */
uint64_t rheo__element_bits(rheo_element element, const void *values, size_t index);
double rheo__element_number(rheo_element element, uint64_t bits);
/* Distance between two numbers in units in the last place; UINT64_MAX for NaN. */
uint64_t rheo__element_distance(rheo_element element, uint64_t a, uint64_t b);
static inline bool rheo__state_has(const rheo__state *s, rheo__field_id field)
{
    return (s->present >> field) & 1;
}

/* Prepares an empty state with these fields. ring, modes: their rows, if there are any. */
void rheo__state_init(rheo__state *s, const rheo_allocator *allocator, rheo__fields present, uint32_t ring,
                      uint32_t modes);
void rheo__state_release(rheo__state *s);
/* Sets the numbers of particles, bodies and vibrators; new items are zero. On failure nothing has changed. */
bool rheo__state_resize(rheo__state *s, uint32_t particles, uint32_t bodies, uint32_t vibrators);

/* Removes the particles from this one on. Nothing of a step may have been kept of them: no spring, no row of history. */
void rheo__state_drop_particles(rheo__state *s, uint32_t particles);

/* Numbers of items of a field, of its filled rows (1 except for rings and modes), and of bytes in a row. */
uint64_t rheo__state_items(const rheo__state *s, rheo__field_id field);
uint64_t rheo__state_rows(const rheo__state *s, rheo__field_id field);
size_t rheo__state_row_bytes(const rheo__state *s, rheo__field_id field);

/* Whether a field is stored in rows, and these rows. */
static inline bool rheo__in_rows(rheo__field_id field)
{
    return rheo__field_table[field].storage == RHEO__RING || rheo__field_table[field].storage == RHEO__MODES;
}
static inline const rheo__ring *rheo__state_ring(const rheo__state *s, rheo__field_id field)
{
    return rheo__field_table[field].storage == RHEO__RING ? &s->ring : &s->modes;
}

/* Rows of a history that had `rows`, one step later; without a ring, all velocities count. */
static inline uint64_t rheo__rows_after(const rheo__state *s, uint64_t rows)
{
    return s->ring.length && rows == s->ring.length ? rows : rows + 1;
}

/*
 * Largest speed in a world with modes, and largest sum of a mode in a loaded state. Sums at speeds up to the first
 * stay below the second; they must stay finite, since a step cannot undo them.
 */
#if RHEO_DOUBLE
#define RHEO__LARGEST_SPEED 0x1p960
#define RHEO__LARGEST_MODE 0x1p1000
#else
#define RHEO__LARGEST_SPEED 0x1p90F
#define RHEO__LARGEST_MODE 0x1p124F
#endif

/* Values of a flat field, in the order of ids. */
static inline void *rheo__state_values(const rheo__state *s, rheo__field_id field)
{
    void *values;
    __builtin_memcpy(&values, (const char *)s + rheo__field_table[field].offset, sizeof values);
    return values;
}

/* One row in the order of ids (springs by smaller, then larger id; ring rows by lag, 0 the newest; modes by number).
 * False: no memory.
 */
bool rheo__state_read_row(const rheo__state *s, rheo__field_id field, uint64_t row, void *values);
/* Sets one row of a flat field, a ring (whose history_rows must be set first) or modes. Springs: rheo__springs_set().
 */
void rheo__state_write_row(rheo__state *s, rheo__field_id field, uint64_t row, const void *values);

/* Makes springs_next those of the step. */
void rheo__state_exchange_springs(rheo__state *s);
/*
 * The array that a stage reads rest lengths from when it is going to write all of them to s->springs.rest_length: the
 * same array, or the one before this stage, with which the step can be undone. NULL: no memory.
 */
const rheo_real *rheo__state_renew_rest_lengths(rheo__state *s);
/*
 * A step that fails goes back to its start. Before a stage runs, the flat fields that it writes are remembered, except
 * these: their stages seldom write them, or write all of their values, and call rheo__state_remember() or
 * rheo__state_renew() themselves.
 */
#define RHEO__REMEMBERED_BY_STAGES (RHEO__BIT(derivative) | RHEO__BIT(list_position) | RHEO__BIT(list_margin))
void rheo__state_begin(rheo__state *s);
/* Remembers the flat ones of these fields, unless the step has done so. */
void rheo__state_remember(rheo__state *s, rheo__fields fields);
/* The same for a flat field that the stage is going to write as a whole: it loses its values. */
void rheo__state_renew(rheo__state *s, rheo__field_id field);
void rheo__state_undo(rheo__state *s);

/* ---- Hashes (core/field_hash.c) ---- */

/* The hash of a whole field. */
uint64_t rheo__state_hash_field(const rheo__state *s, rheo__field_id field);
/*
 * Hashes of a set of fields, in the order of the table. A ring is hashed as a plain field with only row 0, modes with
 * all rows.
 */
void rheo__state_hash_newest(const rheo__state *s, rheo__fields fields, uint64_t *hashes);
/* Hash of the whole state. */
uint64_t rheo__state_hash(const rheo__state *s);

/*
 * One component with another value elsewhere. The values of a spring are 1 on the side that has it, 0 on the other.
 */
typedef struct rheo__solution {
    uint64_t id, other_id; /* other_id: larger id of a spring */
    uint32_t component;    /* of modes: row x 3 + axis */
    uint64_t own, other;   /* bits */
    uint64_t count;        /* items that differ */
} rheo__solution;

/*
 * Finds the one component (or spring) whose change would give this hash of row 0, or of all rows of modes. False:
 * there is none, so more than one differs; or no memory. With 20 000 particles the probability of a wrong answer is
 * at most 5e-7.
 */
bool rheo__state_solve(const rheo__state *s, rheo__field_id field, uint64_t other_hash, rheo__solution *solution);

/*
 * Searches the flat ones of these fields for NaN, infinity, and speeds too large for modes. False: there is one, at *field, *item,
 * *component.
 */
bool rheo__state_finite(const rheo__state *s, rheo__fields fields, rheo__field_id *field, uint64_t *item,
                        uint32_t *component);

#endif
