/*
 * Study heat: conduction in a slab of height 1 that is insulated at both ends and does not move. A cosine decays as
 * exp(-k pi^2 t), and a step of temperature evens out as the cosine series of the slab says.
 */
#include "cli/error_melting.h"

#include <math.h>
#include <stdlib.h>

#define PI 3.14159265358979323846

static const double DIFFUSIVITY = 1e-3;
/* Times at which the cosine and the step are compared: the former has decayed by a factor of e, the latter is 4 layers wide. */
static const double COSINE_TIME = 100, STEP_TIME = 10;

static double cosine(double y, double time)
{
    return cos(PI * y) * exp(-DIFFUSIVITY * PI * PI * time);
}

/* From -1 below to 3 above the middle. */
static double step_of(double y, double time)
{
    if (time == 0)
        return y < 0.5 ? -1 : 3;
    double sum = 1;
    for (int k = 1; k < 60; k += 2)
        sum -= 8 / (k * PI) * (k % 4 == 1 ? 1 : -1) * cos(k * PI * y) * exp(-DIFFUSIVITY * k * PI * k * PI * time);
    return sum;
}

/* Makes the world of a slab with these temperatures, and its steps. */
static int conduct(cli_melt_run *r, const cli_bench_arguments *a, rheo_world_def *def, cli_melt_body *slab,
                   double (*temperature)(double y, double time), double time, double *reached)
{
    rheo_error error = {""};
    rheo_world *world;
    for (uint32_t i = 0; i < slab->count; i++)
        slab->temperature[i] = (rheo_real)temperature((double)slab->position[3 * i + 1], 0);
    cli_melt_use(slab, def);
    def->particles.temperature = slab->temperature;
    const rheo_result result = rheo_world_create(def, &world, &error);
    if (result != RHEO_OK)
        return cli_error(result, &error);
    const int status = cli_melt_step(r, world, cli_melt_steps_until(a, time, def->step));
    *reached = rheo_world_time(world);
    cli_melt_finish(r, world);
    cli_melt_read(world, "temperature", slab->temperature, slab->count * sizeof *slab->temperature);
    rheo_world_destroy(world);
    return status;
}

/* Share of the cosine in the temperatures. */
static double mode_of(const cli_melt_body *slab, double (*temperature)(double y, double time))
{
    double sum = 0;
    for (uint32_t i = 0; i < slab->count; i++) {
        const double y = (double)slab->position[3 * i + 1];
        sum += cos(PI * y) * (temperature ? temperature(y, 0) : (double)slab->temperature[i]);
    }
    return sum;
}

static int run(const cli_melt_case *c, const cli_melt_setting *s, const cli_bench_arguments *a, cli_melt_run *r)
{
    const double *jitter = c->of;
    const uint32_t layers = cli_melt_layers(c, s), size[3] = {6, layers, 6};
    rheo_world_def def = rheo_default_model_def(RHEO_MODEL_MELTING);
    cli_melt_body slab;
    double time = 0, square = 0;
    def.fluid.spacing = 1.0 / layers;
    def.step = 0.2;
    def.melting.flow = RHEO_FLOW_FROZEN;
    def.melting.diffusivity = DIFFUSIVITY;
    int status = cli_melt_set(s, &def);
    if (status != CLI_DONE)
        return status;
    if (!cli_melt_block(&slab, def.fluid.spacing, size, *jitter, 1))
        return cli_fail(CLI_SYSTEM, "no memory for a slab of %u layers", layers);
    status = conduct(r, a, &def, &slab, cosine, COSINE_TIME, &time);
    if (status == CLI_DONE && time > 0)
        cli_melt_value(r, 0, log(mode_of(&slab, cosine) / mode_of(&slab, NULL)) / time, DIFFUSIVITY * PI * PI);
    if (status == CLI_DONE)
        status = conduct(r, a, &def, &slab, step_of, STEP_TIME, &time);
    for (uint32_t i = 0; i < slab.count && status == CLI_DONE; i++) {
        const double wrong = (double)slab.temperature[i] - step_of((double)slab.position[3 * i + 1], time);
        square += wrong * wrong;
    }
    r->error[1] = sqrt(square / slab.count) / 4;
    cli_melt_release(&slab);
    r->failed = r->failed || !(fabs(r->error[0]) < 1); /* it has grown instead */
    return status;
}

int cli_error_heat(cli_bench_arguments *a, cli_error_points *points)
{
    static const cli_melt_setting SETTING[] = {
        {"5 layers", "spacing", 0.2, 5, {NULL}},
        {"10 layers", "spacing", 0.1, 10, {NULL}},
        {"20 layers (default step)", "spacing", 0.05, 0, {NULL}},
        {"40 layers", "spacing", 0.025, 40, {NULL}},
        {"substep 0.01 h2/k", "substep", 0.01, 0, {"step=0.025"}},
        {"substep 0.02 h2/k", "substep", 0.02, 0, {"step=0.05"}},
        {"substep 0.04 h2/k", "substep", 0.04, 0, {"step=0.1"}},
        {"substep 0.16 h2/k", "substep", 0.16, 0, {"step=0.4", "melting.substeps=1"}},
        {"substep 0.32 h2/k", "substep", 0.32, 0, {"step=0.8", "melting.substeps=1"}},
        {"substep 0.64 h2/k", "substep", 0.64, 0, {"step=1.6", "melting.substeps=1"}},
        {"h 1.2 spacings", NULL, 0, 0, {"melting.smoothing_length=0.06"}},
        {"second derivatives", NULL, 0, 0, {"melting.laplacian=second"}},
    };
    static const double regular = 0, disordered = 0.2;
    cli_melt_case c = {.scene = "lattice",
                       .quantity = {"decay", "step"},
                       .layers = 20,
                       .of = &regular,
                       .setting = SETTING,
                       .settings = sizeof SETTING / sizeof *SETTING,
                       .run = run};
    int status = cli_melt_measure(&c, a, points);
    c.scene = "disordered";
    c.of = &disordered;
    return status == CLI_DONE ? cli_melt_measure(&c, a, points) : status;
}
