/*
 * A model in one file: particles in free flight with linear drag, v <- (1 - c dt) v, x <- x + dt v. A library and a
 * program of their own include it, built with -D'RHEO__MORE_MODELS(X)=X(drag)'.
 */
#include "world/model.h"

typedef struct drag {
    rheo_real step, factor;
} drag;

/* The model uses an otherwise unused member of the definition. */
static const rheo__parameter_row PARAMETERS[] = {
    {{.path = "drag.rate",
      .unit = "1/T",
      .about = "c, rate at which velocities decay",
      .type = RHEO_PARAMETER_REAL,
      .maximum = RHEO__UNBOUNDED,
      .live = true,
      .models = UINT32_C(1) << 2},
     offsetof(rheo_world_def, fluid.linear_viscosity),
     {0.5}},
};
static const rheo__parameter_default DEFAULTS[] = {{"gravity", {0, 0, 0}}};
static const rheo__parameter_rows ROWS = {PARAMETERS, 1, DEFAULTS, 1, NULL, 0};

static double support(const rheo_world_def *def)
{
    return 2 * def->fluid.spacing;
}

static uint32_t features(const rheo_world_def *def)
{
    (void)def;
    return 0;
}

static bool configure(rheo_world *w)
{
    *(drag *)w->model = (drag){(rheo_real)w->def.step, (rheo_real)(1 - w->def.fluid.linear_viscosity * w->def.step)};
    return true;
}

static rheo_result stage_drag(rheo__state *s, void *context)
{
    const drag *d = context;
    for (size_t i = 0; i < 3 * (size_t)s->particles; i++)
        s->velocity[i] *= d->factor;
    return RHEO_OK;
}

static rheo_result stage_flight(rheo__state *s, void *context)
{
    const drag *d = context;
    for (size_t i = 0; i < 3 * (size_t)s->particles; i++)
        s->position[i] += d->step * s->velocity[i];
    return RHEO_OK;
}

static void add_stages(rheo_world *w)
{
    rheo__world_add_stage(w, (rheo__stage){"drag", stage_drag, w->model, RHEO__BIT(velocity), 0, 0});
    rheo__world_add_stage(w, (rheo__stage){"flight", stage_flight, w->model, RHEO__BIT(position), 0, 0});
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
    .size = sizeof(drag),
    .configure = configure,
    .add_stages = add_stages,
    .metrics = METRIC_ROWS,
    .metric_count = sizeof METRIC_ROWS / sizeof *METRIC_ROWS,
    .measure_state = measure_state,
    .quantities = QUANTITIES,
    .rankings = RANKINGS,
};
