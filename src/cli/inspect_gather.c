/* Reads the values that `rheolog inspect` prints from the world. */
#include "cli/inspect.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FEW_PARTNERS = 8 }; /* largest number of partners in a message */

static int no_memory(void)
{
    return cli_fail(CLI_SYSTEM, "no memory");
}

/* Allocates one item more, so that NULL always means: no memory. */
static void *room(size_t count, size_t size)
{
    return count < SIZE_MAX / size ? malloc((count + 1) * size) : NULL;
}

void cli_inspect_release(cli_view *v)
{
    free(v->metric);
    for (uint32_t i = 0; i < v->rankings; i++)
        free(v->ranking[i].entry);
    free(v->neighbour);
    free(v->distance);
    free(v->spring_of_particle);
    free(v->velocity);
    free(v->difference);
}

double cli_view_metric(const cli_view *v, const char *name)
{
    const uint32_t index = rheo_recording_metric_by_name(v->recording, name);
    return index < rheo_recording_metric_count(v->recording) ? v->metric[index] : NAN;
}

static int take_metrics(cli_view *v, uint64_t step)
{
    rheo_error error = {""};
    const rheo_result result = rheo_recording_metrics(v->recording, step, v->metric, &error);
    return result == RHEO_OK ? CLI_DONE : cli_file_error(v->file, result, &error);
}

static int take_ranking(cli_view *v, const rheo_ranking *ranking)
{
    const size_t particles = rheo_world_particle_count(v->world), springs = rheo_world_spring_count(v->world);
    const size_t most = ranking->top == RHEO_TOP_STIFFEST ? springs : particles;
    const size_t capacity = v->top < most ? v->top : most;
    cli_ranking *r = &v->ranking[v->rankings];
    *r = (cli_ranking){.ranking = ranking, .entry = room(capacity, sizeof *r->entry)};
    if (!r->entry)
        return no_memory();
    v->rankings++;
    rheo_error error = {""};
    const rheo_result result = rheo_world_top(v->world, ranking->top, capacity, r->entry, &r->count, &error);
    return result == RHEO_OK ? CLI_DONE : cli_file_error(v->file, result, &error);
}

static int take_rankings(cli_view *v)
{
    const rheo_ranking *ranking;
    int status = CLI_DONE;
    for (uint32_t i = 0; status == CLI_DONE && i < CLI_MAX_RANKINGS; i++) {
        if (!(ranking = rheo_world_ranking(v->world, i)))
            break;
        status = take_ranking(v, ranking);
    }
    return status;
}

/* ---- Histories ---- */

/* The weights of this many lags, and with a curve those of the very first sample. */
static void exact_weights(const rheo_world_def *def, size_t count, double *weight, double *first)
{
    if (def->history.curve_count > 0)
        rheo_history_curve_weights(def->history.curve, def->history.curve_count, def->step, count, weight, first);
    else if (def->history.weights == RHEO_WEIGHTS_PAPER)
        rheo_history_weights(def->history.order, count, weight);
    else
        rheo_history_weights_l1(def->history.order, count, weight);
}

/* The same with history.of length, whose lags have the mean weight of those between two samples. False: no memory. */
static bool weigh_samples(const rheo_world_def *def, uint32_t rows, double *weight)
{
    const uint32_t all = def->history.window + 1;
    double *exact = room(all, sizeof *exact), *first = room(all, sizeof *first);
    const bool enough = exact && first;
    if (enough)
        exact_weights(def, all, exact, first);
    for (uint32_t lag = 0, next; lag < rows && enough; lag = next) {
        double sum = 0;
        next = rheo_history_next_sample(lag, all);
        for (uint32_t k = lag; k < next; k++)
            sum += exact[k];
        for (uint32_t k = lag; k < next && k < rows; k++)
            weight[k] = sum / (next - lag);
    }
    free(exact);
    free(first);
    return enough;
}

/* Computes the weights of `rows` rows of history that count. False: no memory. */
static bool weigh(const cli_view *v, uint32_t rows, double *weight)
{
    const rheo_world_def *def = rheo_world_definition(v->world);
    const bool paper = def->history.weights == RHEO_WEIGHTS_PAPER, curve = def->history.curve_count > 0;
    if (def->history.of == RHEO_HISTORY_OF_LENGTH)
        return weigh_samples(def, rows, weight);
    double *first = room(rows, sizeof *first);
    if (!first)
        return false;
    exact_weights(def, rows, weight, first);
    /* The very first sample has a different weight until it leaves the window. */
    if ((curve || paper) && rows && rows <= rheo_world_history_window(v->world))
        weight[rows - 1] = curve ? first[rows - 1] : rheo_history_first_weight(def->history.order, rows - 1);
    free(first);
    return true;
}

/*
 * Computes the times of the rows of a history, and their weights in the fractional derivative. Rows younger than the
 * lag do not count yet. The time step may have changed, so the recorded times are used. Times before the first recorded
 * step are extrapolated.
 */
static int date(cli_view *v, cli_lag *row)
{
    const uint32_t lag = rheo_world_history_lag(v->world), young = v->rows < lag ? v->rows : lag;
    double *weight = room(v->rows, sizeof *weight);
    if (!weight || !weigh(v, v->rows - young, weight + young)) {
        free(weight);
        return no_memory();
    }
    memset(weight, 0, young * sizeof *weight);
    int status = CLI_DONE;
    for (uint32_t m = 0; m < v->rows && status == CLI_DONE; m++) {
        const uint64_t step = v->complete - m, first = v->info.first_step;
        status = take_metrics(v, step < first ? first : step);
        row[m].step = step;
        row[m].time = cli_view_metric(v, "time") -
                      (step < first ? (double)(first - step) * rheo_recording_definition(v->recording)->step : 0);
        row[m].weight = weight[m];
    }
    free(weight);
    return status == CLI_DONE ? take_metrics(v, v->complete) : status;
}

/* Reads the history of the particle, or of the spring if `pair`. */
static int take_history(cli_view *v, bool pair, cli_lag **row)
{
    *row = room(v->rows, sizeof **row);
    rheo_real *value = room(v->rows, 3 * sizeof *value);
    int status = *row && value ? date(v, *row) : no_memory();
    if (status == CLI_DONE && v->rows) {
        const uint32_t a = v->ends[0], b = v->ends[1];
        const rheo_result result = pair ? rheo_world_spring_history(v->world, a, b, value)
                                        : rheo_world_particle_history(v->world, (uint32_t)v->particle, value);
        if (result != RHEO_OK)
            status =
                cli_fail(cli_code(result), "%s: the history cannot be read: %s", v->file, rheo_result_name(result));
        for (size_t i = 0; i < 3 * (size_t)v->rows; i++)
            (*row)[i / 3].value[i % 3] = (double)value[i];
    }
    free(value);
    return status;
}

/* Reads the modes of a history, if it has modes. Only the stage `history` changes them. */
static void take_modes(cli_view *v, bool pair)
{
    if (v->modes == 0)
        return;
    if (pair)
        rheo_world_spring_modes(v->world, v->ends[0], v->ends[1], v->spring_mode);
    else
        rheo_world_particle_modes(v->world, (uint32_t)v->particle, v->particle_mode);
}

/* ---- Springs ---- */

const struct cli_spring_quantity CLI_SPRING_QUANTITIES[CLI_SPRING_VALUES] = {
    {"rest_length", "L", "length without force"},
    {"length", "L", "present length"},
    {"stretch", "1", "extension in rest lengths"},
    {"history_rate", "L/T^q", "|D^q| of the difference of its ends"},
    {"stiffness", "1/T^2", "stiffness from the present history"},
    {"kappa", "1", "substep^2 stiffness"},
};

static void spring_values(const rheo_spring_state *s, double value[CLI_SPRING_VALUES])
{
    const double rest = (double)s->spring.rest_length;
    const double values[CLI_SPRING_VALUES] = {
        rest, s->length, rest > 0 ? s->length / rest - 1 : NAN, s->history_rate, s->stiffness, s->kappa};
    memcpy(value, values, sizeof values);
}

/* Reads the springs of a particle, ordered by the id at the other end. */
static int take_springs(const cli_view *v, uint32_t id, cli_spring **springs, size_t *count)
{
    const size_t all = rheo_world_spring_count(v->world);
    rheo_spring *spring = room(all, sizeof *spring);
    rheo_error error = {""};
    rheo_result result = spring ? rheo_world_springs(v->world, spring, all) : RHEO_ERROR_MEMORY;
    size_t own = 0;
    *count = 0;
    /* The world's springs are ordered by smaller, then by larger id, so partners with smaller ids come first. */
    for (size_t k = 0; result == RHEO_OK && k < all; k++)
        if (spring[k].a == id || spring[k].b == id)
            spring[own++] = spring[k];
    *springs = room(own, sizeof **springs);
    if (!*springs)
        result = RHEO_ERROR_MEMORY;
    for (; result == RHEO_OK && *count < own; ++*count) {
        const uint32_t a = spring[*count].a, b = spring[*count].b;
        cli_spring *to = &(*springs)[*count];
        rheo_spring_state state = {0};
        result = rheo_world_spring(v->world, a, b, &state, &error);
        to->partner = a == id ? b : a;
        spring_values(&state, to->value);
    }
    free(spring);
    return result == RHEO_OK ? CLI_DONE : cli_file_error(v->file, result, &error);
}

/* Prints that two particles are not connected, and lists the partners of the first one. */
static int not_connected(const cli_view *v)
{
    cli_spring *spring = NULL;
    size_t count = 0;
    const int status = take_springs(v, v->ends[0], &spring, &count);
    char text[256] = "none";
    for (size_t i = 0, length = 0; i < count && i < FEW_PARTNERS; i++, length = strlen(text))
        snprintf(text + length, sizeof text - length, "%s%u", i ? ", " : "", spring[i].partner);
    if (count > FEW_PARTNERS)
        snprintf(text + strlen(text), sizeof text - strlen(text), " and %zu more", count - FEW_PARTNERS);
    free(spring);
    return status == CLI_DONE
               ? cli_fail(CLI_BAD,
                          "particles %u and %u are not connected by a spring at step %llu; particle %u "
                          "has springs to %s",
                          v->ends[0], v->ends[1], (unsigned long long)v->step, v->ends[0], text)
               : status;
}

/* ---- The particle and the spring ---- */

static int check_particle(const cli_view *v, const char *option, uint64_t id)
{
    const unsigned long long particles = rheo_world_particle_count(v->world);
    if (id < particles)
        return CLI_DONE;
    if (particles == 0)
        return cli_fail(CLI_BAD, "%s: %s has no particles at step %llu", option, v->file,
                        (unsigned long long)v->step);
    return cli_fail(CLI_BAD, "%s: there is no particle %llu at step %llu; ids go from 0 to %llu", option,
                    (unsigned long long)id, (unsigned long long)v->step, particles - 1);
}

static int take_particle(cli_view *v)
{
    int status = check_particle(v, "--particle", v->particle);
    if (status != CLI_DONE)
        return status;
    const uint32_t id = (uint32_t)v->particle;
    rheo_error error = {""};
    size_t count = 0;
    rheo_result result = rheo_world_particle(v->world, id, &v->state, &error);
    if (result == RHEO_OK) {
        v->neighbour = room(v->state.neighbours, sizeof *v->neighbour);
        v->distance = room(v->state.neighbours, sizeof *v->distance);
        if (!v->neighbour || !v->distance)
            return no_memory();
        result = rheo_world_neighbours(v->world, id, v->neighbour, v->distance, v->state.neighbours, &count, &error);
        v->neighbours = count;
    }
    if (result != RHEO_OK)
        return cli_file_error(v->file, result, &error);
    if (!v->model_has_springs)
        return CLI_DONE;
    if ((status = take_springs(v, id, &v->spring_of_particle, &v->springs)) != CLI_DONE)
        return status;
    take_modes(v, false);
    return take_history(v, false, &v->velocity);
}

static int take_spring(cli_view *v)
{
    if (!v->model_has_springs)
        return cli_fail(CLI_BAD, "--spring: the model %s has no springs; --particle shows a particle of %s",
                        rheo_model_name(rheo_world_definition(v->world)->model), v->file);
    for (int e = 0; e < 2; e++) {
        const int status = check_particle(v, "--spring", v->end[e]);
        if (status != CLI_DONE)
            return status;
        v->ends[e] = (uint32_t)v->end[e];
    }
    rheo_spring_state state;
    if (rheo_world_spring(v->world, v->ends[0], v->ends[1], &state, NULL) != RHEO_OK)
        return not_connected(v);
    v->ends[0] = state.spring.a;
    v->ends[1] = state.spring.b;
    spring_values(&state, v->spring);
    take_modes(v, true);
    return take_history(v, true, &v->difference);
}

const double *cli_quantity_value(const cli_view *v, const rheo_quantity *quantity)
{
    return (const double *)(const void *)((const char *)&v->state + quantity->offset);
}

int cli_inspect_gather(cli_view *v)
{
    v->metric = room(rheo_recording_metric_count(v->recording), sizeof *v->metric);
    if (!v->metric)
        return no_memory();
    int status = take_metrics(v, v->complete);
    if (status == CLI_DONE && v->has_rankings)
        status = take_rankings(v);
    if (status == CLI_DONE && v->has_particle)
        status = take_particle(v);
    if (status == CLI_DONE && v->has_spring)
        status = take_spring(v);
    return status;
}
