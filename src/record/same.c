/* The ladder between the same bits and other physics: options, parameters of the new side, and the order of the rungs. */
#include "record/same.h"

#include <string.h>

#include "core/progress.h"
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

rheo_result rheo__same_command_of(rheo_recording *golden, const rheo__step_chunks *chunks, uint64_t step,
                                  const rheo_same_options *options, rheo_world *world, rheo_error *error)
{
    size_t before, after;
    rheo__world_commands(world, &before);
    RHEO__TRY(rheo__recording_command(golden, chunks, step, world, error));
    rheo__world_commands(world, &after);
    return after > before ? rheo__same_set(options, world, error) : RHEO_OK;
}

rheo_result rheo__same_command(rheo_recording *golden, size_t index, const rheo_same_options *options,
                               rheo_world *world, rheo_error *error)
{
    return rheo__same_command_of(golden, &golden->steps[index], golden->first_step + 1 + index, options, world,
                                 error);
}

/* ---- The ladder ---- */

static rheo_result check(const rheo_same_options *o, rheo_error *error)
{
    if (o->at_least < RHEO_SAMENESS_DIFFERS || o->at_least > RHEO_SAMENESS_BITS)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                          "at_least is %d; it must be RHEO_SAMENESS_DIFFERS, STATISTICS, STEP, ROUNDING or BITS",
                          (int)o->at_least);
    if (!(o->limit >= 1 && o->limit <= 1e6))
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "the limit of rounding must be from 1 to 1000000");
    if (o->members < RHEO_LEAST_SAME_MEMBERS || o->members > RHEO_MOST_SAME_MEMBERS)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "members is %u; it must be %d to %d", o->members,
                          RHEO_LEAST_SAME_MEMBERS, RHEO_MOST_SAME_MEMBERS);
    return RHEO_OK;
}

/* The verdict of a rung that holds. */
static rheo_result reach(rheo_same_result *result, rheo_sameness verdict)
{
    result->verdict = verdict;
    return RHEO_OK;
}

/* The step that failed must fail again, at the same place and for the same reason. */
static rheo_result try_failure(rheo_recording *r, const rheo_same_options *o, rheo_world *world, bool *same,
                               rheo_error *error)
{
    rheo_error why;
    RHEO__TRY(rheo__same_command_of(r, &r->failed, r->failure.step, o, world, error));
    const rheo_result result = rheo_world_step(world, &why);
    if (result != RHEO_OK && result != RHEO_ERROR_STATE)
        return rheo__fail(error, result, "%s", why.message);
    *same = result == RHEO_ERROR_STATE && rheo__same_failure(&world->failure, &r->failure);
    return RHEO_OK;
}

static rheo_result make_steps(rheo_recording *r, const rheo_same_options *o, rheo_world *world,
                              rheo_same_result *result, rheo_error *error)
{
    bool same = true;
    RHEO__TRY(rheo__same_set(o, world, error));
    for (size_t i = 0; i < r->step_count && same; i++) {
        rheo_error why;
        RHEO__TRY(rheo__same_command(r, i, o, world, error));
        RHEO__TRY(rheo__recording_read_step(r, i, error));
        const rheo_result done = rheo__world_step_traced(world, r->expected, r->expected_count, &why);
        if (done != RHEO_OK && done != RHEO_ERROR_STATE)
            return rheo__fail(error, done, "%s", why.message);
        same = done == RHEO_OK && world->trace.count == r->expected_count &&
               memcmp(world->trace.hash, r->expected, r->expected_count * sizeof *r->expected) == 0;
        result->bits_steps += same;
        RHEO__TRY(rheo__progress("verifying", i + 1, r->step_count, error));
    }
    if (same && r->has_failure)
        RHEO__TRY(try_failure(r, o, world, &same, error));
    result->bits_passed = same;
    return RHEO_OK;
}

/* Rung bits: as rheo_verify(), with the parameters of the options. */
static rheo_result try_bits(rheo_recording *r, const rheo_same_options *o, rheo_same_result *result,
                            rheo_error *error)
{
    rheo_world *world;
    RHEO__TRY(rheo_recording_check(r, error));
    RHEO__TRY(rheo__keyframe_world(r, &r->keyframes[0], NULL, &world, error));
    result->bits_tried = true;
    const rheo_result done = make_steps(r, o, world, result, error);
    rheo_world_destroy(world);
    return done;
}

/* The ladder. At the end result->verdict is known, unless an error ends it. */
static rheo_result climb(rheo_recording *r, const rheo_same_options *o, rheo_same_result *result, rheo_error *error)
{
    result->verdict = RHEO_SAMENESS_DIFFERS;
    RHEO__TRY(try_bits(r, o, result, error));
    if (result->bits_passed)
        return reach(result, RHEO_SAMENESS_BITS);
    if (o->at_least > RHEO_SAMENESS_ROUNDING)
        return RHEO_OK;
    RHEO__TRY(rheo__same_steps(r, o, false, &result->rounding, error));
    if (result->rounding.passed)
        return reach(result, RHEO_SAMENESS_ROUNDING);
    if (o->at_least > RHEO_SAMENESS_STEP)
        return RHEO_OK;
    RHEO__TRY(rheo__same_steps(r, o, true, &result->step, error));
    if (o->at_least == RHEO_SAMENESS_STEP && !result->step.passed)
        return RHEO_OK;
    RHEO__TRY(rheo__same_statistics(r, o, &result->statistics, error));
    if (result->statistics.passed)
        reach(result, result->step.passed ? RHEO_SAMENESS_STEP : RHEO_SAMENESS_STATISTICS);
    return RHEO_OK;
}

rheo_result rheo_same(const char *golden, const rheo_same_options *options, rheo_same_result *result,
                      rheo_error *error)
{
    const rheo_same_options own = options ? *options : rheo_default_same_options();
    memset(result, 0, sizeof *result);
    RHEO__TRY(check(&own, error));
    rheo_recording *r;
    rheo_error why;
    RHEO__TRY(rheo_recording_open(golden, &r, error));
    rheo_result done = r->complete ? RHEO_OK : rheo__fail(&why, r->fault_result, "%s", r->fault.message);
    if (done == RHEO_OK)
        done = climb(r, &own, result, &why);
    if (done == RHEO_OK && own.self_check && !result->statistics.tried) /* whatever rung holds */
        done = rheo__same_statistics(r, &own, &result->statistics, &why);
    if (done != RHEO_OK)
        result->verdict = RHEO_SAMENESS_UNKNOWN;
    rheo_recording_close(r);
    rheo__same_describe(result, &own, done == RHEO_OK ? NULL : &why);
    return rheo__in_file(golden, done, &why, error);
}
