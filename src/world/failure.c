/* Failures in words. Everything else reads the members of rheo_failure, never the text. */
#include <stdio.h>

#include "core/error.h"
#include "core/text.h"
#include "world/world.h"

/* What a stage refused, and what may help. */
static const char *const REFUSED[] = {
    [RHEO_FAILURE_DENSITY_NOT_POSITIVE] =
        "it is not above 0; a smaller melting.courant_number, or more melting.substeps, may help",
    [RHEO_FAILURE_SUBSTEPS_FOR_SOUND] = "a slower fluid, or a smaller melting.sound_speed, needs fewer",
    [RHEO_FAILURE_SUBSTEPS_FOR_VISCOSITY] = "melting.solver implicit, or a less viscous fluid, needs fewer",
    [RHEO_FAILURE_SUBSTEPS_FOR_PRINTED_VISCOSITY] = "paper.courant off, or a less viscous fluid, needs fewer",
    [RHEO_FAILURE_SUBSTEPS_FOR_HEAT] = "a smaller melting.diffusivity needs fewer",
    [RHEO_FAILURE_VISCOSITY_OUT_OF_RANGE] =
        "viscosity takes the velocities beyond the range of numbers, and it is largest here; a smaller "
        "melting.viscosity or melting.jump_number_max is needed",
};

static const char *text_of(rheo_failure_reason reason)
{
    const size_t count = sizeof REFUSED / sizeof *REFUSED;
    const char *text = (size_t)reason < count ? REFUSED[reason] : NULL;
    return text ? text : "a reason that this version does not know";
}

/* "position of particle 17", "substeps of the world" */
static void write_item(const rheo_failure *f, char *text, size_t size)
{
    if (f->location == RHEO_LOCATION_WORLD)
        snprintf(text, size, "%s of the world", f->field);
    else
        snprintf(text, size, "%s of %s %llu", f->field, rheo_item_name(f->location), (unsigned long long)f->id);
}

void rheo_failure_message(const rheo_failure *f, char *text, size_t size)
{
    char item[96], required[32], limit[32], numbers[128] = "";
    write_item(f, item, sizeof item);
    if (f->limit > 0) {
        rheo__text_from_double(f->required, required);
        rheo__text_from_double(f->limit, limit);
        snprintf(numbers, sizeof numbers, "it would need %.24s substeps, and melting.max_substeps is %.24s; ",
                 required, limit);
    }
    if (f->reason == RHEO_FAILURE_NOT_FINITE)
        snprintf(text, size, "step %llu went bad: %s%s%s%s is not finite (component %u)", (unsigned long long)f->step,
                 f->stage[0] ? "after stage " : "", f->stage, f->stage[0] ? " " : "", item, f->component);
    else
        snprintf(text, size, "step %llu went bad: stage %s cannot go on because of %s: %s%s",
                 (unsigned long long)f->step, f->stage, item, numbers, text_of(f->reason));
    rheo__reword(text);
}
