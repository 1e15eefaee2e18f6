/* The ladder between the same bits and other physics: options, parameters of the new side, and the order of the rungs. */
#include "record/same.h"

#include <string.h>

#include "core/text.h"

static const char *const NAMES[] = {"unknown", "differs", "statistics", "step", "rounding", "bits"};
enum { NAME_COUNT = sizeof NAMES / sizeof *NAMES };

const char *rheo_sameness_name(rheo_sameness sameness)
{
    return (uint32_t)sameness < NAME_COUNT ? NAMES[sameness] : NAMES[0];
}

rheo_sameness rheo_sameness_by_name(const char *name)
{
    for (uint32_t i = RHEO_SAMENESS_DIFFERS; i < NAME_COUNT; i++)
        if (strcmp(name, NAMES[i]) == 0)
            return (rheo_sameness)i;
    return RHEO_SAMENESS_UNKNOWN;
}

rheo_same_options rheo_default_same_options(void)
{
    return (rheo_same_options){.at_least = RHEO_SAMENESS_STATISTICS, .seed = 1, .limit = 16, .members = 20};
}

/* ---- Parameters of the new side ---- */

/* Splits "NAME=VALUE". */
static rheo_result split(const char *assignment, char path[48], const char **value, rheo_error *error)
{
    const char *equals = strchr(assignment, '=');
    const size_t length = equals ? (size_t)(equals - assignment) : 0;
    if (length == 0 || length >= 48)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "\"%.60s\" is no assignment; write NAME=VALUE", assignment);
    memcpy(path, assignment, length);
    path[length] = '\0';
    *value = equals + 1;
    return RHEO_OK;
}

rheo_result rheo__same_set(const rheo_same_options *options, rheo_world *world, rheo_error *error)
{
    for (uint32_t i = 0; i < options->set_count; i++) {
        char path[48] = "";
        const char *value = "";
        RHEO__TRY(split(options->set[i], path, &value, error));
        RHEO__TRY(rheo_world_set(world, path, value, error));
    }
    return RHEO_OK;
}

rheo_result rheo__same_command(rheo_recording *golden, size_t index, const rheo_same_options *options,
                               rheo_world *world, rheo_error *error)
{
    size_t before, after;
    rheo__world_commands(world, &before);
    RHEO__TRY(rheo__recording_command(golden, &golden->steps[index], golden->first_step + 1 + index, world, error));
    rheo__world_commands(world, &after);
    return after > before ? rheo__same_set(options, world, error) : RHEO_OK;
}

/* ---- The ladder ---- */

static rheo_result check(const rheo_same_options *o, rheo_error *error)
{
    if (o->at_least < RHEO_SAMENESS_STATISTICS || o->at_least > RHEO_SAMENESS_BITS)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                          "at_least is %d; it must be RHEO_SAMENESS_STATISTICS, STEP, ROUNDING or BITS",
                          (int)o->at_least);
    if (!(o->limit >= 1 && o->limit <= 1e6))
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "the limit of rounding must be from 1 to 1000000");
    if (o->members < RHEO_LEAST_SAME_MEMBERS || o->members > RHEO_MOST_SAME_MEMBERS)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "members is %u; it must be %d to %d", o->members,
                          RHEO_LEAST_SAME_MEMBERS, RHEO_MOST_SAME_MEMBERS);
    return RHEO_OK;
}

rheo_result rheo_same(const char *golden, const rheo_same_options *options, rheo_same_result *result,
                      rheo_error *error)
{
    const rheo_same_options own = options ? *options : rheo_default_same_options();
    memset(result, 0, sizeof *result);
    RHEO__TRY(check(&own, error));
    rheo_recording *r;
    RHEO__TRY(rheo_recording_open(golden, &r, error));
    rheo_error why;
    const rheo_result done =
        rheo__in_file(golden, rheo__same_statistics(r, &own, &result->statistics, &why), &why, error);
    rheo_recording_close(r);
    return done;
}
