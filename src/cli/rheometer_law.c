/*
 * The law of the melting model for `rheolog rheometer`: viscosity and stress against the shear rate. Particles on a lattice get the
 * velocities of a uniform shear; the library's own gradients and its law (docs/melting.md, 4) then give the viscosity of the one in
 * the middle. The exact numbers beside it come from the formula of that page. Nothing flows: there are no plates for this model.
 */
#include "cli/rheometer.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE = 9, ALL = SIDE * SIDE * SIDE, RATES = 13 };

/* The apparent viscosity of docs/melting.md (4). */
static double law_of(const rheo_world_def *def, double jump, double rate)
{
    if (def->melting.rheology == RHEO_RHEOLOGY_NEWTONIAN)
        return def->melting.viscosity;
    const double d = fmax(rate * def->melting.time_scale, 1e-14);
    return def->melting.viscosity * -expm1(-(jump + 1) * d) * (pow(d, def->melting.power_law_index - 1) + 1 / d);
}

/* The middle particle of a lattice that is sheared at this rate. */
static rheo_result sheared(const rheo_world_def *of, double temperature, double rate, rheo_particle_state *middle,
                           rheo_error *error)
{
    static rheo_real position[3 * ALL], velocity[3 * ALL];
    rheo_world_def def = *of;
    def.walls.count = 0;
    def.melting.temperature = temperature;
    def.melting.flow = RHEO_FLOW_ON;
    for (int i = 0; i < ALL; i++) {
        const int place[3] = {i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE};
        for (int axis = 0; axis < 3; axis++) {
            position[3 * i + axis] = (rheo_real)((place[axis] - SIDE / 2) * def.fluid.spacing);
            velocity[3 * i + axis] = 0;
        }
        velocity[3 * i] = (rheo_real)(rate * (double)position[3 * i + 1]);
    }
    def.particles.count = ALL;
    def.particles.position = position;
    def.particles.velocity = velocity;
    def.particles.density = def.particles.temperature = NULL;
    rheo_world *world;
    rheo_result result = rheo_world_create(&def, &world, error);
    if (result == RHEO_OK)
        result = rheo_world_particle(world, ALL / 2, middle, error);
    rheo_world_destroy(world);
    return result;
}

static int measure_temperature(cli_protocol_table *t, const rheo_world_def *def, double temperature,
                               const cli_values *rates, double *worst)
{
    for (size_t i = 0; i < rates->count; i++) {
        rheo_particle_state p;
        rheo_error error = {""};
        const rheo_result result = sheared(def, temperature, rates->value[i], &p, &error);
        if (result != RHEO_OK)
            return cli_error(result, &error);
        const double exact = law_of(def, p.jump_number, rates->value[i]);
        cli_table_add(
            t, (double[]){temperature, p.jump_number, p.shear_rate, p.viscosity * p.shear_rate, p.viscosity, exact});
        *worst = fmax(*worst, fabs(p.viscosity / exact - 1));
    }
    return CLI_DONE;
}

/* Rates around 1/t0, where the law bends. */
static cli_values default_rates(const rheo_world_def *def)
{
    cli_values rates = {RATES, {0}};
    for (int i = 0; i < RATES; i++)
        rates.value[i] = pow(10, -3 + i * .5) / def->melting.time_scale;
    return rates;
}

static void fit(cli_protocol_table *t, const char *of, const cli_flow_names *name, size_t first, size_t count)
{
    double rate[CLI_RHEOMETER_VALUES], stress[CLI_RHEOMETER_VALUES];
    for (size_t i = 0; i < count; i++) {
        rate[i] = t->value[(first + i) * t->columns + 2];
        stress[i] = t->value[(first + i) * t->columns + 3];
    }
    cli_put_flow_law(t, of, rate, stress, count, name);
}

static int check(const cli_measurement *r)
{
    if (!(r->scene.world.melting.viscosity > 0))
        return cli_fail(CLI_BAD, "%s has no viscosity, so there is no law to measure: melting.viscosity is 0",
                        r->scene_name);
    return CLI_DONE;
}

static int flow(cli_measurement *r)
{
    const rheo_world_def *def = &r->scene.world;
    const cli_values otherwise = default_rates(def), *rates = cli_values_or(&r->rates, &otherwise);
    static const cli_flow_names SOLID = {"solid_yield_stress", "solid_exponent", "solid_consistency",
                                         "solid_fit_error",    "M/(L T^2)",      "M T^(n-2)/L"},
                                MOLTEN = {"molten_yield_stress", "molten_exponent", "molten_consistency",
                                          "molten_fit_error",    "M/(L T^2)",       "M T^(n-2)/L"};
    cli_protocol_table *t = cli_rheometer_table(r, "flow");
    snprintf(
        t->about, sizeof t->about,
        "the law itself: a lattice of particles gets the velocities of each shear rate, below and above the melting "
        "temperatures; stress = viscosity x rate; exact: the formula of docs/melting.md; fit: yield stress + "
        "consistency x rate^n");
    const cli_table_column columns[] = {{"temperature", "K", NULL},     {"jump_number", "1", NULL},
                                        {"shear_rate", "1/T", NULL},    {"stress", "M/(L T^2)", NULL},
                                        {"viscosity", "M/(L T)", NULL}, {"viscosity_exact", "M/(L T)", NULL}};
    cli_table_set_columns(t, columns, sizeof columns / sizeof *columns);
    t->panel[t->panels++] = (struct cli_table_panel){"shear_rate", "stress", "temperature", true, false};
    t->panel[t->panels++] = (struct cli_table_panel){"shear_rate", "viscosity", "temperature", true, false};
    double worst = 0;
    int status = measure_temperature(t, def, def->melting.temperature_min, rates, &worst);
    if (status == CLI_DONE)
        status = measure_temperature(t, def, def->melting.temperature_max, rates, &worst);
    if (status != CLI_DONE || t->failed)
        return status;
    fit(t, " of the solid", &SOLID, 0, rates->count);
    fit(t, " of the molten fluid", &MOLTEN, rates->count, rates->count);
    cli_table_figure_is(t, "difference_below", "1", cli_bound(worst));
    return CLI_DONE;
}

static void sum_up(cli_measurement *r)
{
    const rheo_world_def *def = &r->scene.world;
    const cli_protocol_table *t = r->tables ? &r->table[0] : NULL;
    char a[32], b[32];
    if (!t || !t->rows)
        return;
    if (def->melting.rheology == RHEO_RHEOLOGY_NEWTONIAN) {
        snprintf(r->summary[0], sizeof r->summary[0], "Newtonian: viscosity %s M/(L T) at any temperature",
                 rheo_number_brief(t->value[4], 3, a));
        return;
    }
    const double n = cli_table_figure_of(t, "solid_exponent"), yield = cli_table_figure_of(t, "solid_yield_stress");
    rheo_number_brief(law_of(def, def->melting.jump_number_max, 0), 3, b);
    if (isnan(n)) {
        snprintf(r->summary[0], sizeof r->summary[0], "solid: creeps at low rates with the viscosity %s M/(L T)", b);
        snprintf(r->summary[1], sizeof r->summary[1],
                 "no fit of yield stress + consistency x rate^n to its stress at these rates");
    } else {
        snprintf(r->summary[0], sizeof r->summary[0],
                 "solid: yield stress %s M/(L T^2); below it creeps with the viscosity %s M/(L T)",
                 rheo_number_brief(yield, 3, a), b);
        snprintf(r->summary[1], sizeof r->summary[1], "beyond it %s: stress grows as rate^%s",
                 n < .99    ? "shear thinning"
                 : n > 1.01 ? "shear thickening"
                            : "of constant viscosity",
                 rheo_number_brief(n, 3, a));
    }
    snprintf(r->summary[2], sizeof r->summary[2], "molten: viscosity %s to %s M/(L T); no elasticity, no hysteresis",
             rheo_number_brief(t->value[t->rows / 2 * t->columns + 4], 3, a),
             rheo_number_brief(t->value[(t->rows - 1) * t->columns + 4], 3, b));
}

static const cli_protocol PROTOCOLS[] = {{"flow", "stress and viscosity against the shear rate", flow, "--rate"},
                                         {NULL, NULL, NULL, NULL}};

const cli_instrument cli_law_instrument = {
    "law",     "the law of the melting model, evaluated in uniform shear; this model has no plates",
    PROTOCOLS, sum_up,
    "law-",    check};
