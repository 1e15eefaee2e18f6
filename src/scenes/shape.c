/* The list of shapes, and the checks of their members. */
#include "scenes/shape.h"

#include <stdio.h>
#include <string.h>

#include "core/error.h"
#include "core/strict.h"
#include "core/text.h"
#include "world/model.h"

#define SHAPE(KIND, name) &rheo__shape_##name,
static const rheo__shape *const shapes[] = {RHEO__SHAPES(SHAPE)};
#undef SHAPE

enum { SHAPES = sizeof shapes / sizeof *shapes };

size_t rheo_shape_count(void)
{
    return SHAPES;
}

const rheo_shape *rheo_shape_at(size_t index)
{
    return index < SHAPES ? &shapes[index]->row : NULL;
}

const rheo__shape *rheo__shape_of(rheo_fill_kind kind)
{
    return (size_t)kind < SHAPES ? shapes[kind] : NULL;
}

static const void *value_of(const rheo_fill *fill, const rheo_shape_member *member)
{
    return (const char *)fill + member->offset;
}

static bool is_given(const rheo_fill *fill, const rheo_shape_member *member)
{
    return member->given == 0 || *(const bool *)((const char *)fill + member->given);
}

/* Whether a member differs from its default. All bytes of a default are zero. */
static bool is_set(const rheo_fill *fill, const rheo_shape_member *member)
{
    if (member->given)
        return is_given(fill, member);
    const unsigned char *bytes = value_of(fill, member);
    for (size_t i = 0; i < member->size; i++)
        if (bytes[i])
            return true;
    return false;
}

static rheo_result check_number(const rheo_shape_member *member, double value, rheo_error *error)
{
    if (value >= member->minimum && value <= member->maximum && (!member->above_minimum || value > member->minimum))
        return RHEO_OK;
    char range[96];
    if (member->minimum <= -1e30)
        snprintf(range, sizeof range, "finite");
    else if (member->maximum >= 1e30)
        rheo__text_print(range, sizeof range, member->above_minimum ? "above %g" : "%g or more", member->minimum);
    else
        rheo__text_print(range, sizeof range, "from %g to %g", member->minimum, member->maximum);
    return rheo__fail(error, RHEO_ERROR_ARGUMENT, "%s must be %s; got %g", member->name, range, value);
}

static rheo_result check_member(const rheo_fill *fill, const rheo_shape_member *member, rheo_error *error)
{
    const double *number = value_of(fill, member);
    switch (member->type) {
    case RHEO_SHAPE_NUMBER:
    case RHEO_SHAPE_PAIR:
    case RHEO_SHAPE_VECTOR:
        for (size_t i = 0; is_given(fill, member) && i < member->size / sizeof *number; i++)
            RHEO__TRY(check_number(member, number[i], error));
        break;
    case RHEO_SHAPE_TEXT:
    case RHEO_SHAPE_FILE:
        if (!memchr(value_of(fill, member), 0, member->size))
            return rheo__fail(error, RHEO_ERROR_ARGUMENT, "%s must have at most %zu bytes", member->name,
                              member->size - 1);
        break;
    case RHEO_SHAPE_NEGATED_FLAG:
        break;
    }
    return RHEO_OK;
}

static rheo_result check_model(const rheo_fill *fill, const rheo_shape_member *member, rheo_model model,
                               rheo_error *error)
{
    if (rheo_shape_member_has_model(member, model) || !is_set(fill, member))
        return RHEO_OK;
    uint32_t other = 0; /* first model that has the member */
    while (!rheo_shape_member_has_model(member, (rheo_model)other))
        other++;
    return rheo__fail(error, RHEO_ERROR_ARGUMENT, "%s is for the model %s; the scene's is %s", member->name,
                      rheo_model_name((rheo_model)other), rheo_model_name(model));
}

bool rheo_shape_member_has_model(const rheo_shape_member *member, rheo_model model)
{
    const rheo__model_type *type = rheo__model(model);
    switch (member->needs) {
    case RHEO_SHAPE_NEEDS_NOTHING:
        return true;
    case RHEO_SHAPE_NEEDS_DENSITY:
        return type->density != NULL;
    case RHEO_SHAPE_NEEDS_TEMPERATURE:
        return type->temperature != NULL;
    case RHEO_SHAPE_NEEDS_MATERIALS:
        return type->materials;
    }
    return false;
}

rheo_result rheo_fill_check(const rheo_fill *fill, rheo_model model, rheo_error *error)
{
    const rheo__shape *shape = rheo__shape_of(fill->kind);
    if (!shape)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "there is no kind %d of shape", (int)fill->kind);
    for (size_t m = 0; m < shape->row.member_count; m++) {
        RHEO__TRY(check_model(fill, &shape->row.member[m], model, error));
        RHEO__TRY(check_member(fill, &shape->row.member[m], error));
    }
    return shape->check ? shape->check(fill, error) : RHEO_OK;
}

rheo__lattice rheo__lattice_on_underside(const rheo__solid *solid, const double size[3])
{
    rheo__lattice l = {.low = {0, 0, 0}};
    for (int axis = 0; axis < 3; axis++) {
        l.high[axis] = rheo__round_half_up(size[axis]) - 1;
        l.origin[axis] =
            solid->fill->position[axis] + solid->spacing * (axis == 1 ? 0.5 : -0.5 * (double)l.high[axis]);
    }
    return l;
}
