/* Parameters as rows of tables: loops over them make defaults, checks, text and files. */
#ifndef RHEO__WORLD_PARAMETERS_H
#define RHEO__WORLD_PARAMETERS_H

#include "rheolog/world.h"

#define RHEO__UNBOUNDED 1e30
#define RHEO__EXACT 9007199254740991.0 /* 2^53 - 1: a double holds every integer up to here */

/* `parameter` is first: a const rheo_parameter * of the library points to its row. */
typedef struct rheo__parameter_row {
    rheo_parameter parameter;
    size_t offset;         /* of the member in its struct */
    size_t seconds_offset; /* of a window in seconds: a double */
    double initial[3];
} rheo__parameter_row;

typedef struct rheo__parameter_default {
    const char *path;
    double initial[3];
} rheo__parameter_default;

typedef struct rheo__old_name {
    const char *old, *now;
} rheo__old_name;

/* The parameters of a model, or those that all have. */
typedef struct rheo__parameter_rows {
    const rheo__parameter_row *row;
    size_t count;
    const rheo__parameter_default *other_default; /* the model's defaults of common parameters */
    size_t other_default_count;
    const rheo__old_name *old_name; /* names that earlier versions used */
    size_t old_name_count;
} rheo__parameter_rows;

/* The parameters of a model (world/models.c); NULL if there is no such model. */
const rheo__parameter_rows *rheo__model_parameters(rheo_model model);

/* ---- One row; `owner` is the struct that it is a member of ---- */

void rheo__row_set_default(void *owner, const rheo__parameter_row *row);
bool rheo__row_has_default(const void *owner, const rheo__parameter_row *row);
rheo_result rheo__row_check(const void *owner, const rheo__parameter_row *row, rheo_error *error);
rheo_result rheo__row_set(void *owner, const rheo__parameter_row *row, const char *value, rheo_error *error);
rheo_result rheo__row_get(const void *owner, const rheo__parameter_row *row, char *value, size_t size);
/* RHEO_ERROR_ARGUMENT if the model does not have the parameter. */
rheo_result rheo__parameter_check_model(const rheo_parameter *parameter, rheo_model model, rheo_error *error);
/* Says that there is no such parameter, how it is called now if it is an old one, else that `nearest` is nearest. */
rheo_result rheo__parameter_unknown(const char *path, const char *nearest, rheo_error *error);

/*
 * ---- Lists of named items in a definition: materials, emitters (world/listed.c) ----
 *
 * Each item has the same parameters, with rows for each number that an item may have, so that loops over rows treat them
 * like any other parameter: materials.1.springs.stiffness.
 */

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

/* ---- Materials (world/materials.c) ---- */

/* The names of the materials, as a part of a sentence. */
enum { RHEO__MATERIALS_TEXT = 32 + 20 * RHEO_MAX_MATERIALS };
const char *rheo__materials_text(const rheo_world_def *def, char text[RHEO__MATERIALS_TEXT]);
/* Check the materials of a definition, and those of its particles. */
rheo_result rheo__materials_check(const rheo_world_def *def, rheo_error *error);
rheo_result rheo__materials_check_particles(const rheo_world_def *def, rheo_error *error);

/* ---- Obstacles (world/obstacles.c) ---- */

/* Whether a path begins with "obstacles.", and the number after it; -1: there is none. */
bool rheo__is_of_obstacle(const char *path);
int rheo__obstacle_number(const char *path);
/* The row of a parameter of an obstacle; NULL for others. */
const rheo__parameter_row *rheo__obstacle_row(const rheo_parameter *parameter);
/* Number of all parameters of the obstacles of a definition; one of them by index, and by path; NULL: there is none. */
size_t rheo__obstacle_parameter_count(const rheo_world_def *def);
const rheo_parameter *rheo__obstacle_parameter(const rheo_world_def *def, size_t index);
const rheo_parameter *rheo__obstacle_parameter_find(const rheo_world_def *def, const char *path);
/* Says that the definition has no such obstacle, or its shape no such parameter. */
rheo_result rheo__obstacle_unknown(const rheo_world_def *def, const char *path, rheo_error *error);
/* Checks all of the obstacles but their meshes. */
rheo_result rheo__obstacles_check(const rheo_world_def *def, rheo_error *error);

/* ---- Balls (world/balls.c) ---- */

/* Parameters of the further balls that a definition has, by index. */
size_t rheo__ball_parameter_count(const rheo_world_def *def);
const rheo_parameter *rheo__ball_parameter_at(size_t index);
/* The parameter of a further ball by path, whether a definition has this ball or not; NULL if there is none. */
const rheo_parameter *rheo__ball_parameter_find(const char *path);
/* Number of the ball in a path such as "ball2.radius" or "ball2", and the rest of the path. 0: there is none. */
uint32_t rheo__ball_in(const char *path, const char **member);
/* Says why there is no such parameter of a ball with a number. */
rheo_result rheo__ball_unknown(const char *path, rheo_error *error);
/* Adds the ball that a parameter is of, if it is the next one. */
rheo_result rheo__ball_provide(rheo_world_def *def, const rheo_parameter *parameter, rheo_error *error);
rheo_result rheo__balls_check(const rheo_world_def *def, rheo_error *error);
/* "ball" or "ball2": the group of parameters of the ball with this index. */
enum { RHEO__BALL_NAME_SIZE = 12 };
const char *rheo__ball_name(uint32_t index, char name[RHEO__BALL_NAME_SIZE]);
#define RHEO__BALL_NAME(index) rheo__ball_name(index, (char[RHEO__BALL_NAME_SIZE]){""})

/* ---- Parameters of a definition ---- */

/* Numbers of a parameter: 1, a vector has 3, a window 2 (steps, seconds), a name 0. A choice is the index of its word. */
uint32_t rheo__parameter_values(const rheo_world_def *def, const rheo_parameter *parameter, double values[3]);
rheo_result rheo__parameter_assign(rheo_world_def *def, const rheo_parameter *parameter, const double values[3],
                                   rheo_error *error);
void rheo__parameters_set_defaults(rheo_world_def *def, rheo_model model);
/* Refuses the first parameter that is out of its range. */
rheo_result rheo__parameters_check(const rheo_world_def *def, rheo_error *error);
/* NULL if there is none of that name; those of listed items are not found. */
const rheo_parameter *rheo__parameter_find(const char *path);

#endif
