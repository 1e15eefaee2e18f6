/* Prints the values of `rheolog inspect` as one JSON object. */
#include "cli/inspect.h"

static void json_bodies(rheo__json *json, const cli_view *v)
{
    rheo_body body;
    rheo__json_begin_list(json, "bodies");
    for (uint32_t i = 0; rheo_world_body(v->world, i, &body) == RHEO_OK; i++) {
        rheo__json_begin_object(json, NULL);
        rheo__json_integer(json, "id", i);
        rheo__json_vector(json, "position", body.position, 3);
        rheo__json_vector(json, "velocity", body.velocity, 3);
        rheo__json_vector(json, "spin", body.spin, 3);
        rheo__json_number(json, "radius", body.radius);
        rheo__json_number(json, "mass", body.mass);
        rheo__json_end_object(json);
    }
    rheo__json_end_list(json);
}

static void json_emitters(rheo__json *json, const cli_view *v)
{
    rheo_emitter_state e;
    if (!rheo_world_definition(v->world)->emitters.count)
        return;
    rheo__json_begin_list(json, "emitters");
    for (uint32_t k = 0; rheo_world_emitter(v->world, k, &e); k++) {
        rheo__json_begin_object(json, NULL);
        rheo__json_text(json, "name", rheo_world_definition(v->world)->emitters.list[k].name);
        rheo__json_integer(json, "emitted", e.emitted);
        rheo__json_integer(json, "blocked", e.blocked);
        rheo__json_integer(json, "sites", e.sites);
        rheo__json_number(json, "way", e.way);
        rheo__json_end_object(json);
    }
    rheo__json_end_list(json);
}

static void json_plates(rheo__json *json, const cli_view *v)
{
    rheo_plate plate;
    rheo__json_begin_list(json, "plates");
    for (uint32_t i = 0; rheo_world_plate(v->world, i, &plate); i++) {
        rheo__json_begin_object(json, NULL);
        rheo__json_text(json, "name", cli_plate_name[i]);
        rheo__json_integer(json, "particles", plate.particles);
        rheo__json_vector(json, "displacement", plate.displacement, 3);
        rheo__json_vector(json, "velocity", plate.velocity, 3);
        rheo__json_vector(json, "force", plate.force, 3);
        rheo__json_end_object(json);
    }
    rheo__json_end_list(json);
}

static void json_metrics(rheo__json *json, const cli_view *v)
{
    rheo__json_begin_object(json, "metrics");
    for (uint32_t i = 0; i < rheo_recording_metric_count(v->recording); i++)
        rheo__json_number(json, rheo_recording_metric_name(v->recording, i), v->metric[i]);
    rheo__json_end_object(json);
}

static void json_rankings(rheo__json *json, const cli_view *v)
{
    for (uint32_t i = 0; i < v->rankings; i++) {
        const cli_ranking *r = &v->ranking[i];
        rheo__json_begin_list(json, r->ranking->name);
        for (size_t n = 0; n < r->count; n++) {
            rheo__json_begin_object(json, NULL);
            rheo__json_integer(json, "id", r->entry[n].id);
            if (r->ranking->top == RHEO_TOP_STIFFEST)
                rheo__json_integer(json, "other_id", r->entry[n].other_id);
            rheo__json_number(json, r->ranking->value, r->entry[n].value);
            rheo__json_end_object(json);
        }
        rheo__json_end_list(json);
    }
}

static void json_history(rheo__json *json, const cli_view *v, const cli_lag *row, const char *key)
{
    rheo__json_begin_list(json, "history");
    for (uint32_t m = 0; m < v->rows; m++) {
        rheo__json_begin_object(json, NULL);
        rheo__json_integer(json, "lag", m);
        rheo__json_integer(json, "step", row[m].step);
        rheo__json_number(json, "time", row[m].time);
        rheo__json_number(json, "weight", row[m].weight);
        rheo__json_vector(json, key, row[m].value, 3);
        rheo__json_end_object(json);
    }
    rheo__json_end_list(json);
}

static void json_modes(rheo__json *json, const cli_view *v, const rheo_mode_state *mode)
{
    rheo__json_begin_list(json, "modes");
    for (uint32_t k = 0; k < v->modes; k++) {
        rheo__json_begin_object(json, NULL);
        rheo__json_number(json, "decay", mode[k].decay);
        rheo__json_number(json, "weight", mode[k].weight);
        rheo__json_vector(json, "sum", mode[k].sum, 3);
        rheo__json_end_object(json);
    }
    rheo__json_end_list(json);
}

static void json_spring_values(rheo__json *json, const double value[CLI_SPRING_VALUES])
{
    for (int i = 0; i < CLI_SPRING_VALUES; i++)
        rheo__json_number(json, CLI_SPRING_QUANTITIES[i].name, value[i]);
}

static void json_springs(rheo__json *json, const cli_view *v)
{
    rheo__json_begin_list(json, "springs");
    for (size_t i = 0; i < v->springs; i++) {
        rheo__json_begin_object(json, NULL);
        rheo__json_integer(json, "partner", v->spring_of_particle[i].partner);
        json_spring_values(json, v->spring_of_particle[i].value);
        rheo__json_end_object(json);
    }
    rheo__json_end_list(json);
}

static void json_quantities(rheo__json *json, const cli_view *v)
{
    const rheo_quantity *q;
    for (uint32_t i = 0; (q = rheo_world_quantity(v->world, i)) != NULL; i++)
        if (q->components == 1)
            rheo__json_number(json, q->name, *cli_quantity_value(v, q));
        else
            rheo__json_vector(json, q->name, cli_quantity_value(v, q), q->components);
}

static void json_particle(rheo__json *json, const cli_view *v)
{
    rheo__json_begin_object(json, "particle");
    const rheo_world_def *def = rheo_world_definition(v->world);
    rheo__json_integer(json, "id", v->particle);
    if (def->materials.count) {
        rheo__json_integer(json, "material", v->state.material);
        rheo__json_text(json, "material_name", rheo_world_def_material_name(def, v->state.material));
    }
    json_quantities(json, v);
    rheo__json_begin_list(json, "neighbours");
    for (size_t i = 0; i < v->neighbours; i++) {
        rheo__json_begin_object(json, NULL);
        rheo__json_integer(json, "id", v->neighbour[i]);
        rheo__json_number(json, "distance", v->distance[i]);
        rheo__json_number(json, "weight", rheo_world_weight(v->world, v->distance[i]));
        rheo__json_end_object(json);
    }
    rheo__json_end_list(json);
    if (v->model_has_springs) {
        json_springs(json, v);
        json_history(json, v, v->velocity, "velocity");
        json_modes(json, v, v->particle_mode);
    }
    rheo__json_end_object(json);
}

static void json_spring(rheo__json *json, const cli_view *v)
{
    rheo__json_begin_object(json, "spring");
    rheo__json_integer(json, "a", v->ends[0]);
    rheo__json_integer(json, "b", v->ends[1]);
    json_spring_values(json, v->spring);
    json_history(json, v, v->difference, "difference");
    json_modes(json, v, v->spring_mode);
    rheo__json_end_object(json);
}

void cli_inspect_json(const cli_view *v)
{
    rheo__json json = {.file = stdout};
    rheo__json_begin_object(&json, NULL);
    rheo__json_text(&json, "file", v->file);
    rheo__json_text(&json, "scene", v->info.scene);
    rheo__json_text(&json, "model", rheo_model_name(rheo_world_definition(v->world)->model));
    rheo__json_integer(&json, "step", v->step);
    rheo__json_text(&json, "stage", v->done);
    rheo__json_number(&json, "time", rheo_world_time(v->world));
    rheo__json_hash(&json, "hash", rheo_world_hash(v->world));
    rheo__json_integer(&json, "particles", rheo_world_particle_count(v->world));
    rheo__json_integer(&json, "springs", rheo_world_spring_count(v->world));
    cli_failure_json(&json, v->failed, &v->failure, "item", v->why);
    json_bodies(&json, v);
    json_plates(&json, v);
    json_emitters(&json, v);
    json_metrics(&json, v);
    if (v->has_rankings)
        json_rankings(&json, v);
    if (v->has_particle)
        json_particle(&json, v);
    if (v->has_spring)
        json_spring(&json, v);
    rheo__json_end_object(&json);
}
