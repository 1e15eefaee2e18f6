/*
 * Lists of named items in a definition: materials, emitters. Each item has the same parameters, with rows for each number
 * that an item may have, so that loops over rows treat them like any other parameter: materials.1.springs.stiffness.
 */
#ifndef RHEO__WORLD_LISTED_H
#define RHEO__WORLD_LISTED_H

#include "world/parameters.h"

/* Items are structs that begin with their name. */
enum { RHEO__ITEM_NAME = 16 };

typedef struct rheo__list {
    const char *group; /* "materials." */
    const char *item;  /* "material" */
    uint32_t most;
    const rheo__parameter_row *row; /* most times rows_of_one; the first of each is the name */
    size_t rows_of_one;
    size_t count_offset, items_offset, item_size; /* in rheo_world_def */
    /* Adds an item that has defaults and a name. */
    rheo_result (*add)(rheo_world_def *def, const char *name, rheo_error *error);
} rheo__list;

extern const rheo__list rheo__materials, rheo__emitters;

/* The list that a path belongs to; NULL: none. */
const rheo__list *rheo__list_of(const char *path);
/* Number of items of a definition, and the name of item 1, 2, ... */
uint32_t rheo__list_count(const rheo_world_def *def, const rheo__list *list);
const char *rheo__list_name(const rheo_world_def *def, const rheo__list *list, uint32_t number);
/* The number that a text has, "1" or a name; 0: there is no such item. */
uint32_t rheo__list_number(const rheo_world_def *def, const rheo__list *list, const char *text, size_t length);
/* The path behind the item, "springs.stiffness"; the whole path if it is of no list. */
const char *rheo__in_item(const char *path);
/* Number of the item whose parameter a row is, and its list; 0: it is of none. */
uint32_t rheo__item_of(const rheo_parameter *parameter, const rheo__list **list);
/* Says that the definition has no such item, or an item no such parameter. The path is of a list. */
rheo_result rheo__listed_unknown(const rheo_world_def *def, const char *path, rheo_error *error);
/* Checks names and parameters of all items. */
rheo_result rheo__list_check(const rheo_world_def *def, const rheo__list *list, rheo_error *error);
/* Adds an item, a copy. RHEO_ERROR_ARGUMENT: a bad name, or too many. */
rheo_result rheo__list_add(rheo_world_def *def, const rheo__list *list, const void *item, rheo_error *error);

/* A row of an item. `parameter_` is a list of members of rheo_parameter. */
#define RHEO__NAME_ROW(group, number, list, about_, models_) \
    {{.path = group "." #number ".name",                     \
      .type = RHEO_PARAMETER_NAME,                           \
      .unit = "",                                            \
      .about = about_,                                       \
      .models = models_},                                    \
     offsetof(rheo_world_def, list[(number)-1].name),        \
     0,                                                      \
     {0}},

#endif
