/*
 * A model in one file: particles with linear drag that bounce off a floor at y = 0. A step has n = 1, 2 or 3 substeps
 * in turn:
 *
 *     v <- v + dt g;  n times v <- (1 - c dt/n) v, x <- x + dt/n v;  where y < 0: y <- -y, v_y <- -e v_y
 *
 * A history of one row holds the velocities at the end of the step. A library and a program of their own include the
 * model, built with -D'RHEO__MORE_MODELS(X)=X(drag)'.
 */
#include "world/model.h"

typedef struct drag {
    rheo_real step, rate, restitution, gravity[3];
} drag;

unsigned drag_stage_runs; /* runs of stage drag in all worlds, failed steps included */

/* The model uses otherwise unused members of the definition. */
static const rheo__parameter_row PARAMETERS[] = {
    {{.path = "drag.rate",
      .unit = "1/T",
      .about = "c, rate at which velocities decay",
      .type = RHEO_PARAMETER_REAL,
      .maximum = RHEO__UNBOUNDED,
      .live = true,
      .models = UINT32_C(1) << 2},
     offsetof(rheo_world_def, fluid.linear_viscosity),
     0,
     {0.5}},
    {{.path = "drag.restitution",
      .unit = "1",
      .about = "e, speed after a bounce over speed before",
      .type = RHEO_PARAMETER_REAL,
      .maximum = RHEO__UNBOUNDED,
      .live = true,
      .models = UINT32_C(1) << 2},
     offsetof(rheo_world_def, fluid.quadratic_viscosity),
     0,
     {1}},
};
static const rheo__parameter_default DEFAULTS[] = {{"gravity", {0, 0, 0}}};
static const rheo__parameter_rows ROWS = {PARAMETERS, 2, DEFAULTS, 1, NULL, 0};

static double support(const rheo_world_def *def)
{
    return 2 * def->fluid.spacing;
}

static uint32_t features(const rheo_world_def *def)
{
    (void)def;
    return 0;
}

static rheo__fields fields(uint32_t needed, const rheo_world_def *def)
{
    (void)needed;
    (void)def;
    return RHEO__BIT(substeps) | RHEO__BIT(history_rows) | RHEO__BIT(history_velocity);
}

static bool reserve_history(rheo_world *w, uint64_t rows)
{
    return rheo__ring_reserve_rows(&w->state.ring, &w->state.allocator, (uint32_t)rows);
}

static void push_history(rheo_world *w, uint64_t rows)
{
    (void)rows;
    rheo__ring_push(&w->state.ring, w->state.particles, w->state.velocity);
}

static bool configure(rheo_world *w)
{
    drag *d = w->model;
    *d = (drag){.step = (rheo_real)w->def.step,
                .rate = (rheo_real)w->def.fluid.linear_viscosity,
                .restitution = (rheo_real)w->def.fluid.quadratic_viscosity};
    for (int axis = 0; axis < 3; axis++)
        d->gravity[axis] = (rheo_real)w->def.gravity[axis];
    return true;
}

/* ---- Stages ---- */

static rheo_result stage_gravity(rheo__state *s, void *context)
{
    const drag *d = context;
    for (size_t i = 0; i < 3 * (size_t)s->particles; i++)
        s->velocity[i] += d->step * d->gravity[i % 3];
    return RHEO_OK;
}

static rheo_result stage_substeps(rheo__state *s, void *context)
{
    (void)context;
    *s->substeps = 1 + *s->step % 3;
    return RHEO_OK;
}

static rheo_result stage_drag(rheo__state *s, void *context)
{
    const drag *d = context;
    const rheo_real factor = 1 - d->rate * (d->step / (rheo_real)*s->substeps);
    for (size_t i = 0; i < 3 * (size_t)s->particles; i++)
        s->velocity[i] *= factor;
    drag_stage_runs++;
    return RHEO_OK;
}

static rheo_result stage_flight(rheo__state *s, void *context)
{
    const drag *d = context;
    const rheo_real step = d->step / (rheo_real)*s->substeps;
    for (size_t i = 0; i < 3 * (size_t)s->particles; i++)
        s->position[i] += step * s->velocity[i];
    return RHEO_OK;
}

static rheo_result stage_floor(rheo__state *s, void *context)
{
    const drag *d = context;
    for (uint32_t i = 0; i < s->particles; i++) {
        rheo_real *y = s->position + 3 * (size_t)i + 1, *v = s->velocity + 3 * (size_t)i + 1;
        if (*y < 0) {
            *y = -*y;
            *v *= -d->restitution;
        }
    }
    return RHEO_OK;
}

static rheo_result stage_history(rheo__state *s, void *context)
{
    (void)context;
    const uint64_t rows = rheo__rows_after(s, *s->history_rows);
    if (!rheo__ring_reserve_rows(&s->ring, &s->allocator, (uint32_t)rows))
        return RHEO_ERROR_MEMORY;
    rheo__ring_push(&s->ring, s->particles, s->velocity);
    *s->history_rows = rows;
    return RHEO_OK;
}

static void add_stages(rheo_world *w)
{
    const uint32_t x = RHEO__BIT(position), v = RHEO__BIT(velocity);
    rheo__world_add_stage(w, (rheo__stage){"gravity", stage_gravity, w->model, v, 0, 0});
    rheo__world_add_stage(w, (rheo__stage){"substeps", stage_substeps, w->model, RHEO__BIT(substeps), 0, 0});
    rheo__world_add_stage(w, (rheo__stage){"drag", stage_drag, w->model, v, 0, 0});
    rheo__world_add_stage(w, (rheo__stage){"flight", stage_flight, w->model, x, 0, 0});
    rheo__world_end_substeps(w);
    rheo__world_add_stage(w, (rheo__stage){"floor", stage_floor, w->model, x | v, 0, 0});
    rheo__world_add_stage(w, (rheo__stage){"history", stage_history, w->model,
                                           RHEO__BIT(history_rows) | RHEO__BIT(history_velocity), 0, 0});
}

#define METRICS(COMMON, STATE) \
    COMMON(step) COMMON(time) COMMON(max_speed) STATE(momentum_x, "M L/T", "sum of the velocities, x", momentum)

enum { METRICS(RHEO__NO_METRIC, RHEO__METRIC_NUMBER) };
static const rheo__metric METRIC_ROWS[] = {METRICS(RHEO__COMMON_METRIC, RHEO__OWN_METRIC)};

static void measure_state(const rheo_world *w, rheo__metrics *m)
{
    double momentum = 0;
    for (size_t i = 0; i < w->state.particles; i++)
        momentum += (double)w->state.velocity[3 * i];
    m->own[OWN_momentum_x] = momentum;
}

static const rheo_quantity QUANTITIES[] = {
    RHEO__QUANTITY(position, 3, "L", "position"),
    RHEO__QUANTITY(velocity, 3, "L/T", "velocity"),
    {NULL, NULL, NULL, 0, 0},
};
static const rheo_ranking RANKINGS[] = {{RHEO_TOP_FASTEST, "fastest", "speed", "L/T", "|velocity|"},
                                        {0, NULL, NULL, NULL, NULL}};

extern const rheo__model_type rheo__model_drag;
const rheo__model_type rheo__model_drag = {
    .name = "drag",
    .parameters = &ROWS,
    .support = support,
    .features = features,
    .fields = fields,
    .reserve_history = reserve_history,
    .push_history = push_history,
    .size = sizeof(drag),
    .configure = configure,
    .add_stages = add_stages,
    .metrics = METRIC_ROWS,
    .metric_count = sizeof METRIC_ROWS / sizeof *METRIC_ROWS,
    .measure_state = measure_state,
    .quantities = QUANTITIES,
    .rankings = RANKINGS,
};
