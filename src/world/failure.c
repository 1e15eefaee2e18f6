/* Failures in words. All other code reads the members of rheo_failure, never the text. */
#include <stdio.h>

#include "core/error.h"
#include "core/text.h"
#include "world/model.h"

const char *rheo_failure_reason_name(rheo_failure_reason reason)
{
    static const char *const NAMES[] = {
        [RHEO_FAILURE_NONE] = "none",
        [RHEO_FAILURE_NOT_FINITE] = "not-finite",
        [RHEO_FAILURE_DENSITY_NOT_POSITIVE] = "density-not-positive",
        [RHEO_FAILURE_SUBSTEPS_FOR_SOUND] = "substeps-for-sound",
        [RHEO_FAILURE_SUBSTEPS_FOR_VISCOSITY] = "substeps-for-viscosity",
        [RHEO_FAILURE_SUBSTEPS_FOR_PRINTED_VISCOSITY] = "substeps-for-printed-viscosity",
        [RHEO_FAILURE_SUBSTEPS_FOR_HEAT] = "substeps-for-heat",
        [RHEO_FAILURE_VISCOSITY_OUT_OF_RANGE] = "viscosity-out-of-range",
    };
    return (size_t)reason < sizeof NAMES / sizeof *NAMES ? NAMES[reason] : "unknown";
}

static const rheo__refusal_text *refusal_of(const rheo_failure *f)
{
    static const rheo__refusal_text unknown = {.text = "a reason that this version does not know"};
    const rheo__model_type *type = rheo__model(f->model);
    for (const rheo__refusal_text *row = type ? type->refusals : NULL; row && row->text; row++)
        if (row->reason == f->reason)
            return row;
    return &unknown;
}

/* "position of particle 17", "substeps of the world" */
static void write_item(const rheo_failure *f, char *text, size_t size)
{
    if (f->location == RHEO_LOCATION_WORLD)
        snprintf(text, size, "%s of the world", f->field);
    else
        snprintf(text, size, "%s of %s %llu", f->field, rheo_item_name(f->location), (unsigned long long)f->id);
}

static void write_refusal(const rheo_failure *f, const char *item, char *text, size_t size)
{
    const rheo__refusal_text *row = refusal_of(f);
    char required[32], limit[32], numbers[160] = "";
    if (row->limit) {
        rheo__text_from_double(f->required, required);
        rheo__text_from_double(f->limit, limit);
        snprintf(numbers, sizeof numbers, "it would need %.24s %s, and %s is %.24s; ", required, row->required,
                 row->limit, limit);
    }
    snprintf(text, size, "step %llu went bad: stage %s cannot go on because of %s: %s%s", (unsigned long long)f->step,
             f->stage, item, numbers, row->text);
}

void rheo_failure_message(const rheo_failure *f, char *text, size_t size)
{
    char item[96];
    write_item(f, item, sizeof item);
    if (f->reason == RHEO_FAILURE_NOT_FINITE)
        snprintf(text, size, "step %llu went bad: %s%s%s%s is not finite (component %u)", (unsigned long long)f->step,
                 f->stage[0] ? "after stage " : "", f->stage, f->stage[0] ? " " : "", item, f->component);
    else
        write_refusal(f, item, text, size);
    rheo__reword(text);
}
