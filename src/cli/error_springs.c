/*
 * rheolog bench error, study springs: solvers of stiff springs. A small ball falls on a small pool whose k_hist is 10 to
 * 10 000 times k_min. A setting holds a stiffness if no particle becomes much faster than the ball arrived, and the ball
 * dips and rises; the largest ratio up to which it holds all is what it reaches. Where it holds, its error is against the
 * limit step -> 0 of the same law and stiffness: relative for the dip, in radii for the depth 3 units of time after contact.
 */
#include "cli/error_trials.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define EXPLICIT               \
    {                          \
        "scheme", "sequential" \
    }
#define IMPLICIT                     \
    EXPLICIT,                        \
    {                                \
        "springs.solver", "implicit" \
    }
#define MOST(n)            \
    {                      \
        "max_substeps", #n \
    }

static const cli_setting SETTINGS[] = {
    {"summed, step/8", "", "summed", 8, true, {MOST(64)}},
    {"summed, step/4", "summed", "summed", 4, false, {MOST(64)}},
    {"summed, step/2", "summed", "summed", 2, false, {MOST(64)}},
    {"summed, step, up to 64 substeps", "summed", "summed", 1, false, {MOST(64)}},
    {"summed, step", "", "summed", 1, false, {{NULL}}},
    {"softened, up to 8 substeps", "softened", "summed", 1, false, {MOST(8)}},
    {"softened, up to 4 substeps", "softened", "summed", 1, false, {MOST(4)}},
    {"softened, up to 2 substeps", "softened", "summed", 1, false, {MOST(2)}},
    {"fixed, 16 substeps", "fixed", "summed", 1, false, {{"substeps", "16"}}},
    {"fixed, 8 substeps", "fixed", "summed", 1, false, {{"substeps", "8"}}},
    {"fixed, 4 substeps", "fixed", "summed", 1, false, {{"substeps", "4"}}},
    {"explicit, step/8", "", "sequential", 8, true, {EXPLICIT}},
    {"explicit, step/4", "sequential", "sequential", 4, false, {EXPLICIT}},
    {"explicit, step/2", "sequential", "sequential", 2, false, {EXPLICIT}},
    {"explicit, step", "sequential", "sequential", 1, false, {EXPLICIT}},
    {"implicit, step/4", "implicit", "sequential", 4, false, {IMPLICIT}},
    {"implicit, step/2", "implicit", "sequential", 2, false, {IMPLICIT}},
    {"implicit, step", "implicit", "sequential", 1, false, {IMPLICIT}},
};
enum { SETTING_COUNT = sizeof SETTINGS / sizeof *SETTINGS };

/* k_hist/k_min, ascending, and the names of the cases. */
static const struct {
    double ratio;
    const char *name;
} CASES[] = {{10, "ball-10"},     {30, "ball-30"},     {100, "ball-100"},    {300, "ball-300"},
             {1000, "ball-1000"}, {3000, "ball-3000"}, {10000, "ball-10000"}};
enum { CASE_COUNT = sizeof CASES / sizeof *CASES };

/* ---- A run ---- */

enum { DIP, DEPTH_3 };

/* Particles that are faster than this, in speeds of the ball at contact, are those of a run that blows up. */
static const double BLOWN_UP = 4;

typedef struct impact {
    double contact, speed; /* time of contact, 0 until then; speed of the ball there */
    double before, deepest;
    bool turned, blown_up;
} impact;

static bool measure_impact(cli_trial *t, rheo_world *world)
{
    const cli_settled *from = t->of->data;
    impact *m = t->memory;
    rheo_body ball;
    rheo_world_body(world, 0, &ball);
    const double depth = (from->surface - ball.position[1] + ball.radius) / ball.radius,
                 time = rheo_world_time(world);
    if (depth > 0 && m->contact == 0) {
        m->contact = time - t->def.step * depth / (depth - m->before);
        m->speed = -ball.velocity[1];
    }
    if (m->contact > 0) {
        m->turned = m->turned || depth < m->deepest;
        m->deepest = m->turned ? m->deepest : depth;
        m->blown_up = m->blown_up || !(cli_metric(world, "max_speed") < BLOWN_UP * m->speed);
        if (time >= m->contact + 3 && isnan(t->quantity[DEPTH_3]))
            t->quantity[DEPTH_3] = depth + (m->before - depth) * (time - m->contact - 3) / t->def.step;
    }
    m->before = depth;
    return isnan(t->quantity[DEPTH_3]) && !m->blown_up;
}

static void finish_impact(cli_trial *t)
{
    const impact *m = t->memory;
    t->quantity[DIP] = m->turned ? m->deepest : (double)NAN;
    if (m->blown_up || !m->turned || isnan(t->quantity[DEPTH_3]))
        t->quantity[DIP] = t->quantity[DEPTH_3] = NAN;
}

/* ---- What is reached ---- */

/* The point of a case, setting and quantity; NULL: none. */
static const cli_error_point *find(const cli_error_points *points, const char *scene, const char *setting)
{
    for (size_t i = 0; i < points->count; i++)
        if (strcmp(points->item[i].scene, scene) == 0 && strcmp(points->item[i].setting, setting) == 0)
            return &points->item[i];
    return NULL;
}

/* Adds the largest ratio up to which each setting holds, with the cost there. Its error is 1/ratio. */
static int add_reached(cli_error_points *points)
{
    for (size_t s = 0; s < SETTING_COUNT; s++) {
        cli_error_point reached = cli_error_no_point();
        for (size_t c = 0; c < CASE_COUNT; c++) {
            const cli_error_point *p = find(points, CASES[c].name, SETTINGS[s].name);
            if (!p || isnan(p->value))
                break;
            reached = *p;
            reached.value = CASES[c].ratio;
        }
        snprintf(reached.scene, sizeof reached.scene, "ball");
        snprintf(reached.setting, sizeof reached.setting, "%s", SETTINGS[s].name);
        snprintf(reached.quantity, sizeof reached.quantity, "ratio_reached");
        reached.series[0] = 0;
        reached.refinement = 0;
        reached.reference = NAN;
        reached.error = 1 / reached.value;
        if (!cli_error_add(points, &reached))
            return CLI_SYSTEM;
    }
    return CLI_DONE;
}

int cli_error_springs(cli_bench_arguments *a, cli_error_points *points)
{
    rheo_scene scene;
    cli_settled from = {0};
    rheo_error error = {""};
    bool any = false;
    for (size_t k = 0; k < CASE_COUNT; k++)
        any = cli_case_wanted(a, CASES[k].name) || any;
    if (!any)
        return CLI_DONE;
    rheo_result result = cli_pool_scene(&scene, 14, 8, 14, &error);
    if (result != RHEO_OK)
        return cli_error(result, &error);
    scene.world.ball.radius = 5;
    scene.ball.clearance = 8;
    result = cli_settle(&from, &scene, a, &error);
    rheo_scene_release(&scene);
    int status = result == RHEO_OK ? CLI_DONE : cli_error(result, &error);
    for (size_t k = 0; k < CASE_COUNT && status == CLI_DONE; k++) {
        cli_case c = {.name = CASES[k].name,
                      .quantity = {"dip", "depth_3"},
                      .reference = {NAN, NAN},
                      .absolute = {false, true},
                      .def = from.def,
                      .longest = 6,
                      .data = &from,
                      .bytes = sizeof(impact),
                      .measure = measure_impact,
                      .finish = finish_impact};
        c.def.history.stiffness = CASES[k].ratio * c.def.springs.stiffness;
        if (cli_case_wanted(a, c.name))
            status = cli_try(&c, SETTINGS, SETTING_COUNT, a, points);
    }
    cli_settled_release(&from);
    return status == CLI_DONE && !a->scenes ? add_reached(points) : status;
}
