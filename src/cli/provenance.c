/* The origin of a recording: parameters that differ from their defaults, blessings; and the commands of a step. */
#include "cli/provenance.h"

#include "json/json_parameter.h"

enum { VALUE = CLI_PARAMETER_VALUE };

const rheo_parameter *cli_next_differing(const rheo_world_def *def, size_t *index, char value[VALUE],
                                         char usual[VALUE])
{
    rheo_world_def defaults = rheo_default_model_def(def->model);
    const rheo_parameter *p = NULL;
    for (defaults.materials.count = 0; defaults.materials.count < def->materials.count; defaults.materials.count++)
        defaults.materials.list[defaults.materials.count] = rheo_default_material("");
    for (uint32_t k = 0; k < def->obstacles.count; k++)
        defaults.obstacles.list[defaults.obstacles.count++] = rheo_default_obstacle(def->obstacles.list[k].shape);
    while (defaults.balls.count < def->balls.count)
        defaults.balls.list[defaults.balls.count++] = rheo_default_ball();
    for (defaults.emitters.count = 0; defaults.emitters.count < def->emitters.count; defaults.emitters.count++)
        defaults.emitters.list[defaults.emitters.count] = rheo_default_emitter("");
    do
        p = rheo_world_def_differing(def, &defaults, index, value, usual);
    while (p && !(p->models >> def->model & 1));
    return p;
}

void cli_differing_parameters_json(rheo__json *json, const char *key, const rheo_world_def *def,
                                   const rheo_world_def *values)
{
    char value[VALUE], usual[VALUE];
    const rheo_parameter *p = NULL;
    rheo__json_begin_object(json, key);
    for (size_t i = 0; (p = cli_next_differing(def, &i, value, usual)) != NULL;) {
        const bool given = rheo_world_def_get(values, p->path, value, VALUE) == RHEO_OK;
        rheo__json_parameter(json, p->path, p, given ? value : usual);
    }
    rheo__json_end_object(json);
}

void cli_differing_parameters_text(const rheo_world_def *def)
{
    char value[VALUE], usual[VALUE];
    const rheo_parameter *p = NULL;
    const char *head = "differs";
    for (size_t i = 0; (p = cli_next_differing(def, &i, value, usual)) != NULL; head = "")
        cli_print(stdout, 12, "%-11s %s = %s (default: %s)\n", head, p->path, value, *usual ? usual : "none");
}

void cli_emitters_text(const rheo_world_def *def)
{
    for (uint32_t k = 0; k < def->emitters.count; k++) {
        const rheo_emitter *e = &def->emitters.list[k];
        const unsigned long long sites = rheo_world_def_emitter_sites(def, k), limit = e->limit;
        char speed[32];
        cli_print(stdout, 12, "%-11s %s emits layers of %llu particle%s with %s L/T, at most %llu particle%s%s\n",
                  k ? "" : "emitters", e->name, sites, cli_plural(sites), rheo_number_brief(e->speed, 4, speed),
                  limit, cli_plural(limit), e->flow == RHEO_EMITTER_OFF ? "; it begins switched off" : "");
    }
}

const char *cli_made_text(const rheo_recording_info *info)
{
    return info->made_refused ? "not shown: it is too long, not UTF-8 or has control characters"
           : info->made_by[0] ? info->made_by
                              : "not stored in this recording";
}

const char *cli_ending_text(const rheo_recording *recording, char *text, size_t size)
{
    const rheo_recording_info info = rheo_recording_get_info(recording);
    rheo_failure failure;
    if (rheo_recording_failure(recording, &failure))
        rheo_failure_message(&failure, text, size);
    else if (info.complete)
        snprintf(text, size, "complete, after step %llu", (unsigned long long)info.last_step);
    else
        cli_completeness(recording, text, size);
    return cli_ending(recording);
}

void cli_blessings_json(rheo__json *json, const rheo_recording *recording)
{
    rheo_blessing blessing;
    rheo__json_bool(json, "blessed", rheo_recording_get_info(recording).blessed);
    rheo__json_begin_list(json, "blessings");
    for (uint32_t i = 0; rheo_recording_blessing(recording, i, &blessing) == RHEO_OK; i++) {
        rheo__json_begin_object(json, NULL);
        rheo__json_text(json, "because", blessing.because);
        rheo__json_text(json, "build", blessing.build);
        const bool known = blessing.verdict != RHEO_SAMENESS_UNKNOWN;
        rheo__json_text(json, "verdict", known ? rheo_sameness_name(blessing.verdict) : NULL);
        rheo__json_text(json, "at_least", known ? rheo_sameness_name(blessing.at_least) : NULL);
        rheo__json_text(json, "same", known ? blessing.same : NULL);
        rheo__json_end_object(json);
    }
    rheo__json_end_list(json);
}

void cli_blessings_text(const rheo_recording *recording)
{
    rheo_blessing blessing;
    for (uint32_t i = 0; rheo_recording_blessing(recording, i, &blessing) == RHEO_OK; i++) {
        cli_print(stdout, 12, "blessed     %s\n            by %s\n", blessing.because, blessing.build);
        if (blessing.verdict != RHEO_SAMENESS_UNKNOWN)
            cli_print(stdout, 12, "            %s (down to %s tried)\n", blessing.same,
                      rheo_sameness_name(blessing.at_least));
    }
    if (rheo_recording_get_info(recording).blessed && rheo_recording_blessing_count(recording) == 0)
        puts("blessed     with reasons that are lost: the recording is truncated");
}

/* Finds the next command before a step, from *index on. */
static bool next_command(rheo_recording *recording, uint64_t step, uint64_t *index, rheo_command *command)
{
    const uint64_t count = rheo_recording_command_count(recording);
    while (*index < count && rheo_recording_command(recording, (*index)++, command, NULL) == RHEO_OK &&
           command->step <= step)
        if (command->step == step)
            return true;
    return false;
}

void cli_commands_text(const char *path, uint64_t step, const char *which)
{
    rheo_recording *recording;
    rheo_command command;
    if (rheo_recording_open(path, &recording, NULL) != RHEO_OK)
        return;
    uint64_t index = 0;
    bool any = false;
    for (; next_command(recording, step, &index, &command); any = true)
        printf("    in the %s, %s\n", which, command.text);
    if (!any)
        printf("    in the %s, none was given\n", which);
    rheo_recording_close(recording);
}

void cli_commands_json(rheo__json *json, const char *key, const char *path, uint64_t step)
{
    rheo_recording *recording;
    rheo_command command;
    rheo__json_begin_list(json, key);
    if (rheo_recording_open(path, &recording, NULL) == RHEO_OK) {
        for (uint64_t index = 0; next_command(recording, step, &index, &command);)
            rheo__json_text(json, NULL, command.text);
        rheo_recording_close(recording);
    }
    rheo__json_end_list(json);
}
