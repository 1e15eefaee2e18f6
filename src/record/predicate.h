/* Conditions of rheo_player_find() (rheolog/find.h): parsing (predicate.c) and evaluating (predicate_values.c). */
#ifndef RHEO__RECORD_PREDICATE_H
#define RHEO__RECORD_PREDICATE_H

#include "rheolog/find.h"

typedef enum rheo__about {
    RHEO__ABOUT_METRIC,
    RHEO__ABOUT_PARTICLE,
    RHEO__ABOUT_SPRING,
    RHEO__ABOUT_BALL,
} rheo__about;

typedef enum rheo__operator {
    RHEO__LESS,
    RHEO__AT_MOST,
    RHEO__MORE,
    RHEO__AT_LEAST,
    RHEO__EQUAL,
    RHEO__UNEQUAL,
    RHEO__EXISTS,
} rheo__operator;

/* A comparison. */
typedef struct rheo__term {
    rheo__about about;
    bool any;
    uint32_t id, other; /* of a ball: its index */
    char name[64];      /* metric or quantity; that of a vector without its component */
    uint32_t quantity;  /* index: of the metric, of rheo_world_quantity(), or of the tables in predicate_values.c */
    int component;      /* of a vector: 0 to 2; -1: its length, or a scalar */
    rheo__operator op;
    double number;
} rheo__term;

/* Nodes follow their operands, so that a stack evaluates them in their order. */
typedef enum rheo__node_kind { RHEO__TERM, RHEO__AND, RHEO__OR, RHEO__NOT } rheo__node_kind;
typedef struct rheo__node {
    rheo__node_kind kind;
    uint32_t term;
} rheo__node;

enum { RHEO__MOST_TERMS = 32, RHEO__MOST_NODES = 4 * RHEO__MOST_TERMS };

typedef struct rheo__predicate {
    rheo__term term[RHEO__MOST_TERMS];
    rheo__node node[RHEO__MOST_NODES];
    uint32_t terms, nodes;
} rheo__predicate;

/* A truth value; unknown as long as an item has not been looked at. */
typedef enum rheo__truth { RHEO__FALSE, RHEO__TRUE, RHEO__UNKNOWN } rheo__truth;

/* What a term found. */
typedef struct rheo__outcome {
    rheo__truth truth;
    uint64_t id, other;
    double value;
} rheo__outcome;

/*
 * Fails with RHEO_ERROR_ARGUMENT and the place in the text. Without a recording, metrics are those of the world. Without a
 * world, it fails unless there are metrics only.
 */
rheo_result rheo__predicate_parse(const char *text, const rheo_recording *recording, const rheo_world *world,
                                  rheo__predicate *condition, rheo_error *error);
/* Finds the quantity of an item by its name; sets `quantity` and `component`. False: there is none. */
bool rheo__term_resolve(rheo__term *term, const rheo_world *world);
/* Appends the names of the quantities of an item, with commas between. */
void rheo__term_names(rheo__about about, const rheo_world *world, char *text, size_t size);

/* Evaluates the terms about metrics; those about items become unknown. */
void rheo__predicate_metrics(const rheo__predicate *condition, const double *metrics, rheo__outcome *outcome);
/* Evaluates the terms about items. */
rheo_result rheo__predicate_items(const rheo__predicate *condition, const rheo_world *world, rheo__outcome *outcome,
                                  rheo_error *error);
/* The truth of the whole condition. */
rheo__truth rheo__predicate_truth(const rheo__predicate *condition, const rheo__outcome *outcome);

#endif
