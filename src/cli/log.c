/* rheolog log: lists how a recording was made and every command that the run was given. Nothing is simulated. */
#include "cli/cli.h"

#include <string.h>

#include "cli/provenance.h"
#include "json/json_parameter.h"

static const char *const KIND[] = {"", "set", "push_body", "add_particles", "move_vibrator"};

/* ---- JSON ---- */

static void write_made(const char *file, const rheo_recording *recording)
{
    const rheo_recording_info info = rheo_recording_get_info(recording);
    const rheo_world_def *def = rheo_recording_definition(recording);
    const rheo_world_def usual = rheo_default_model_def(def->model);
    rheo__json json = {.file = stdout};
    rheo__json_begin_object(&json, NULL);
    rheo__json_text(&json, "file", file);
    rheo__json_text(&json, "event", "made");
    rheo__json_text(&json, "scene", info.scene);
    rheo__json_text(&json, "model", rheo_model_name(def->model));
    rheo__json_integer(&json, "particles", info.particles);
    rheo__json_text(&json, "made_by", info.made_by[0] ? info.made_by : NULL);
    rheo__json_text(&json, "build", info.build);
    rheo__json_integer(&json, "format", info.format);
    rheo__json_integer(&json, "real_bytes", info.real_bytes);
    rheo__json_integer(&json, "first_step", info.first_step);
    cli_differing_parameters_json(&json, "parameters", def, def);
    cli_differing_parameters_json(&json, "defaults", def, &usual);
    rheo__json_integer(&json, "walls", def->walls.count);
    rheo__json_integer(&json, "vibrators", def->vibrators.count);
    rheo__json_integer(&json, "obstacles", def->obstacles.count);
    cli_blessings_json(&json, recording);
    rheo__json_integer(&json, "commands", rheo_recording_command_count(recording));
    rheo__json_bool(&json, "made_refused", info.made_refused);
    rheo__json_end_object(&json);
}

static void write_command(const char *file, const rheo_command *c, const rheo_world_def *def, const char *before)
{
    const rheo_parameter *parameter =
        c->kind == RHEO_COMMAND_SET ? rheo_world_def_parameter_find(def, c->path) : NULL;
    rheo__json json = {.file = stdout};
    rheo__json_begin_object(&json, NULL);
    rheo__json_text(&json, "file", file);
    rheo__json_text(&json, "event", "command");
    rheo__json_integer(&json, "step", c->step);
    rheo__json_text(&json, "kind", KIND[c->kind]);
    switch (c->kind) {
    case RHEO_COMMAND_SET:
        rheo__json_text(&json, "path", c->path);
        if (parameter) {
            rheo__json_parameter(&json, "value", parameter, c->value);
            rheo__json_parameter(&json, "before", parameter, before);
        }
        break;
    case RHEO_COMMAND_PUSH_BODY:
        rheo__json_integer(&json, "body", c->index);
        rheo__json_vector(&json, "impulse", c->vector, 3);
        if (c->has_point)
            rheo__json_vector(&json, "point", c->point, 3);
        else
            rheo__json_null(&json, "point");
        break;
    case RHEO_COMMAND_ADD_PARTICLES:
        rheo__json_integer(&json, "count", c->count);
        rheo__json_vector(&json, "min", c->min, 3);
        rheo__json_vector(&json, "max", c->max, 3);
        rheo__json_integer(&json, "material", c->index);
        break;
    case RHEO_COMMAND_MOVE_VIBRATOR:
        rheo__json_integer(&json, "vibrator", c->index);
        rheo__json_number(&json, "x", c->vector[0]);
        rheo__json_number(&json, "z", c->vector[1]);
        break;
    }
    rheo__json_text(&json, "text", c->text);
    rheo__json_end_object(&json);
}

static void write_end(const char *file, const rheo_recording *recording)
{
    char text[512];
    const char *ending = cli_ending_text(recording, text, sizeof text);
    rheo__json json = {.file = stdout};
    rheo__json_begin_object(&json, NULL);
    rheo__json_text(&json, "file", file);
    rheo__json_text(&json, "event", "end");
    rheo__json_text(&json, "ending", ending);
    rheo__json_integer(&json, "last_step", rheo_recording_get_info(recording).last_step);
    rheo__json_text(&json, "text", text);
    rheo__json_end_object(&json);
}

/* ---- Text ---- */

static void print_made(const char *file, const rheo_recording *recording)
{
    const rheo_recording_info info = rheo_recording_get_info(recording);
    const rheo_world_def *def = rheo_recording_definition(recording);
    printf("%s\n", file);
    printf("scene       %s (%s), %llu particle%s\n", info.scene[0] ? info.scene : "without a name",
           rheo_model_name(def->model), (unsigned long long)info.particles, cli_plural(info.particles));
    cli_print(stdout, 12, "made by     %s\n", cli_made_text(&info));
    cli_print(stdout, 12, "build       %s\n", info.build);
    printf("format      %u, reals of %u bytes\n", (unsigned)info.format, (unsigned)info.real_bytes);
    if (def->walls.count || def->vibrators.count)
        printf("geometry    %u wall%s, %u vibrator%s\n", (unsigned)def->walls.count, cli_plural(def->walls.count),
               (unsigned)def->vibrators.count, cli_plural(def->vibrators.count));
    if (def->obstacles.count)
        printf("obstacles   %u\n", (unsigned)def->obstacles.count);
    if (def->history.curve_count)
        printf("curve       %u points from %g to %g T\n", (unsigned)def->history.curve_count,
               def->history.curve[0].age, def->history.curve[def->history.curve_count - 1].age);
    cli_emitters_text(def);
    cli_differing_parameters_text(def);
    cli_blessings_text(recording);
    printf("begins      with step %llu\n", (unsigned long long)info.first_step);
}

static void print_command(const rheo_command *c, const char *before)
{
    char step[32];
    snprintf(step, sizeof step, "step %llu", (unsigned long long)c->step);
    printf("%-11s %s", step, c->text);
    if (c->kind == RHEO_COMMAND_SET && before[0])
        printf("; before, it was %s", before);
    putchar('\n');
}

/* ---- The command ---- */

/* Follows the definition, so that each command can be shown with the value that it replaced. */
static int list_commands(const char *file, rheo_recording *recording, bool json)
{
    rheo_world_def def = *rheo_recording_definition(recording);
    const uint64_t count = rheo_recording_command_count(recording);
    for (uint64_t i = 0; i < count; i++) {
        rheo_command command;
        rheo_error error = {""};
        const rheo_result result = rheo_recording_command(recording, i, &command, &error);
        if (result != RHEO_OK)
            return cli_file_error(file, result, &error);
        char before[96] = "";
        if (command.kind == RHEO_COMMAND_SET) {
            rheo_world_def_get(&def, command.path, before, sizeof before);
            rheo_world_def_set(&def, command.path, command.value, NULL);
        }
        if (json)
            write_command(file, &command, &def, before);
        else
            print_command(&command, before);
    }
    return CLI_DONE;
}

int cli_log_print(const char *file, rheo_recording *recording, bool json)
{
    if (json)
        write_made(file, recording);
    else
        print_made(file, recording);
    const int status = list_commands(file, recording, json);
    if (status != CLI_DONE)
        return status;
    char text[512];
    cli_ending_text(recording, text, sizeof text);
    if (json)
        write_end(file, recording);
    else
        cli_print(stdout, 12, "ends        %s\n", text);
    return CLI_DONE;
}

static int print_scene(const char *file, const rheo_recording *recording)
{
    const rheo_recording_info info = rheo_recording_get_info(recording);
    const char *text = info.scene_text;
    if (info.made_refused)
        return cli_fail(CLI_BAD, "the scene that %s holds is %s", file, cli_made_text(&info));
    if (!text[0])
        return cli_fail(CLI_BAD, "%s holds no scene; only recordings of `rheolog run SCENE` hold theirs", file);
    fputs(text, stdout);
    return CLI_DONE;
}

static int run(int argc, char **argv)
{
    bool json = false, scene = false;
    const cli_option options[] = {
        {"--scene", NULL, NULL, CLI_FLAG, &scene},
        {"--json", NULL, NULL, CLI_FLAG, &json},
        {0},
    };
    int status = cli_parse(&cli_log, options, &argc, argv);
    if (status != CLI_GO_ON)
        return status;
    if (argc != 1)
        return cli_usage(&cli_log, "needs one recording; got %d", argc);
    rheo_recording *recording = NULL;
    if ((status = cli_open_recording(argv[0], &recording)) != CLI_DONE)
        return status;
    status = scene ? print_scene(argv[0], recording) : cli_log_print(argv[0], recording, json);
    rheo_recording_close(recording);
    return status;
}

static const char help[] = {
#include "cli/help/log.txt.inc"
    0};

const cli_command cli_log = {"log", help, run};
