/* Parameters: the tables of rows, and the loops over them. */
#include "world/parameters.h"

#include <stdio.h>
#include <string.h>

#include "core/error.h"
#include "core/strict.h"
#include "core/text.h"
#include "world/model_list.h"
#include "world/row_macros.h"

/* ---- Tables ---- */

#define OWNER rheo_world_def
#define SCENE_ONLY false
#define MODELS MODELS_ALL
static const rheo__parameter_row common_rows[] = {
#include "world/parameters.def"
};
#define LENGTH(array) (sizeof(array) / sizeof *(array))
static const rheo__parameter_rows common = {.row = common_rows, .count = LENGTH(common_rows)};

/* The common parameters, then those of each model; NULL past the last. */
static const rheo__parameter_rows *table_at(uint32_t index)
{
    return index == 0 ? &common : rheo__model_parameters((rheo_model)(index - 1));
}

/* ---- Looking up ---- */

static const rheo__parameter_row *row_at(size_t index)
{
    const rheo__parameter_rows *table;
    for (uint32_t t = 0; (table = table_at(t)); t++) {
        if (index < table->count)
            return &table->row[index];
        index -= table->count;
    }
    return NULL;
}

static const rheo__parameter_row *row_of(const rheo_parameter *parameter)
{
    return (const rheo__parameter_row *)(const void *)parameter;
}

size_t rheo_parameter_count(void)
{
    size_t count = 0;
    const rheo__parameter_rows *table;
    for (uint32_t t = 0; (table = table_at(t)); t++)
        count += table->count;
    return count;
}

const rheo_parameter *rheo_parameter_at(size_t index)
{
    const rheo__parameter_row *row = row_at(index);
    return row ? &row->parameter : NULL;
}

const rheo_parameter *rheo__parameter_find(const char *path)
{
    const rheo_parameter *p;
    for (size_t i = 0; (p = rheo_parameter_at(i)); i++)
        if (strcmp(p->path, path) == 0)
            return p;
    return NULL;
}

const char *rheo_parameter_nearest(const char *path)
{
    const char *nearest = row_at(0)->parameter.path;
    const rheo_parameter *p;
    for (size_t i = 0; (p = rheo_parameter_at(i)); i++) {
        const char *const two[] = {nearest, p->path};
        nearest = rheo_nearest_word(path, two, 2);
    }
    return nearest;
}

const char *rheo_parameter_words(const rheo_parameter *p, char *text, size_t size)
{
    size_t used = 0;
    text[0] = 0;
    for (uint32_t i = 0; i < p->choice_count && used < size; i++)
        used += (size_t)snprintf(text + used, size - used, "%s%s", i ? " " : "", p->choices[i]);
    return text;
}

const char *rheo_parameter_new_name(const char *path)
{
    const rheo__parameter_rows *table;
    for (uint32_t t = 0; (table = table_at(t)); t++)
        for (size_t i = 0; i < table->old_name_count; i++)
            if (strcmp(table->old_name[i].old, path) == 0)
                return table->old_name[i].now;
    return NULL;
}

rheo_result rheo__parameter_unknown(const char *path, const char *nearest, rheo_error *error)
{
    const char *now = rheo_parameter_new_name(path);
    if (now)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "\"%s\" is now called \"%s\"", path, now);
    if (!rheo_is_near_word(path, nearest))
        return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                          "unknown parameter \"%.64s\" (`rheolog scenes --parameters` lists them)", path);
    return rheo__fail(error, RHEO_ERROR_ARGUMENT, "unknown parameter \"%.64s\"; did you mean \"%s\"?", path, nearest);
}

rheo_result rheo__parameter_check_model(const rheo_parameter *p, rheo_model model, rheo_error *error)
{
    if (p->models >> model & 1)
        return RHEO_OK;
    rheo_model owner = 0;
    while (!(p->models >> owner & 1))
        owner++;
    return rheo__fail(error, RHEO_ERROR_ARGUMENT, "%s is a parameter of the model %s; the model here is %s", p->path,
                      rheo_model_name(owner), rheo_model_name(model));
}

/* ---- As numbers ---- */

static uint32_t values_of(const void *owner, const rheo__parameter_row *row, double values[3])
{
    const void *from = (const char *)owner + row->offset;
    uint64_t integer;
    uint32_t small;
    values[0] = values[1] = values[2] = 0;
    switch (row->parameter.type) {
    case RHEO_PARAMETER_REAL:
        memcpy(values, from, sizeof *values);
        return 1;
    case RHEO_PARAMETER_VECTOR:
        memcpy(values, from, 3 * sizeof *values);
        return 3;
    case RHEO_PARAMETER_INTEGER:
        memcpy(&integer, from, sizeof integer);
        values[0] = (double)integer;
        return 1;
    case RHEO_PARAMETER_CHOICE:
        memcpy(&small, from, sizeof small);
        values[0] = small;
        return 1;
    case RHEO_PARAMETER_WINDOW:
        memcpy(&small, from, sizeof small);
        values[0] = small;
        memcpy(&values[1], (const char *)owner + row->seconds_offset, sizeof values[1]);
        return 2;
    case RHEO_PARAMETER_NAME:
        return 0;
    }
    return 0;
}

/* The exact number, with an exponent where it is none the less exact: "1e+12", "1073741824". */
static const char *exact(double value, char text[32])
{
    const char *end;
    if (value - value != 0 || rheo__text_to_double(rheo__text_brief(value, 3, false, text), &end) != value)
        rheo__text_from_double(value, text);
    return text;
}

static rheo_result out_of_range(const rheo_parameter *p, double value, rheo_error *error)
{
    char given[32], minimum[32], maximum[32];
    return rheo__fail(error, RHEO_ERROR_ARGUMENT, "%s %s %s; %s must be a %snumber %s %s and %s %s", p->path,
                      p->type == RHEO_PARAMETER_VECTOR ? "has a component of" : "is", exact(value, given),
                      p->type == RHEO_PARAMETER_VECTOR ? "each" : "it",
                      p->type == RHEO_PARAMETER_INTEGER ? "whole " : "", p->above_minimum ? "above" : "of at least",
                      exact(p->minimum, minimum), p->below_maximum ? "below" : "at most", exact(p->maximum, maximum));
}

static rheo_result check_value(const rheo_parameter *p, double value, rheo_error *error)
{
    const bool low = p->above_minimum ? !(value > p->minimum) : !(value >= p->minimum);
    const bool high = p->below_maximum ? !(value < p->maximum) : !(value <= p->maximum);
    const bool whole = p->type != RHEO_PARAMETER_INTEGER || (!low && !high && value == (double)(int64_t)value);
    return !low && !high && whole ? RHEO_OK : out_of_range(p, value, error);
}

/* A window is a number of steps, or if the second value is positive of seconds. */
static rheo_result check_window(const rheo_parameter *p, const double values[3], rheo_error *error)
{
    if (values[1] > 0 && values[1] <= RHEO__UNBOUNDED)
        return RHEO_OK;
    char given[32], minimum[32], maximum[32];
    if (values[1] != 0)
        return rheo__fail(
            error, RHEO_ERROR_ARGUMENT,
            "%s is %s s; it must be above 0 s and at most 1e+30 s, as in \"2.5 s\", or a whole number of "
            "steps",
            p->path, exact(values[1], given));
    if (values[0] >= p->minimum && values[0] <= p->maximum && values[0] == (double)(uint32_t)values[0])
        return RHEO_OK;
    return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                      "%s is %s; it must be a whole number of steps from %s to %s, or seconds as in \"2.5 s\"",
                      p->path, exact(values[0], given), exact(p->minimum, minimum), exact(p->maximum, maximum));
}

static rheo_result check_values(const rheo_parameter *p, const double values[3], rheo_error *error)
{
    if (p->type == RHEO_PARAMETER_NAME)
        return RHEO_OK;
    if (p->type == RHEO_PARAMETER_WINDOW)
        return check_window(p, values, error);
    for (uint32_t i = 0; i < (p->type == RHEO_PARAMETER_VECTOR ? 3 : 1); i++)
        RHEO__TRY(check_value(p, values[i], error));
    return RHEO_OK;
}

static void store(void *owner, const rheo__parameter_row *row, const double values[3])
{
    void *to = (char *)owner + row->offset;
    switch (row->parameter.type) {
    case RHEO_PARAMETER_REAL:
        memcpy(to, values, sizeof *values);
        break;
    case RHEO_PARAMETER_VECTOR:
        memcpy(to, values, 3 * sizeof *values);
        break;
    case RHEO_PARAMETER_INTEGER: {
        const uint64_t integer = (uint64_t)values[0];
        memcpy(to, &integer, sizeof integer);
        break;
    }
    case RHEO_PARAMETER_CHOICE: {
        const uint32_t choice = (uint32_t)values[0];
        memcpy(to, &choice, sizeof choice);
        break;
    }
    case RHEO_PARAMETER_WINDOW:
        memcpy((char *)owner + row->seconds_offset, &values[1], sizeof values[1]);
        if (values[1] == 0) {
            const uint32_t steps = (uint32_t)values[0];
            memcpy(to, &steps, sizeof steps);
        }
        break;
    case RHEO_PARAMETER_NAME:
        break;
    }
}

static rheo_result assign(void *owner, const rheo__parameter_row *row, const double given[3], rheo_error *error)
{
    double values[3] = {given[0], given[1], given[2]};
    if (row->parameter.type == RHEO_PARAMETER_REAL)
        values[0] += 0.0; /* -0, which would divide with the other sign, becomes 0 */
    RHEO__TRY(check_values(&row->parameter, values, error));
    store(owner, row, values);
    return RHEO_OK;
}

void rheo__row_set_default(void *owner, const rheo__parameter_row *row)
{
    store(owner, row, row->initial);
}

bool rheo__row_has_default(const void *owner, const rheo__parameter_row *row)
{
    double values[3];
    values_of(owner, row, values);
    return values[0] == row->initial[0] && values[1] == row->initial[1] && values[2] == row->initial[2];
}

rheo_result rheo__row_check(const void *owner, const rheo__parameter_row *row, rheo_error *error)
{
    double values[3];
    values_of(owner, row, values);
    return check_values(&row->parameter, values, error);
}

uint32_t rheo__parameter_values(const rheo_world_def *def, const rheo_parameter *parameter, double values[3])
{
    return values_of(def, row_of(parameter), values);
}

rheo_result rheo__parameter_assign(rheo_world_def *def, const rheo_parameter *parameter, const double values[3],
                                   rheo_error *error)
{
    RHEO__TRY(rheo__ball_provide(def, parameter, error));
    return assign(def, row_of(parameter), values, error);
}

void rheo__parameters_set_defaults(rheo_world_def *def, rheo_model model)
{
    const rheo__parameter_row *row;
    for (size_t i = 0; (row = row_at(i)); i++)
        rheo__row_set_default(def, row);
    def->model = model;
    const rheo__parameter_rows *own = rheo__model_parameters(model);
    for (size_t i = 0; i < own->count; i++) /* again: models may share members */
        rheo__row_set_default(def, &own->row[i]);
    for (size_t i = 0; i < own->other_default_count; i++)
        store(def, row_of(rheo__parameter_find(own->other_default[i].path)), own->other_default[i].initial);
}

rheo_result rheo__parameters_check(const rheo_world_def *def, rheo_error *error)
{
    const rheo__parameter_row *row;
    for (size_t i = 0; (row = row_at(i)); i++)
        RHEO__TRY(rheo__row_check(def, row, error));
    RHEO__TRY(rheo__materials_check(def, error));
    RHEO__TRY(rheo__list_check(def, &rheo__emitters, error));
    RHEO__TRY(rheo__balls_check(def, error));
    return rheo__obstacles_check(def, error);
}

/* ---- As text ---- */

static const char *skip_blanks(const char *text)
{
    return text + strspn(text, " \t");
}

static rheo_result bad_text(const rheo_parameter *p, const char *value, rheo_error *error)
{
    const char *right = "a number";
    char words[256], one_of[272];
    if (p->type == RHEO_PARAMETER_VECTOR)
        right = "three numbers, as in [0, -9.81, 0]";
    else if (p->type == RHEO_PARAMETER_WINDOW)
        right = "a number of steps, as in 150, or seconds, as in \"2.5 s\"";
    else if (p->type == RHEO_PARAMETER_CHOICE)
        right = one_of;
    snprintf(one_of, sizeof one_of, "one of: %s", rheo_parameter_words(p, words, sizeof words));
    return rheo__fail(error, RHEO_ERROR_ARGUMENT, "%s cannot be \"%.60s\"; it is %s", p->path, value, right);
}

static bool read_choice(const rheo_parameter *p, const char *text, double *index)
{
    const size_t length = strcspn(text, " \t");
    if (*skip_blanks(text + length))
        return false;
    for (uint32_t i = 0; i < p->choice_count; i++)
        if (strlen(p->choices[i]) == length && strncmp(p->choices[i], text, length) == 0) {
            *index = i;
            return true;
        }
    return false;
}

/* `count` numbers with a comma between, in brackets or without; *end is after them. */
static bool read_numbers(const char *text, uint32_t count, double *values, const char **end)
{
    const bool bracket = count > 1 && *text == '[';
    text += bracket;
    for (uint32_t i = 0; i < count; i++) {
        text = skip_blanks(text);
        values[i] = rheo__text_to_double(text, end);
        if (*end == text)
            return false;
        text = skip_blanks(*end);
        if (i + 1 < count && *text++ != ',')
            return false;
    }
    if (bracket && *text++ != ']')
        return false;
    *end = text;
    return true;
}

static bool read_values(const rheo_parameter *p, const char *text, double values[3])
{
    const char *end;
    text = skip_blanks(text);
    if (p->type == RHEO_PARAMETER_CHOICE)
        return read_choice(p, text, &values[0]);
    if (!read_numbers(text, p->type == RHEO_PARAMETER_VECTOR ? 3 : 1, values, &end))
        return false;
    if (p->type == RHEO_PARAMETER_WINDOW && *end == 's') {
        end++;
        if (!(values[0] > 0) && (values[0] != 0 || p->minimum > 0)) /* 0 means steps */
            return false;
        values[1] = values[0];
        values[0] = 0;
    }
    return *skip_blanks(end) == 0;
}

rheo_result rheo__row_set(void *owner, const rheo__parameter_row *row, const char *value, rheo_error *error)
{
    double values[3] = {0, 0, 0};
    if (!read_values(&row->parameter, value, values))
        return bad_text(&row->parameter, value, error);
    return assign(owner, row, values, error);
}

rheo_result rheo__row_get(const void *owner, const rheo__parameter_row *row, char *value, size_t size)
{
    const rheo_parameter *p = &row->parameter;
    double values[3];
    char text[3][32];
    const uint32_t count = values_of(owner, row, values);
    for (uint32_t i = 0; i < 3; i++)
        rheo__text_from_double(values[i], text[i]);
    int length;
    if (p->type == RHEO_PARAMETER_CHOICE)
        length = values[0] < p->choice_count ? snprintf(value, size, "%s", p->choices[(uint32_t)values[0]]) : -1;
    else if (p->type == RHEO_PARAMETER_WINDOW && values[1] > 0)
        length = snprintf(value, size, "%s s", text[1]);
    else if (p->type == RHEO_PARAMETER_NAME)
        length = snprintf(value, size, "%s", (const char *)owner + row->offset);
    else if (count == 3)
        length = snprintf(value, size, "[%s, %s, %s]", text[0], text[1], text[2]);
    else
        length = snprintf(value, size, "%s", text[0]);
    return length >= 0 && (size_t)length < size ? RHEO_OK : RHEO_ERROR_ARGUMENT;
}

rheo_result rheo_world_def_set(rheo_world_def *def, const char *path, const char *value, rheo_error *error)
{
    const rheo_parameter *p = rheo_world_def_parameter_find(def, path);
    if (!p && rheo__list_of(path))
        return rheo__listed_unknown(def, path, error);
    if (!p && rheo__is_of_obstacle(path))
        return rheo__obstacle_unknown(def, path, error);
    const char *member;
    if (!p && rheo__ball_in(path, &member))
        return rheo__ball_unknown(path, error);
    if (!p)
        return rheo__parameter_unknown(path, rheo_parameter_nearest(path), error);
    if (p->type == RHEO_PARAMETER_NAME)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "%s cannot be set; it keeps its name", path);
    RHEO__TRY(rheo__parameter_check_model(p, def->model, error));
    const uint32_t balls = def->balls.count;
    RHEO__TRY(rheo__ball_provide(def, p, error));
    const rheo_result result = rheo__row_set(def, row_of(p), value, error);
    def->balls.count = result == RHEO_OK ? def->balls.count : balls;
    return result;
}

rheo_result rheo_world_def_get(const rheo_world_def *def, const char *path, char *value, size_t size)
{
    const rheo_parameter *p = rheo_world_def_parameter_find(def, path);
    const char *member;
    if (!p || rheo__ball_in(p->path, &member) > def->balls.count + 1)
        return RHEO_ERROR_ARGUMENT;
    return rheo__row_get(def, row_of(p), value, size);
}

const rheo_parameter *rheo_world_def_differing(const rheo_world_def *a, const rheo_world_def *b, size_t *index,
                                               char of_a[96], char of_b[96])
{
    const rheo_parameter *p;
    rheo_world_def all = *a; /* has the items of both, and the shapes of the obstacles */
    all.materials.count = a->materials.count > b->materials.count ? a->materials.count : b->materials.count;
    all.emitters.count = a->emitters.count > b->emitters.count ? a->emitters.count : b->emitters.count;
    all.balls.count = a->balls.count > b->balls.count ? a->balls.count : b->balls.count;
    all.obstacles = a->obstacles.count > b->obstacles.count ? a->obstacles : b->obstacles;
    while ((p = rheo_world_def_parameter_at(&all, (*index)++))) {
        of_a[0] = of_b[0] = 0;
        rheo_world_def_get(a, p->path, of_a, 96);
        rheo_world_def_get(b, p->path, of_b, 96);
        if (strcmp(of_a, of_b) != 0)
            return p;
    }
    return NULL;
}
