/* Lists of named items in a definition (world/parameters.h). */
#include "world/parameters.h"

#include <stdio.h>
#include <string.h>

#include "core/error.h"
#include "core/strict.h"

static const rheo__list *const lists[] = {&rheo__materials, &rheo__emitters};
enum { LISTS = sizeof lists / sizeof *lists };

const rheo__list *rheo__list_of(const char *path)
{
    for (size_t i = 0; i < LISTS; i++)
        if (strncmp(path, lists[i]->group, strlen(lists[i]->group)) == 0)
            return lists[i];
    return NULL;
}

uint32_t rheo__list_count(const rheo_world_def *def, const rheo__list *list)
{
    uint32_t count;
    memcpy(&count, (const char *)def + list->count_offset, sizeof count);
    return count;
}

const char *rheo__list_name(const rheo_world_def *def, const rheo__list *list, uint32_t number)
{
    return (const char *)def + list->items_offset + (number - 1) * list->item_size;
}

const char *rheo__in_item(const char *path)
{
    const rheo__list *list = rheo__list_of(path);
    const char *rest = list ? strchr(path + strlen(list->group), '.') : NULL;
    return rest ? rest + 1 : path;
}

uint32_t rheo__item_of(const rheo_parameter *parameter, const rheo__list **list)
{
    for (size_t i = 0; i < LISTS; i++)
        for (uint32_t k = 0; k < lists[i]->most * lists[i]->rows_of_one; k++)
            if (&lists[i]->row[k].parameter == parameter) {
                *list = lists[i];
                return 1 + (uint32_t)(k / lists[i]->rows_of_one);
            }
    return 0;
}

/* ---- The parameters of a definition: the common ones, then those of its items, further balls and obstacles ---- */

size_t rheo_world_def_parameter_count(const rheo_world_def *def)
{
    size_t count = rheo_parameter_count();
    for (size_t i = 0; i < LISTS; i++)
        count += rheo__list_count(def, lists[i]) * lists[i]->rows_of_one;
    return count + rheo__ball_parameter_count(def) + rheo__obstacle_parameter_count(def);
}

const rheo_parameter *rheo_world_def_parameter_at(const rheo_world_def *def, size_t index)
{
    const size_t common = rheo_parameter_count();
    if (index < common)
        return rheo_parameter_at(index);
    index -= common;
    for (size_t i = 0; i < LISTS; i++) {
        const size_t count = rheo__list_count(def, lists[i]) * lists[i]->rows_of_one;
        if (index < count)
            return &lists[i]->row[index].parameter;
        index -= count;
    }
    const size_t of_balls = rheo__ball_parameter_count(def);
    return index < of_balls ? rheo__ball_parameter_at(index) : rheo__obstacle_parameter(def, index - of_balls);
}

uint32_t rheo__list_number(const rheo_world_def *def, const rheo__list *list, const char *text, size_t length)
{
    char name[RHEO__ITEM_NAME], number[4];
    snprintf(name, sizeof name, "%.*s", (int)(length < sizeof name ? length : 0), text);
    for (uint32_t k = 1; k <= rheo__list_count(def, list) && length < sizeof name; k++) {
        snprintf(number, sizeof number, "%u", (unsigned)(k % 1000));
        if (strcmp(name, rheo__list_name(def, list, k)) == 0 || strcmp(name, number) == 0)
            return k;
    }
    return 0;
}

const rheo_parameter *rheo_world_def_parameter_find(const rheo_world_def *def, const char *path)
{
    const rheo__list *list = rheo__list_of(path);
    if (!list && rheo__is_of_obstacle(path))
        return rheo__obstacle_parameter_find(def, path);
    if (!list) {
        const rheo_parameter *of_ball = rheo__ball_parameter_find(path);
        return of_ball ? of_ball : rheo__parameter_find(path);
    }
    const char *text = path + strlen(list->group);
    const uint32_t number = rheo__list_number(def, list, text, strcspn(text, "."));
    for (size_t i = 0; number && i < list->rows_of_one; i++) {
        const rheo_parameter *p = &list->row[(number - 1) * list->rows_of_one + i].parameter;
        if (strcmp(rheo__in_item(p->path), rheo__in_item(path)) == 0)
            return p;
    }
    return NULL;
}

rheo_result rheo__listed_unknown(const rheo_world_def *def, const char *path, rheo_error *error)
{
    const rheo__list *list = rheo__list_of(path);
    const char *text = path + strlen(list->group);
    const size_t length = strcspn(text, ".");
    const uint32_t count = rheo__list_count(def, list);
    char known[512] = "";
    if (!rheo__list_number(def, list, text, length)) {
        for (uint32_t k = 1; k <= count; k++)
            snprintf(known + strlen(known), sizeof known - strlen(known), "%s\"%s\"", k > 1 ? ", " : "",
                     rheo__list_name(def, list, k));
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "%.64s: there is no %s \"%.*s\"; %s%ss are%s%s", path,
                          list->item, (int)(length < 32 ? length : 32), text, count ? "the " : "no ", list->item,
                          count ? ": " : " given", known);
    }
    for (size_t i = 1; i < list->rows_of_one; i++)
        snprintf(known + strlen(known), sizeof known - strlen(known), "%s%s", i > 1 ? ", " : "",
                 rheo__in_item(list->row[i].parameter.path));
    return rheo__fail(error, RHEO_ERROR_ARGUMENT, "%.64s: a%s %s has no such parameter of its own; it has: %s", path,
                      strchr("aeiou", list->item[0]) ? "n" : "", list->item, known);
}

/* ---- Items ---- */

static bool is_letter(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

static bool is_name(const char *name)
{
    size_t length = 0;
    while (length < RHEO__ITEM_NAME && (is_letter(name[length]) || (name[length] >= '0' && name[length] <= '9') ||
                                        name[length] == '-' || name[length] == '_'))
        length++;
    return length < RHEO__ITEM_NAME && name[length] == 0 && is_letter(name[0]) && strcmp(name, "main") != 0;
}

/* Checks the name of an item, numbered from 1, against those before it. */
static rheo_result check_name(const rheo_world_def *def, const rheo__list *list, uint32_t number, rheo_error *error)
{
    const char *name = rheo__list_name(def, list, number);
    if (!is_name(name))
        return rheo__fail(
            error, RHEO_ERROR_ARGUMENT,
            "%s %u has the name \"%.15s\"; a name is a letter, then at most 14 letters, digits, - and _, and not \"main\"",
            list->item, number, name);
    for (uint32_t other = 1; other < number; other++)
        if (strcmp(rheo__list_name(def, list, other), name) == 0)
            return rheo__fail(error, RHEO_ERROR_ARGUMENT, "two %ss have the name \"%s\"", list->item, name);
    return RHEO_OK;
}

rheo_result rheo__list_add(rheo_world_def *def, const rheo__list *list, const void *item, rheo_error *error)
{
    uint32_t count = rheo__list_count(def, list);
    if (count >= list->most)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "a world has at most %u %ss", list->most, list->item);
    memcpy((char *)def + list->items_offset + count * list->item_size, item, list->item_size);
    count++;
    RHEO__TRY(check_name(def, list, count, error));
    memcpy((char *)def + list->count_offset, &count, sizeof count);
    return RHEO_OK;
}

rheo_result rheo__list_check(const rheo_world_def *def, const rheo__list *list, rheo_error *error)
{
    const uint32_t count = rheo__list_count(def, list);
    if (count > list->most)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "there are %u %ss; at most %u are possible", count, list->item,
                          list->most);
    for (uint32_t k = 1; k <= count; k++)
        RHEO__TRY(check_name(def, list, k, error));
    for (size_t i = 0; i < count * list->rows_of_one; i++)
        RHEO__TRY(rheo__row_check(def, &list->row[i], error));
    return RHEO_OK;
}
