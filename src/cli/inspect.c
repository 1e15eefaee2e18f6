/*
 * rheolog inspect: what is in a state, at the end of a step or between two of its stages. Everything is gathered
 * first and then printed, for people or as JSON, so that both say the same.
 */
#include "cli/cli.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli/scene_json.h"

enum {
    LISTS = 6,
    FEW_ROWS = 8,     /* of a particle's history, in text */
    FEW_PARTNERS = 8, /* in a message */
    DEFAULT_TOP = 5,
};

/* A row of a history: of a particle its velocity, of a spring the difference of the velocities of its ends. */
typedef struct lag {
    uint64_t step; /* at whose end it was so */
    double time, weight, value[3];
} lag;

typedef struct view {
    /* What is asked for. */
    const char *file, *stage; /* stage: NULL for the end of the step */
    uint64_t step, particle, end[2];
    bool has_particle, has_spring, has_lists;
    size_t top;

    rheo_recording *recording;
    rheo_recording_info info;
    bool failed; /* the run ended with a step that went bad */
    rheo_failure failure;
    char why[512]; /* message of the failure */

    const rheo_world *world;
    uint64_t complete; /* the last step that the world has finished */
    bool melting;
    const char *done; /* the stage that was made last of the next one, "viscosity@3"; NULL between steps */
    char stage_run[32];
    uint32_t stages, places; /* how many have been made of the next step, and how many it has */
    uint32_t rows;           /* of the history */
    double *metric;          /* of the last whole step, as stored */
    rheo_top_entry *list[LISTS];
    size_t listed[LISTS];

    rheo_particle_state state;
    uint32_t *neighbour;
    double *distance;
    size_t neighbours, partners;
    rheo_spring_state *partner;
    lag *velocity;

    rheo_spring_state spring;
    lag *difference;
    rheo_mode_state particle_mode[RHEO_HISTORY_MAX_MODES], spring_mode[RHEO_HISTORY_MAX_MODES];
} view;

enum { THICKENING = 1 << RHEO_MODEL_THICKENING, MELTING = 1 << RHEO_MODEL_MELTING };

static const struct {
    const char *name, *value, *about;
    rheo_top what;
    unsigned models;
} lists[LISTS] = {
    {"densest", "density", "sum of (1 - r/h)^2", RHEO_TOP_DENSEST, THICKENING},
    {"densest", "density", "M/L^3", RHEO_TOP_DENSEST, MELTING},
    {"fastest", "speed", "L/T", RHEO_TOP_FASTEST, THICKENING | MELTING},
    {"stiffest", "kappa", "step^2 stiffness, from the velocities remembered now", RHEO_TOP_STIFFEST, THICKENING},
    {"hottest", "temperature", "K", RHEO_TOP_HOTTEST, MELTING},
    {"furthest", "displacement", "from where it began, L", RHEO_TOP_FURTHEST, MELTING},
};

static int no_memory(void)
{
    return cli_fail(CLI_SYSTEM, "no memory");
}

/* Room for some more than nothing, so that NULL means that there is no memory. */
static void *room(size_t count, size_t size)
{
    return count < SIZE_MAX / size ? malloc((count + 1) * size) : NULL;
}

static void release(view *v)
{
    free(v->metric);
    for (int i = 0; i < LISTS; i++)
        free(v->list[i]);
    free(v->neighbour);
    free(v->distance);
    free(v->partner);
    free(v->velocity);
    free(v->difference);
}

/* ---- Where to look ---- */

static int check_step(const view *v)
{
    const unsigned long long first = v->info.first_step, last = v->info.last_step, step = v->step;
    const bool bad = v->failed && v->step == v->failure.step;
    if (bad && !v->stage)
        return cli_fail(CLI_BAD,
                        "step %llu went bad and has no state; --step %llu is the last good one, and --stage "
                        "NAME shows how far step %llu came%s%s",
                        step, last, step, v->failure.stage[0] ? " before stage " : "", v->failure.stage);
    if (bad || (v->step >= first + (v->stage != NULL) && v->step <= last))
        return CLI_DONE;
    if (!v->stage)
        return cli_fail(CLI_BAD, "the recording holds steps %llu to %llu; --step %llu is none of them", first, last,
                        step);
    if (first == last && !v->failed)
        return cli_fail(CLI_BAD,
                        "the recording holds the state at step %llu and no steps; --stage has none to look "
                        "into",
                        first);
    return cli_fail(CLI_BAD,
                    "--stage looks into a step that was made: steps %llu to %llu; --step %llu is none of them",
                    first + 1, v->failed ? (unsigned long long)v->failure.step : last, step);
}

static int check_stage(const view *v, const rheo_world *world)
{
    char all[1024] = "", asked[64];
    const char *nearest = "";
    rheo_stage_info stage;
    /* Without its substep, of which the player judges. */
    snprintf(asked, sizeof asked, "%.*s", (int)strcspn(v->stage, "@"), v->stage);
    for (uint32_t i = 0; rheo_world_stage(world, i, &stage) == RHEO_OK; i++) {
        if (strcmp(stage.name, asked) == 0)
            return CLI_DONE;
        nearest = i == 0 ? stage.name : rheo_nearest_word(asked, (const char *const[]){nearest, stage.name}, 2);
        const size_t length = strlen(all);
        snprintf(all + length, sizeof all - length, "%s%s", i ? ", " : "", stage.name);
    }
    return cli_fail(CLI_BAD, "there is no stage \"%s\" in this recording; did you mean \"%s\"? Its stages: %s",
                    v->stage, nearest, all);
}

static int go_there(view *v, rheo_player *player)
{
    int status = check_step(v);
    if (status == CLI_DONE && v->stage)
        status = check_stage(v, rheo_player_world(player));
    if (status != CLI_DONE)
        return status;
    rheo_error error = {""};
    const rheo_result result = v->stage ? rheo_player_seek_stage(player, v->step, v->stage, &error)
                                        : rheo_player_seek(player, v->step, &error);
    if (result != RHEO_OK)
        return cli_error(result, &error);
    v->world = rheo_player_world(player);
    v->complete = rheo_world_step_count(v->world);
    v->rows = rheo_world_history_rows(v->world);
    v->melting = rheo_world_definition(v->world)->model == RHEO_MODEL_MELTING;
    v->stages = rheo_world_stages_done(v->world);
    v->places = rheo_world_stages_in_step(v->world);
    rheo_world_last_stage(v->world, v->stage_run);
    v->done = v->stage_run[0] ? v->stage_run : NULL;
    return CLI_DONE;
}

/* ---- Gathering ---- */

/* A metric of the last whole step; NaN if the recording does not have it. */
static double metric(const view *v, const char *name)
{
    for (uint32_t i = 0; i < rheo_recording_metric_count(v->recording); i++)
        if (strcmp(rheo_recording_metric_name(v->recording, i), name) == 0)
            return v->metric[i];
    return NAN;
}

static int take_metrics(view *v, uint64_t step)
{
    rheo_error error = {""};
    const rheo_result result = rheo_recording_metrics(v->recording, step, v->metric, &error);
    return result == RHEO_OK ? CLI_DONE : cli_error(result, &error);
}

/* Whether a list is one of the world's model, or stays away. */
static bool has_list(const view *v, int i)
{
    return lists[i].models >> rheo_world_definition(v->world)->model & 1;
}

static int take_lists(view *v)
{
    const size_t particles = rheo_world_particle_count(v->world), springs = rheo_world_spring_count(v->world);
    for (int i = 0; i < LISTS; i++) {
        const size_t most = lists[i].what == RHEO_TOP_STIFFEST ? springs : particles;
        const size_t capacity = v->top < most ? v->top : most;
        if (!has_list(v, i))
            continue;
        rheo_error error = {""};
        v->list[i] = room(capacity, sizeof *v->list[i]);
        if (!v->list[i])
            return no_memory();
        const rheo_result result =
            rheo_world_top(v->world, lists[i].what, capacity, v->list[i], &v->listed[i], &error);
        if (result != RHEO_OK)
            return cli_error(result, &error);
    }
    return CLI_DONE;
}

/*
 * When the rows of a history were, and what they weigh in the fractional derivative. The time step may have changed,
 * so times are those stored with the steps; what was before the recording is counted back from its beginning.
 */
static int date(view *v, lag *row)
{
    const rheo_world_def *def = rheo_world_definition(v->world);
    double *weight = room(v->rows, sizeof *weight);
    if (!weight)
        return no_memory();
    if (def->history.weights == RHEO_WEIGHTS_PAPER)
        rheo_history_weights(def->history.order, v->rows, weight);
    else
        rheo_history_weights_l1(def->history.order, v->rows, weight);
    /* The first sample of all has a weight of its own until it leaves the window. */
    if (def->history.weights == RHEO_WEIGHTS_PAPER && v->rows && v->rows <= rheo_world_history_window(v->world))
        weight[v->rows - 1] = rheo_history_first_weight(def->history.order, v->rows - 1);
    int status = CLI_DONE;
    for (uint32_t m = 0; m < v->rows && status == CLI_DONE; m++) {
        const uint64_t step = v->complete - m, first = v->info.first_step;
        status = take_metrics(v, step < first ? first : step);
        row[m].step = step;
        row[m].time = metric(v, "time") -
                      (step < first ? (double)(first - step) * rheo_recording_definition(v->recording)->step : 0);
        row[m].weight = weight[m];
    }
    free(weight);
    return status == CLI_DONE ? take_metrics(v, v->complete) : status;
}

/* The history of a particle, or of a spring where `pair`. */
static int take_history(view *v, bool pair, lag **row)
{
    *row = room(v->rows, sizeof **row);
    rheo_real *value = room(v->rows, 3 * sizeof *value);
    int status = *row && value ? date(v, *row) : no_memory();
    if (status == CLI_DONE && v->rows) {
        const uint32_t a = v->spring.spring.a, b = v->spring.spring.b;
        const rheo_result result = pair ? rheo_world_spring_history(v->world, a, b, value)
                                        : rheo_world_particle_history(v->world, (uint32_t)v->particle, value);
        if (result != RHEO_OK)
            status = cli_fail(cli_code(result), "the history cannot be read: %s", rheo_result_name(result));
        for (size_t i = 0; i < 3 * (size_t)v->rows; i++)
            (*row)[i / 3].value[i % 3] = (double)value[i];
    }
    free(value);
    return status;
}

/* The sums of a memory that has some; a stage in the middle of a step changes none of them. */
static void take_modes(view *v, bool pair)
{
    if (rheo_world_history_modes(v->world) == 0)
        return;
    if (pair)
        rheo_world_spring_modes(v->world, v->spring.spring.a, v->spring.spring.b, v->spring_mode);
    else
        rheo_world_particle_modes(v->world, (uint32_t)v->particle, v->particle_mode);
}

/* The springs of a particle, by their other ends. */
static int take_partners(const view *v, uint32_t id, rheo_spring_state **partner, size_t *count)
{
    const size_t all = rheo_world_spring_count(v->world);
    rheo_spring *spring = room(all, sizeof *spring);
    rheo_error error = {""};
    rheo_result result = spring ? rheo_world_springs(v->world, spring, all) : RHEO_ERROR_MEMORY;
    size_t own = 0;
    *count = 0;
    /* By smaller, then by larger id: those that end at the particle come before those that begin there. */
    for (size_t k = 0; result == RHEO_OK && k < all; k++)
        if (spring[k].a == id || spring[k].b == id)
            spring[own++] = spring[k];
    *partner = room(own, sizeof **partner);
    if (!*partner)
        result = RHEO_ERROR_MEMORY;
    for (; result == RHEO_OK && *count < own; ++*count)
        result = rheo_world_spring(v->world, spring[*count].a, spring[*count].b, &(*partner)[*count], &error);
    free(spring);
    return result == RHEO_OK ? CLI_DONE : cli_error(result, &error);
}

static int check_particle(const view *v, const char *option, uint64_t id)
{
    const unsigned long long particles = rheo_world_particle_count(v->world);
    if (id < particles)
        return CLI_DONE;
    if (particles == 0)
        return cli_fail(CLI_BAD, "%s: the world has no particles at step %llu", option, (unsigned long long)v->step);
    return cli_fail(CLI_BAD, "%s: there is no particle %llu at step %llu; ids go from 0 to %llu", option,
                    (unsigned long long)id, (unsigned long long)v->step, particles - 1);
}

static int take_particle(view *v)
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
        return cli_error(result, &error);
    if (v->melting)
        return CLI_DONE;
    if ((status = take_partners(v, id, &v->partner, &v->partners)) != CLI_DONE)
        return status;
    take_modes(v, false);
    return take_history(v, false, &v->velocity);
}

static uint32_t other_end(const rheo_spring *spring, uint32_t id)
{
    return spring->a == id ? spring->b : spring->a;
}

/* Says that two particles are not connected, and which are. */
static int not_connected(const view *v)
{
    const uint32_t a = (uint32_t)v->end[0], b = (uint32_t)v->end[1];
    rheo_spring_state *partner = NULL;
    size_t count = 0;
    const int status = take_partners(v, a, &partner, &count);
    char text[256] = "none";
    for (size_t i = 0, length = 0; i < count && i < FEW_PARTNERS; i++, length = strlen(text))
        snprintf(text + length, sizeof text - length, "%s%u", i ? ", " : "", other_end(&partner[i].spring, a));
    if (count > FEW_PARTNERS)
        snprintf(text + strlen(text), sizeof text - strlen(text), " and %zu more", count - FEW_PARTNERS);
    free(partner);
    return status == CLI_DONE
               ? cli_fail(CLI_BAD,
                          "particles %u and %u are not connected by a spring at step %llu; particle %u "
                          "has springs to %s",
                          a, b, (unsigned long long)v->step, a, text)
               : status;
}

static int take_spring(view *v)
{
    if (v->melting)
        return cli_fail(CLI_BAD,
                        "--spring: %s melts, and the model melting has no springs; --particle shows one of its "
                        "particles",
                        v->file);
    for (int e = 0; e < 2; e++) {
        const int status = check_particle(v, "--spring", v->end[e]);
        if (status != CLI_DONE)
            return status;
    }
    if (rheo_world_spring(v->world, (uint32_t)v->end[0], (uint32_t)v->end[1], &v->spring, NULL) != RHEO_OK)
        return not_connected(v);
    take_modes(v, true);
    return take_history(v, true, &v->difference);
}

static int gather(view *v)
{
    v->metric = room(rheo_recording_metric_count(v->recording), sizeof *v->metric);
    if (!v->metric)
        return no_memory();
    int status = take_metrics(v, v->complete);
    if (status == CLI_DONE && v->has_lists)
        status = take_lists(v);
    if (status == CLI_DONE && v->has_particle)
        status = take_particle(v);
    if (status == CLI_DONE && v->has_spring)
        status = take_spring(v);
    return status;
}

/* How far a spring is out of its rest length, in rest lengths. */
static double stretch(const rheo_spring_state *s)
{
    return s->spring.rest_length > 0 ? s->length / (double)s->spring.rest_length - 1 : NAN;
}

static const char *item_name(rheo_location per)
{
    static const char *const names[] = {"world", "particle", "spring", "body", "vibrator"};
    return names[per];
}

/* ---- JSON ---- */

static void json_failure(cli_json *json, const view *v)
{
    if (!v->failed) {
        cli_json_null(json, "failure");
        return;
    }
    const rheo_failure *f = &v->failure;
    cli_json_begin_object(json, "failure");
    cli_json_integer(json, "step", f->step);
    cli_json_text(json, "stage", f->stage[0] ? f->stage : NULL);
    cli_json_text(json, "field", f->field);
    cli_json_text(json, "item", item_name(f->location));
    cli_json_integer(json, "id", f->id);
    cli_json_integer(json, "component", f->component);
    cli_json_text(json, "message", v->why);
    cli_json_end_object(json);
}

static void json_bodies(cli_json *json, const view *v)
{
    rheo_body body;
    cli_json_begin_list(json, "bodies");
    for (uint32_t i = 0; rheo_world_body(v->world, i, &body) == RHEO_OK; i++) {
        cli_json_begin_object(json, NULL);
        cli_json_integer(json, "id", i);
        cli_json_vector(json, "position", body.position, 3);
        cli_json_vector(json, "velocity", body.velocity, 3);
        cli_json_vector(json, "spin", body.spin, 3);
        cli_json_number(json, "radius", body.radius);
        cli_json_number(json, "mass", body.mass);
        cli_json_end_object(json);
    }
    cli_json_end_list(json);
}

static void json_metrics(cli_json *json, const view *v)
{
    cli_json_begin_object(json, "metrics");
    for (uint32_t i = 0; i < rheo_recording_metric_count(v->recording); i++)
        cli_json_number(json, rheo_recording_metric_name(v->recording, i), v->metric[i]);
    cli_json_end_object(json);
}

static void json_lists(cli_json *json, const view *v)
{
    for (int i = 0; i < LISTS; i++) {
        if (!has_list(v, i))
            continue;
        cli_json_begin_list(json, lists[i].name);
        for (size_t n = 0; n < v->listed[i]; n++) {
            const rheo_top_entry *entry = &v->list[i][n];
            cli_json_begin_object(json, NULL);
            cli_json_integer(json, "id", entry->id);
            if (lists[i].what == RHEO_TOP_STIFFEST)
                cli_json_integer(json, "other_id", entry->other_id);
            cli_json_number(json, lists[i].value, entry->value);
            cli_json_end_object(json);
        }
        cli_json_end_list(json);
    }
}

static void json_history(cli_json *json, const view *v, const lag *row, const char *key)
{
    cli_json_begin_list(json, "history");
    for (uint32_t m = 0; m < v->rows; m++) {
        cli_json_begin_object(json, NULL);
        cli_json_integer(json, "lag", m);
        cli_json_integer(json, "step", row[m].step);
        cli_json_number(json, "time", row[m].time);
        cli_json_number(json, "weight", row[m].weight);
        cli_json_vector(json, key, row[m].value, 3);
        cli_json_end_object(json);
    }
    cli_json_end_list(json);
}

static void json_modes(cli_json *json, const view *v, const rheo_mode_state *mode)
{
    cli_json_begin_list(json, "modes");
    for (uint32_t k = 0; k < rheo_world_history_modes(v->world); k++) {
        cli_json_begin_object(json, NULL);
        cli_json_number(json, "decay", mode[k].decay);
        cli_json_number(json, "weight", mode[k].weight);
        cli_json_vector(json, "sum", mode[k].sum, 3);
        cli_json_end_object(json);
    }
    cli_json_end_list(json);
}

static void json_spring_values(cli_json *json, const rheo_spring_state *s)
{
    cli_json_number(json, "rest_length", (double)s->spring.rest_length);
    cli_json_number(json, "length", s->length);
    cli_json_number(json, "stretch", stretch(s));
    cli_json_number(json, "history_rate", s->history_rate);
    cli_json_number(json, "stiffness", s->stiffness);
    cli_json_number(json, "kappa", s->kappa);
}

static void json_of_thickening(cli_json *json, const rheo_particle_state *p)
{
    cli_json_number(json, "near_density", p->near_density);
    cli_json_number(json, "pressure", p->pressure);
    cli_json_number(json, "near_pressure", p->near_pressure);
    cli_json_vector(json, "derivative", p->derivative, 3);
}

static void json_of_melting(cli_json *json, const rheo_particle_state *p)
{
    cli_json_number(json, "summed_density", p->summed_density);
    cli_json_number(json, "pressure", p->pressure);
    cli_json_number(json, "temperature", p->temperature);
    cli_json_number(json, "jump_number", p->jump_number);
    cli_json_number(json, "shear_rate", p->shear_rate);
    cli_json_number(json, "viscosity", p->viscosity);
    cli_json_vector(json, "start_position", p->start_position, 3);
    cli_json_number(json, "displacement", p->displacement);
}

static void json_springs(cli_json *json, const view *v)
{
    cli_json_begin_list(json, "springs");
    for (size_t i = 0; i < v->partners; i++) {
        cli_json_begin_object(json, NULL);
        cli_json_integer(json, "partner", other_end(&v->partner[i].spring, (uint32_t)v->particle));
        json_spring_values(json, &v->partner[i]);
        cli_json_end_object(json);
    }
    cli_json_end_list(json);
}

static void json_particle(cli_json *json, const view *v)
{
    const rheo_particle_state *p = &v->state;
    cli_json_begin_object(json, "particle");
    cli_json_integer(json, "id", v->particle);
    cli_json_vector(json, "position", p->position, 3);
    cli_json_vector(json, "velocity", p->velocity, 3);
    cli_json_number(json, "speed", p->speed);
    cli_json_number(json, "density", p->density);
    if (v->melting)
        json_of_melting(json, p);
    else
        json_of_thickening(json, p);
    cli_json_begin_list(json, "neighbours");
    for (size_t i = 0; i < v->neighbours; i++) {
        cli_json_begin_object(json, NULL);
        cli_json_integer(json, "id", v->neighbour[i]);
        cli_json_number(json, "distance", v->distance[i]);
        cli_json_number(json, "weight", rheo_world_weight(v->world, v->distance[i]));
        cli_json_end_object(json);
    }
    cli_json_end_list(json);
    if (!v->melting) {
        json_springs(json, v);
        json_history(json, v, v->velocity, "velocity");
        json_modes(json, v, v->particle_mode);
    }
    cli_json_end_object(json);
}

static void json_spring(cli_json *json, const view *v)
{
    cli_json_begin_object(json, "spring");
    cli_json_integer(json, "a", v->spring.spring.a);
    cli_json_integer(json, "b", v->spring.spring.b);
    json_spring_values(json, &v->spring);
    json_history(json, v, v->difference, "difference");
    json_modes(json, v, v->spring_mode);
    cli_json_end_object(json);
}

static void print_json(const view *v)
{
    cli_json json = {.file = stdout};
    cli_json_begin_object(&json, NULL);
    cli_json_text(&json, "file", v->file);
    cli_json_text(&json, "scene", v->info.scene);
    cli_json_text(&json, "model", rheo_model_name(rheo_world_definition(v->world)->model));
    cli_json_integer(&json, "step", v->step);
    cli_json_text(&json, "stage", v->done);
    cli_json_number(&json, "time", rheo_world_time(v->world));
    cli_json_hash(&json, "hash", rheo_world_hash(v->world));
    cli_json_integer(&json, "particles", rheo_world_particle_count(v->world));
    cli_json_integer(&json, "springs", rheo_world_spring_count(v->world));
    json_failure(&json, v);
    json_bodies(&json, v);
    json_metrics(&json, v);
    if (v->has_lists)
        json_lists(&json, v);
    if (v->has_particle)
        json_particle(&json, v);
    if (v->has_spring)
        json_spring(&json, v);
    cli_json_end_object(&json);
}

/* ---- Text ---- */

static void text_vector(const char *label, const double value[3], const char *unit)
{
    printf("%-14s%.6g, %.6g, %.6g %s\n", label, value[0], value[1], value[2], unit);
}

static void text_bodies(const view *v)
{
    rheo_body body;
    for (uint32_t i = 0; rheo_world_body(v->world, i, &body) == RHEO_OK; i++) {
        text_vector("ball", body.position, "L");
        text_vector("  velocity", body.velocity, "L/T");
        text_vector("  spin", body.spin, "1/T");
    }
}

/* What tells the health of a step, and where it is worst. */
static void text_metrics(const view *v)
{
    static const struct {
        const char *name, *unit, *id, *other_id;
    } shown[] = {
        {"max_speed", "L/T", "max_speed_id", NULL},
        {"courant_number", "", NULL, NULL},
        {"stiffness_number", "", "stiffness_a", "stiffness_b"},
        {"stiffness_sum", "", "stiffness_sum_id", NULL},
        {"max_density", "rest densities", "max_density_id", NULL},
        {"density_error", "rest densities", NULL, NULL},
        {"max_density_error", "rest densities", "max_density_id", NULL},
        {"kinetic_energy", "mass L^2/T^2", NULL, NULL},
        {"energy_jump", "", NULL, NULL},
        {"neighbours", "on average", NULL, NULL},
        {"substeps", "", NULL, NULL},
        {"iterations", "in all substeps", NULL, NULL},
        {"heat", "mass K", NULL, NULL},
        {"hot_height", "heights of the object", NULL, NULL},
        {"cold_height", "heights of the object", NULL, NULL},
        {"hot_spread", "heights of the object", NULL, NULL},
        {"cold_displacement", "heights of the object", NULL, NULL},
    };
    printf("\nmetrics of step %llu\n", (unsigned long long)v->complete);
    for (size_t i = 0; i < sizeof shown / sizeof shown[0]; i++) {
        const double value = metric(v, shown[i].name);
        const double id = shown[i].id ? metric(v, shown[i].id) : -1;
        if (isnan(value))
            continue;
        printf("  %-18s%-*.6g", shown[i].name, *shown[i].unit || id >= 0 ? 12 : 0, value);
        if (*shown[i].unit)
            printf(" %s%s", shown[i].unit, id >= 0 ? "," : "");
        if (id >= 0 && shown[i].other_id)
            printf(" spring %.0f:%.0f", id, metric(v, shown[i].other_id));
        else if (id >= 0)
            printf(" particle %.0f", id);
        putchar('\n');
    }
}

static void text_lists(const view *v)
{
    for (int i = 0; i < LISTS; i++) {
        if (!has_list(v, i))
            continue;
        printf("\n%s: %s, %s\n", lists[i].name, lists[i].value, lists[i].about);
        for (size_t n = 0; n < v->listed[i]; n++) {
            const rheo_top_entry *entry = &v->list[i][n];
            char name[32];
            snprintf(name, sizeof name, lists[i].what == RHEO_TOP_STIFFEST ? "%u:%u" : "%u", (unsigned)entry->id,
                     (unsigned)entry->other_id);
            printf("  %-18s%.6g\n", name, entry->value);
        }
        if (v->listed[i] == 0)
            puts("  none");
    }
}

static void text_history(const view *v, const lag *row, uint32_t shown, const char *what)
{
    printf("\nhistory: %u rows", (unsigned)v->rows);
    if (shown < v->rows)
        printf(", the newest %u", (unsigned)shown);
    putchar('\n');
    if (v->rows == 0)
        return;
    printf("  %5s %8s %11s %11s   %s\n", "lag", "step", "time", "weight", what);
    for (uint32_t m = 0; m < shown; m++)
        printf("  %5u %8llu %11.6g %11.6g   %13.6g %13.6g %13.6g\n", (unsigned)m, (unsigned long long)row[m].step,
               row[m].time, row[m].weight, row[m].value[0], row[m].value[1], row[m].value[2]);
}

/* D^q is C0 (the newest velocity + the sum over the modes of weight times sum). */
static void text_modes(const view *v, const rheo_mode_state *mode, const char *what)
{
    const uint32_t modes = rheo_world_history_modes(v->world);
    if (modes == 0)
        return;
    printf("\nmodes: %u, decaying sums over what is older than the newest velocity\n", (unsigned)modes);
    printf("  %11s %11s   sum of the %s\n", "decay", "weight", what);
    for (uint32_t k = 0; k < modes; k++)
        printf("  %11.6g %11.6g   %13.6g %13.6g %13.6g\n", mode[k].decay, mode[k].weight, mode[k].sum[0],
               mode[k].sum[1], mode[k].sum[2]);
}

static void text_of_thickening(const rheo_particle_state *p)
{
    printf("%-14s%.6g, of near neighbours %.6g\n", "density", p->density, p->near_density);
    printf("%-14s%.6g, of near neighbours %.6g L/T^2\n", "pressure", p->pressure, p->near_pressure);
    text_vector("derivative", p->derivative, "L/T^q, of order q from its history");
}

static void text_of_melting(const rheo_particle_state *p)
{
    printf("%-14s%.6g M/L^3, %.6g by its neighbours\n", "density", p->density, p->summed_density);
    printf("%-14s%.6g M/(L T^2)\n", "pressure", p->pressure);
    printf("%-14s%.6g K\n", "temperature", p->temperature);
    printf("%-14s%.6g\n", "jump number", p->jump_number);
    printf("%-14s%.6g 1/T\n", "shear rate", p->shear_rate);
    printf("%-14s%.6g M/(L T), apparent\n", "viscosity", p->viscosity);
    text_vector("began at", p->start_position, "L");
    printf("%-14s%.6g L from there\n", "displaced", p->displacement);
}

static void text_particle(const view *v)
{
    const rheo_particle_state *p = &v->state;
    printf("\nparticle      %llu\n", (unsigned long long)v->particle);
    text_vector("position", p->position, "L");
    text_vector("velocity", p->velocity, "L/T");
    printf("%-14s%.6g L/T\n", "speed", p->speed);
    if (v->melting)
        text_of_melting(p);
    else
        text_of_thickening(p);
    printf("\nneighbours: %zu\n", v->neighbours);
    if (v->neighbours)
        printf("  %8s %12s %12s\n", "id", "distance", v->melting ? "W, 1/L^3" : "1 - r/h");
    for (size_t i = 0; i < v->neighbours; i++)
        printf("  %8u %12.6g %12.6g\n", (unsigned)v->neighbour[i], v->distance[i],
               rheo_world_weight(v->world, v->distance[i]));
    if (v->melting)
        return;
    printf("\nsprings: %zu\n", v->partners);
    if (v->partners)
        printf("  %8s %12s %12s %12s %12s %12s %12s\n", "to", "rest length", "length", "stretch", "history rate",
               "stiffness", "kappa");
    for (size_t i = 0; i < v->partners; i++) {
        const rheo_spring_state *s = &v->partner[i];
        printf("  %8u %12.6g %12.6g %12.4g %12.6g %12.6g %12.6g\n",
               (unsigned)other_end(&s->spring, (uint32_t)v->particle), (double)s->spring.rest_length, s->length,
               stretch(s), s->history_rate, s->stiffness, s->kappa);
    }
    text_history(v, v->velocity, v->rows < FEW_ROWS ? v->rows : FEW_ROWS, "velocity, L/T");
    text_modes(v, v->particle_mode, "velocity, L/T");
}

static void text_spring(const view *v)
{
    const rheo_spring_state *s = &v->spring;
    printf("\nspring        %u:%u\n", (unsigned)s->spring.a, (unsigned)s->spring.b);
    printf("%-14s%.6g L\n", "rest length", (double)s->spring.rest_length);
    printf("%-14s%.6g L, stretched by %.4g rest lengths\n", "length", s->length, stretch(s));
    printf("%-14s%.6g L/T^q, of the difference of its ends\n", "history rate", s->history_rate);
    printf("%-14s%.6g 1/T^2\n", "stiffness", s->stiffness);
    printf("%-14s%.6g = step^2 stiffness\n", "kappa", s->kappa);
    char what[64];
    snprintf(what, sizeof what, "velocity of %u - that of %u, L/T", (unsigned)s->spring.a, (unsigned)s->spring.b);
    text_history(v, v->difference, v->rows, what);
    text_modes(v, v->spring_mode, what);
}

static void print_text(const view *v)
{
    printf("%s\n", v->file);
    printf("%-14s%s\n", "scene", v->info.scene[0] ? v->info.scene : "without a name");
    printf("%-14s%llu", "step", (unsigned long long)v->step);
    if (v->done)
        printf(", after stage %s, %u of its %u stages", v->done, (unsigned)v->stages, (unsigned)v->places);
    printf("\n%-14s%.6g T%s\n", "time", rheo_world_time(v->world), v->done ? " at the beginning of the step" : "");
    printf("%-14s%016llx\n", "hash", (unsigned long long)rheo_world_hash(v->world));
    printf("%-14s%u\n", "particles", (unsigned)rheo_world_particle_count(v->world));
    if (!v->melting)
        printf("%-14s%zu\n", "springs", rheo_world_spring_count(v->world));
    text_bodies(v);
    text_metrics(v);
    if (v->has_lists)
        text_lists(v);
    if (v->has_particle)
        text_particle(v);
    if (v->has_spring)
        text_spring(v);
}

/* ---- The command ---- */

/* Two ids with a colon between. */
static bool ends_from(const char *text, uint64_t end[2])
{
    char first[24];
    const size_t length = strcspn(text, ":");
    if (length >= sizeof first || text[length] != ':')
        return false;
    memcpy(first, text, length);
    first[length] = 0;
    return cli_number_from(first, &end[0]) && cli_number_from(text + length + 1, &end[1]) && end[0] != end[1];
}

static int ask(view *v, const cli_list *particle, const cli_list *spring)
{
    if (particle->count > 1 || spring->count > 1)
        return cli_usage(&cli_inspect, "one %s at a time; got %zu", particle->count > 1 ? "--particle" : "--spring",
                         particle->count > 1 ? particle->count : spring->count);
    v->has_particle = particle->count == 1;
    v->has_spring = spring->count == 1;
    if (v->has_particle && !cli_number_from(particle->item[0], &v->particle))
        return cli_usage(&cli_inspect, "--particle needs a whole number, 0 or more; got \"%s\"", particle->item[0]);
    if (v->has_spring && !ends_from(spring->item[0], v->end))
        return cli_usage(&cli_inspect, "--spring needs two different ids, as 3:12; got \"%s\"", spring->item[0]);
    return CLI_GO_ON;
}

static int inspect(view *v, bool json)
{
    rheo_player *player = NULL;
    rheo_error error = {""};
    const rheo_result result = rheo_player_open(v->recording, NULL, &player, &error);
    if (result != RHEO_OK)
        return cli_error(result, &error);
    int status = go_there(v, player);
    if (status == CLI_DONE)
        status = gather(v);
    if (status == CLI_DONE && v->failed)
        cli_warn("%s: %s", v->file, v->why);
    if (status == CLI_DONE && json)
        print_json(v);
    else if (status == CLI_DONE)
        print_text(v);
    release(v);
    rheo_player_close(player);
    return status;
}

static int run(int argc, char **argv)
{
    bool json = false;
    cli_number step = {false, 0}, top = {false, DEFAULT_TOP};
    cli_list particle = {0}, spring = {0};
    view v = {0};
    const cli_option options[] = {
        {"--step", NULL, "N", CLI_NUMBER, &step},
        {"--stage", NULL, "NAME", CLI_TEXT, &v.stage},
        {"--particle", NULL, "ID", CLI_LIST, &particle},
        {"--spring", NULL, "A:B", CLI_LIST, &spring},
        {"--top", NULL, "N", CLI_NUMBER, &top},
        {"--json", NULL, NULL, CLI_FLAG, &json},
        {0},
    };
    int status = cli_parse(&cli_inspect, options, &argc, argv);
    if (status != CLI_GO_ON)
        return status;
    if (argc != 1)
        return cli_usage(&cli_inspect, "needs one recording; got %d", argc);
    if ((status = ask(&v, &particle, &spring)) != CLI_GO_ON)
        return status;
    if ((status = cli_open_recording(argv[0], &v.recording)) != CLI_DONE)
        return status;
    v.file = argv[0];
    v.info = rheo_recording_get_info(v.recording);
    v.step = step.given ? step.value : v.info.last_step;
    v.has_lists = top.given || (!v.has_particle && !v.has_spring);
    v.top = top.value < SIZE_MAX ? (size_t)top.value : SIZE_MAX;
    v.failed = rheo_recording_failure(v.recording, &v.failure);
    if (v.failed)
        rheo_failure_message(&v.failure, v.why, sizeof v.why);
    status = inspect(&v, json);
    rheo_recording_close(v.recording);
    return status;
}

static const char help[] = {
#include "cli/help/inspect.txt.inc"
    0};

const cli_command cli_inspect = {"inspect", help, run};
