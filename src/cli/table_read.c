/*
 * Reads a row of `rheolog table`. The settings are those of the scene that the recording stores, with the commands before its
 * first step, since a run that starts from a recording has --set as commands. A recording without a scene, or a program
 * that cannot read JSON, has those of its definition. Metrics are read and not simulated.
 */
#define _POSIX_C_SOURCE 200809L /* strdup() */
#include "cli/table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "rheolog/scene_json.h"

enum { VALUE = 96 };

static bool refused;

bool cli_refused_condition(void)
{
    return refused;
}

static int no_memory(void)
{
    return cli_fail(CLI_SYSTEM, "no memory for the table");
}

/* ---- Columns ---- */

size_t cli_columns_find(const cli_columns *c, const char *name)
{
    size_t i = 0;
    while (i < c->count && strcmp(c->column[i].name, name) != 0)
        i++;
    return i;
}

size_t cli_columns_add(cli_columns *c, size_t hint, const char *name)
{
    const size_t i = hint < c->count && strcmp(c->column[hint].name, name) == 0 ? hint : cli_columns_find(c, name);
    if (i < c->count)
        return i;
    if (c->count == c->capacity) {
        const size_t capacity = c->capacity ? 2 * c->capacity : 64;
        cli_column *column = realloc(c->column, capacity * sizeof *column);
        if (!column)
            return SIZE_MAX;
        c->column = column;
        c->capacity = capacity;
    }
    c->column[i] = (cli_column){.name = strdup(name)};
    if (!c->column[i].name)
        return SIZE_MAX;
    c->count++;
    return i;
}

void cli_columns_release(cli_columns *c)
{
    for (size_t i = 0; i < c->count; i++)
        free(c->column[i].name);
    free(c->column);
}

/* ---- Settings ---- */

static int add_setting(cli_sweep *s, cli_row *row, size_t *hint, const char *name, const rheo_parameter *parameter,
                       const char *value, const char *usual)
{
    const size_t i = cli_columns_add(&s->settings, *hint, name);
    if (i == SIZE_MAX)
        return no_memory();
    if (i >= row->settings) {
        const size_t count = s->settings.count;
        char **setting = realloc(row->setting, count * sizeof *setting);
        if (!setting)
            return no_memory();
        memset(setting + row->settings, 0, (count - row->settings) * sizeof *setting);
        row->setting = setting;
        row->settings = count;
    }
    cli_column *c = &s->settings.column[i];
    if (!(row->setting[i] = strdup(value)))
        return no_memory();
    c->parameter = parameter;
    c->changed |= strcmp(value, usual) != 0;
    c->differs |= c->first && strcmp(value, c->first) != 0;
    if (!c->first)
        c->first = row->setting[i];
    *hint = i + 1;
    return CLI_DONE;
}

static int add_parameter(cli_sweep *s, cli_row *row, size_t *hint, const rheo_parameter *p, const rheo_scene *scene,
                         const rheo_scene *usual)
{
    char value[VALUE] = "", of_default[VALUE] = "";
    if (!(p->models >> scene->world.model & 1))
        return CLI_DONE;
    rheo_scene_get(scene, p->path, value, VALUE);
    rheo_scene_get(usual, p->path, of_default, VALUE);
    return add_setting(s, row, hint, p->path, p, value, of_default);
}

/* `has_scene`: `scene` was stored; else only its world has values. */
static int add_settings(cli_sweep *s, cli_row *row, const char *name, const rheo_scene *scene, bool has_scene)
{
    const rheo_parameter *p;
    size_t hint = 0;
    rheo_scene usual = rheo_default_scene();
    usual.world = rheo_default_model_def(scene->world.model);
    for (usual.world.materials.count = 0; usual.world.materials.count < scene->world.materials.count;)
        usual.world.materials.list[usual.world.materials.count++] = rheo_default_material("");
    while (usual.world.balls.count < scene->world.balls.count)
        usual.world.balls.list[usual.world.balls.count++] = rheo_default_ball();
    for (usual.world.emitters.count = 0; usual.world.emitters.count < scene->world.emitters.count;)
        usual.world.emitters.list[usual.world.emitters.count++] = rheo_default_emitter("");
    int status = add_setting(s, row, &hint, "scene", NULL, name, "");
    for (size_t i = 0; status == CLI_DONE && (p = rheo_world_def_parameter_at(&scene->world, i)) != NULL; i++)
        status = add_parameter(s, row, &hint, p, scene, &usual);
    for (size_t i = 0; has_scene && status == CLI_DONE && (p = rheo_scene_parameter_at(i)) != NULL; i++)
        if (p->scene_only && strcmp(p->path, "steps") != 0) /* those of the row are what was run */
            status = add_parameter(s, row, &hint, p, scene, &usual);
    for (unsigned ball = 2; has_scene && status == CLI_DONE && ball <= scene->world.balls.count + 1; ball++) {
        char path[32];
        snprintf(path, sizeof path, "ball%u.clearance", ball);
        status = add_parameter(s, row, &hint, rheo_scene_parameter_find(path), scene, &usual);
    }
    return status;
}

static int read_settings(cli_sweep *s, cli_row *row, rheo_recording *recording)
{
    const rheo_recording_info info = rheo_recording_get_info(recording);
    rheo_scene scene = rheo_default_scene();
    const bool has_scene = info.scene_text[0] && rheo_scene_from_json(info.scene_text, strlen(info.scene_text),
                                                                      row->file, &scene, NULL) == RHEO_OK;
    if (!has_scene)
        scene.world = *rheo_recording_definition(recording);
    rheo_command c;
    for (uint64_t i = 0; rheo_recording_command(recording, i, &c, NULL) == RHEO_OK && c.step <= info.first_step + 1;
         i++)
        if (c.kind == RHEO_COMMAND_SET)
            rheo_world_def_set(&scene.world, c.path, c.value, NULL);
    const int status = add_settings(s, row, info.scene, &scene, has_scene);
    if (has_scene)
        rheo_scene_release(&scene);
    return status;
}

/* ---- Events ---- */

typedef struct reading {
    cli_row *row;
    rheo_recording *recording;
    rheo_recording_info info;
    double *values; /* metrics of a step */
} reading;

static int read_metrics(const reading *r, uint64_t step)
{
    rheo_error error = {""};
    const rheo_result result = rheo_recording_metrics(r->recording, step, r->values, &error);
    return result == RHEO_OK ? CLI_DONE : cli_file_error(r->row->file, result, &error);
}

static int time_of(const reading *r, uint32_t metric, uint64_t step, double *time)
{
    const int status = read_metrics(r, step);
    *time = status == CLI_DONE ? r->values[metric] : NAN;
    return status;
}

/* Finds the step whose time is nearest, the earlier one of two. Times rise, and ends are half a step wide. */
static int find_time(const reading *r, double time, cli_happening *at)
{
    const uint32_t metric = rheo_recording_metric_by_name(r->recording, "time");
    const double half = rheo_recording_definition(r->recording)->step / 2;
    uint64_t low = r->info.first_step, high = r->info.last_step;
    double of_low, of_high;
    if (metric == rheo_recording_metric_count(r->recording))
        return CLI_DONE;
    int status = time_of(r, metric, low, &of_low);
    if (status == CLI_DONE)
        status = time_of(r, metric, high, &of_high);
    if (status != CLI_DONE || !(time >= of_low - half && time <= of_high + half))
        return status;
    while (high - low > 1) {
        const uint64_t middle = low + (high - low) / 2;
        double of_middle;
        if ((status = time_of(r, metric, middle, &of_middle)) != CLI_DONE)
            return status;
        *(of_middle < time ? &low : &high) = middle;
        *(of_middle < time ? &of_low : &of_high) = of_middle;
    }
    at->happened = true;
    at->step = time - of_low <= of_high - time ? low : high;
    return CLI_DONE;
}

/* Looks for the first step at which a condition holds. Steps are simulated only where metrics leave it open. */
static int find_condition(const reading *r, const char *condition, cli_happening *at)
{
    rheo_error error = {""};
    rheo_search search = {0};
    const rheo_find_options options = rheo_default_find_options();
    cli_watch_name(r->row->file);
    const rheo_result result = rheo_recording_find(r->recording, condition, &options, &search, &error);
    cli_watch_name(NULL);
    refused = result == RHEO_ERROR_ARGUMENT;
    at->happened = result == RHEO_OK && search.hits > 0;
    at->step = search.found.step;
    return result == RHEO_OK ? CLI_DONE : cli_file_error(r->row->file, result, &error);
}

static int find_event(const reading *r, const cli_event *event, cli_happening *at)
{
    switch (event->kind) {
    case CLI_AT_END:
        *at = (cli_happening){.happened = true, .step = r->info.last_step};
        return CLI_DONE;
    case CLI_AT_STEP:
        at->happened = event->step >= r->info.first_step && event->step <= r->info.last_step;
        at->step = event->step;
        return CLI_DONE;
    case CLI_AT_TIME:
        return find_time(r, event->time, at);
    case CLI_AT_CONDITION:
        return find_condition(r, event->text, at);
    }
    return CLI_DONE;
}

/* Finds an event and takes the metrics of its step. */
static int read_event(cli_sweep *s, const reading *r, const cli_event *event, const size_t *column, cli_happening *at)
{
    int status = find_event(r, event, at);
    if (status == CLI_DONE && at->happened)
        status = read_metrics(r, at->step);
    if (status != CLI_DONE || !at->happened) {
        at->happened = false;
        return status;
    }
    at->cell = calloc(s->metrics.count + 1, sizeof *at->cell);
    if (!at->cell)
        return no_memory();
    for (uint32_t m = 0; m < rheo_recording_metric_count(r->recording); m++)
        at->cell[column[m]] = (cli_cell){true, r->values[m]};
    return CLI_DONE;
}

static int read_events(cli_sweep *s, cli_row *row, rheo_recording *recording)
{
    const uint32_t count = rheo_recording_metric_count(recording);
    const reading r = {row, recording, rheo_recording_get_info(recording), malloc((count + 1) * sizeof *r.values)};
    size_t *column = malloc((count + 1) * sizeof *column);
    int worst = r.values && column ? CLI_DONE : no_memory();
    for (uint32_t m = 0; m < count && worst == CLI_DONE; m++)
        if ((column[m] = cli_columns_add(&s->metrics, m, rheo_recording_metric_name(recording, m))) == SIZE_MAX)
            worst = no_memory();
    row->metrics = s->metrics.count;
    for (size_t e = 0; e < s->events && worst < CLI_SYSTEM && !refused; e++) {
        const int status = read_event(s, &r, &s->event[e], column, &row->at[e]);
        worst = status > worst ? status : worst;
    }
    free(r.values);
    free(column);
    return worst;
}

int cli_read_row(cli_sweep *s, cli_row *row)
{
    rheo_recording *recording = NULL;
    int worst = cli_open_recording(row->file, &recording);
    if (worst != CLI_DONE) {
        row->outcome = "unreadable";
        row->reason = strdup(cli_said());
        return worst;
    }
    const rheo_recording_info info = rheo_recording_get_info(recording);
    row->outcome = cli_ending(recording);
    row->steps = info.last_step - info.first_step;
    worst = read_settings(s, row, recording);
    if (worst == CLI_DONE)
        worst = read_events(s, row, recording);
    rheo_recording_close(recording);
    return worst == CLI_DONE && !info.complete ? CLI_BAD : worst;
}
