/* Prints the values of `rheolog inspect` as one JSON object. */
#include "cli/inspect.h"

static void json_bodies(cli_json *json, const cli_view *v)
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

static void json_metrics(cli_json *json, const cli_view *v)
{
    cli_json_begin_object(json, "metrics");
    for (uint32_t i = 0; i < rheo_recording_metric_count(v->recording); i++)
        cli_json_number(json, rheo_recording_metric_name(v->recording, i), v->metric[i]);
    cli_json_end_object(json);
}

static void json_rankings(cli_json *json, const cli_view *v)
{
    for (uint32_t i = 0; i < v->rankings; i++) {
        const cli_ranking *r = &v->ranking[i];
        cli_json_begin_list(json, r->ranking->name);
        for (size_t n = 0; n < r->count; n++) {
            cli_json_begin_object(json, NULL);
            cli_json_integer(json, "id", r->entry[n].id);
            if (r->ranking->top == RHEO_TOP_STIFFEST)
                cli_json_integer(json, "other_id", r->entry[n].other_id);
            cli_json_number(json, r->ranking->value, r->entry[n].value);
            cli_json_end_object(json);
        }
        cli_json_end_list(json);
    }
}

static void json_history(cli_json *json, const cli_view *v, const cli_lag *row, const char *key)
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

static void json_modes(cli_json *json, const cli_view *v, const rheo_mode_state *mode)
{
    cli_json_begin_list(json, "modes");
    for (uint32_t k = 0; k < v->modes; k++) {
        cli_json_begin_object(json, NULL);
        cli_json_number(json, "decay", mode[k].decay);
        cli_json_number(json, "weight", mode[k].weight);
        cli_json_vector(json, "sum", mode[k].sum, 3);
        cli_json_end_object(json);
    }
    cli_json_end_list(json);
}

static void json_spring_values(cli_json *json, const double value[CLI_SPRING_VALUES])
{
    for (int i = 0; i < CLI_SPRING_VALUES; i++)
        cli_json_number(json, CLI_SPRING_QUANTITIES[i].name, value[i]);
}

static void json_springs(cli_json *json, const cli_view *v)
{
    cli_json_begin_list(json, "springs");
    for (size_t i = 0; i < v->springs; i++) {
        cli_json_begin_object(json, NULL);
        cli_json_integer(json, "partner", v->spring_of_particle[i].partner);
        json_spring_values(json, v->spring_of_particle[i].value);
        cli_json_end_object(json);
    }
    cli_json_end_list(json);
}

static void json_quantities(cli_json *json, const cli_view *v)
{
    const rheo_quantity *q;
    for (uint32_t i = 0; (q = rheo_world_quantity(v->world, i)) != NULL; i++)
        if (q->components == 1)
            cli_json_number(json, q->name, *cli_quantity_value(v, q));
        else
            cli_json_vector(json, q->name, cli_quantity_value(v, q), q->components);
}

static void json_particle(cli_json *json, const cli_view *v)
{
    cli_json_begin_object(json, "particle");
    cli_json_integer(json, "id", v->particle);
    json_quantities(json, v);
    cli_json_begin_list(json, "neighbours");
    for (size_t i = 0; i < v->neighbours; i++) {
        cli_json_begin_object(json, NULL);
        cli_json_integer(json, "id", v->neighbour[i]);
        cli_json_number(json, "distance", v->distance[i]);
        cli_json_number(json, "weight", rheo_world_weight(v->world, v->distance[i]));
        cli_json_end_object(json);
    }
    cli_json_end_list(json);
    if (v->model_has_springs) {
        json_springs(json, v);
        json_history(json, v, v->velocity, "velocity");
        json_modes(json, v, v->particle_mode);
    }
    cli_json_end_object(json);
}

static void json_spring(cli_json *json, const cli_view *v)
{
    cli_json_begin_object(json, "spring");
    cli_json_integer(json, "a", v->ends[0]);
    cli_json_integer(json, "b", v->ends[1]);
    json_spring_values(json, v->spring);
    json_history(json, v, v->difference, "difference");
    json_modes(json, v, v->spring_mode);
    cli_json_end_object(json);
}

void cli_inspect_json(const cli_view *v)
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
    cli_failure_json(&json, v->failed, &v->failure, "item", v->why);
    json_bodies(&json, v);
    json_metrics(&json, v);
    if (v->has_rankings)
        json_rankings(&json, v);
    if (v->has_particle)
        json_particle(&json, v);
    if (v->has_spring)
        json_spring(&json, v);
    cli_json_end_object(&json);
}
