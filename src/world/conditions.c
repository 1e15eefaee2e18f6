/* Measures that a definition and the first speeds put out of range, before anything is simulated. */
#include "world/measure.h"

#include <stdio.h>
#include <string.h>

#include "core/text.h"
#include "world/model.h"

enum { METRICS = 6 };

static double most_substeps(const rheo_world_def *def)
{
    const rheo__model_type *type = rheo__model(def->model);
    return type->most_substeps ? type->most_substeps(def) : 1;
}

bool rheo__condition_of(const rheo_world_def *def, rheo__known_speeds speeds, uint32_t row,
                        rheo__condition *condition)
{
    static const rheo__metric_name NAMES[METRICS] = {{"substeps"}, {"max_speed"}, {"ball_vx"},
                                                     {"ball_vy"},  {"ball_vz"},   {"ball_max_speed"}};
    const rheo__measures *measures = rheo__measures_of(def);
    const rheo__measure *measure = &measures->row[row];
    const double *v = def->ball.velocity;
    double first = -1; /* of the fastest ball, which stands for all */
    for (uint32_t i = 0; i <= def->balls.count; i++) {
        const double *u = rheo__ball_of(def, i)->velocity,
                     speed = __builtin_sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
        if (speed > first) {
            first = speed;
            v = u;
        }
    }
    const double ball = speeds.ball > first ? speeds.ball : first;
    const double now[METRICS] = {most_substeps(def), speeds.fluid, v[0], v[1], v[2], ball},
                 episode[RHEO_MAX_FINDINGS] = {0};
    const rheo__observation o = {.def = def,
                                 .features = rheo__world_features(def),
                                 .names = NAMES,
                                 .now = now,
                                 .before = now, /* the step is not the first: a first state has made no substeps */
                                 .count = def->ball.radius > 0 ? METRICS : 2};
    double value;
    if ((measure->kind != RHEO__CONDITION && measure->kind != RHEO__PRECURSOR) || !measure->value ||
        !measure->value(&o, &value) || value <= measure->limit)
        return false;
    const bool certain = measure->kind == RHEO__CONDITION && !(value <= measure->certain);
    rheo_diagnosis diagnosis;
    memset(&diagnosis, 0, sizeof diagnosis);
    diagnosis.cause.value = value;
    rheo__case c = {.diagnosis = &diagnosis,
                    .def = def,
                    .names = NAMES,
                    .largest = now,
                    .count = o.count,
                    .measures = measures,
                    .episode = episode};
    if (measure->advise)
        measure->advise(&c);
    else
        measures->advise(&c);
    *condition = (rheo__condition){.measure = measure,
                                   .value = value,
                                   .limit = certain ? measure->certain : measure->limit,
                                   .certain = certain,
                                   .advice_count = diagnosis.advice_count};
    memcpy(condition->advice, diagnosis.advice, sizeof condition->advice);
    return true;
}

void rheo__condition_tell(const rheo__condition *condition, char *text, size_t size)
{
    char value[32], limit[32];
    const rheo_advice *a = &condition->advice[0];
    rheo__text_two(condition->value, condition->limit, value, limit);
    snprintf(text, size, "%s (%s) is %s, more than %s: %s", condition->measure->name, condition->measure->meaning,
             value, limit, condition->certain ? "expect the run to go bad" : "the run may go bad");
    if (condition->advice_count)
        rheo__text_add(text, size, "; what helps: %s%s%s%s", a->set, a->set[0] ? " (" : "", a->text,
                       a->set[0] ? ")" : "");
}
