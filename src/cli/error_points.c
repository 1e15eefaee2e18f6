/*
 * Points of `rheolog bench error`: observed orders and Pareto fronts.
 *
 * The order between two points of a series with refinements r > s and errors e, f is log(e / f) / log(r / s). A point is on
 * the front of its scene and quantity if no other point is better: costs at most as much and has an error at most as large,
 * and one of the two less.
 */
#include "cli/error.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double ROUNDING = 1e-13; /* smaller errors do not tell of a step */

cli_error_point cli_error_no_point(void)
{
    return (cli_error_point){.value = NAN,
                             .reference = NAN,
                             .error = NAN,
                             .ns_step = NAN,
                             .us_time = NAN,
                             .bytes = NAN,
                             .substeps = NAN,
                             .iterations = NAN,
                             .order = NAN};
}

cli_error_point *cli_error_add(cli_error_points *points, const cli_error_point *point)
{
    if (points->count == points->room) {
        const size_t room = 2 * points->room + 64;
        cli_error_point *item = realloc(points->item, room * sizeof *item);
        if (!item) {
            cli_fail(CLI_SYSTEM, "no memory for %zu measured points", room);
            return NULL;
        }
        points->item = item;
        points->room = room;
    }
    cli_error_point *added = &points->item[points->count++];
    *added = *point;
    added->order = NAN;
    added->front = false;
    return added;
}

double cli_error_cost(const cli_error_point *point)
{
    return isnan(point->us_time) ? point->ns_step : point->us_time;
}

static bool same_plane(const cli_error_point *a, const cli_error_point *b)
{
    return strcmp(a->scene, b->scene) == 0 && strcmp(a->quantity, b->quantity) == 0;
}

static double order_of(const cli_error_points *points, const cli_error_point *p)
{
    const cli_error_point *coarser = NULL;
    for (size_t i = 0; i < points->count && p->refinement > 0; i++) {
        const cli_error_point *q = &points->item[i];
        if (same_plane(p, q) && strcmp(p->series, q->series) == 0 && q->refinement > p->refinement &&
            (!coarser || q->refinement < coarser->refinement))
            coarser = q;
    }
    if (!coarser || fabs(p->error) < ROUNDING || fabs(coarser->error) < ROUNDING)
        return NAN;
    return log(fabs(coarser->error / p->error)) / log(coarser->refinement / p->refinement);
}

static bool is_on_front(const cli_error_points *points, const cli_error_point *p)
{
    const double cost = cli_error_cost(p), error = fabs(p->error);
    for (size_t i = 0; i < points->count; i++) {
        const cli_error_point *q = &points->item[i];
        const double other = cli_error_cost(q), its = fabs(q->error);
        if (same_plane(p, q) && other <= cost && its <= error && (other < cost || its < error))
            return false;
    }
    return isfinite(cost) && isfinite(error);
}

void cli_error_judge(cli_error_points *points)
{
    for (size_t i = 0; i < points->count; i++) {
        points->item[i].order = order_of(points, &points->item[i]);
        points->item[i].front = is_on_front(points, &points->item[i]);
    }
}
