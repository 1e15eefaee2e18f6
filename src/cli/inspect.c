/*
 * rheolog inspect: prints a state at the end of a step or between two of its stages. inspect_gather.c reads the
 * requested values; inspect_text.c and inspect_json.c print them.
 */
#include "cli/inspect.h"

#include <string.h>

enum { DEFAULT_TOP = 5 };

/* ---- Step and stage ---- */

static int check_step(const cli_view *v)
{
    const unsigned long long first = v->info.first_step, last = v->info.last_step, step = v->step;
    const bool bad = v->failed && v->step == v->failure.step;
    if (bad && !v->stage)
        return cli_fail(CLI_BAD,
                        "%s: step %llu went bad and has no state; --step %llu is the last good one, and --stage "
                        "NAME shows how far step %llu got%s%s",
                        v->file, step, last, step, v->failure.stage[0] ? " before stage " : "", v->failure.stage);
    if (bad || (v->step >= first + (v->stage != NULL) && v->step <= last))
        return CLI_DONE;
    if (!v->stage)
        return cli_check_step(v->file, v->recording, "--step", step);
    if (first == last && !v->failed)
        return cli_fail(CLI_BAD, "%s holds the state at step %llu and no steps, so there is no stage to inspect",
                        v->file, first);
    return cli_fail(CLI_BAD, "%s: --stage inspects a recorded step: steps %llu to %llu; --step %llu is none of them",
                    v->file, first + 1, v->failed ? (unsigned long long)v->failure.step : last, step);
}

int cli_inspect_check_stage(const cli_view *v, const rheo_world *world)
{
    char all[1024] = "", asked[64];
    const char *nearest = "";
    rheo_stage_info stage;
    /* Checks the name without @SUBSTEP, which the library checks. */
    snprintf(asked, sizeof asked, "%.*s", (int)strcspn(v->stage, "@"), v->stage);
    for (uint32_t i = 0; rheo_world_stage(world, i, &stage) == RHEO_OK; i++) {
        if (strcmp(stage.name, asked) == 0)
            return CLI_DONE;
        nearest = i == 0 ? stage.name : rheo_nearest_word(asked, (const char *const[]){nearest, stage.name}, 2);
        const size_t length = strlen(all);
        snprintf(all + length, sizeof all - length, "%s%s", i ? ", " : "", stage.name);
    }
    char suggestion[CLI_SUGGESTION];
    return cli_fail(CLI_BAD, "there is no stage \"%s\" in %s%s Its stages: %s", v->stage, v->file,
                    *cli_did_you_mean(asked, nearest, suggestion) ? suggestion : ".", all);
}

void cli_inspect_at(cli_view *v, const rheo_world *world)
{
    v->world = world;
    v->complete = rheo_world_step_count(v->world);
    v->rows = rheo_world_history_rows(v->world);
    v->modes = rheo_world_history_modes(v->world);
    v->model_has_springs = cli_has_metric(v->world, "springs");
    v->runs = rheo_world_stages_done(v->world);
    v->all = rheo_world_stages_in_step(v->world);
    rheo_world_last_stage(v->world, v->stage_run);
    v->done = v->stage_run[0] ? v->stage_run : NULL;
}

static int go_there(cli_view *v, rheo_player *player)
{
    int status = check_step(v);
    if (status == CLI_DONE && v->stage)
        status = cli_inspect_check_stage(v, rheo_player_world(player));
    if (status != CLI_DONE)
        return status;
    rheo_error error = {""};
    const rheo_result result = v->stage ? rheo_player_seek_stage(player, v->step, v->stage, &error)
                                        : rheo_player_seek(player, v->step, &error);
    if (result != RHEO_OK)
        return cli_file_error(v->file, result, &error);
    cli_inspect_at(v, rheo_player_world(player));
    return CLI_DONE;
}

/* ---- The command ---- */

bool cli_ends_from(const char *text, uint64_t end[2])
{
    char first[24];
    const size_t length = strcspn(text, ":");
    if (length >= sizeof first || text[length] != ':')
        return false;
    memcpy(first, text, length);
    first[length] = 0;
    return cli_number_from(first, &end[0]) && cli_number_from(text + length + 1, &end[1]) && end[0] != end[1];
}

static int ask(cli_view *v, const cli_list *particle, const cli_list *spring)
{
    if (particle->count > 1 || spring->count > 1)
        return cli_usage(&cli_inspect, "one %s at a time; got %zu", particle->count > 1 ? "--particle" : "--spring",
                         particle->count > 1 ? particle->count : spring->count);
    v->has_particle = particle->count == 1;
    v->has_spring = spring->count == 1;
    if (v->has_particle && !cli_number_from(particle->item[0], &v->particle))
        return cli_usage(&cli_inspect, "--particle needs a whole number, 0 or more; got \"%s\"", particle->item[0]);
    if (v->has_spring && !cli_ends_from(spring->item[0], v->end))
        return cli_usage(&cli_inspect, "--spring needs two different ids, as 3:12; got \"%s\"", spring->item[0]);
    return CLI_GO_ON;
}

static int inspect(cli_view *v, bool json)
{
    rheo_player *player = NULL;
    rheo_error error = {""};
    cli_watch_signals();
    const rheo_result result = rheo_player_open(v->recording, NULL, &player, &error);
    if (result != RHEO_OK)
        return cli_file_error(v->file, result, &error);
    int status = go_there(v, player);
    if (status == CLI_DONE)
        status = cli_inspect_gather(v);
    /* The failure explains the last states, not earlier ones. */
    if (status == CLI_DONE && v->failed && v->step >= v->info.last_step)
        cli_warn("%s: %s", v->file, v->why);
    if (status == CLI_DONE && json)
        cli_inspect_json(v);
    else if (status == CLI_DONE)
        cli_inspect_text(v);
    cli_inspect_release(v);
    rheo_player_close(player);
    return status;
}

static int run(int argc, char **argv)
{
    bool cost = false, json = false;
    cli_number step = {false, 0}, top = {false, DEFAULT_TOP};
    cli_list particle = {0}, spring = {0};
    cli_view v = {0};
    const cli_option options[] = {
        {"--step", NULL, "N", CLI_NUMBER, &step},        {"--stage", NULL, "NAME", CLI_TEXT, &v.stage},
        {"--particle", NULL, "ID", CLI_LIST, &particle}, {"--spring", NULL, "A:B", CLI_LIST, &spring},
        {"--top", NULL, "N", CLI_NUMBER, &top},          {"--cost", NULL, NULL, CLI_FLAG, &cost},
        {"--json", NULL, NULL, CLI_FLAG, &json},         {0},
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
    v.has_rankings = top.given || (!v.has_particle && !v.has_spring);
    v.top = top.value < SIZE_MAX ? (size_t)top.value : SIZE_MAX;
    v.failed = rheo_recording_failure(v.recording, &v.failure);
    if (v.failed)
        rheo_failure_message(&v.failure, v.why, sizeof v.why);
    status = inspect(&v, json);
    if (cost)
        cli_say_cost((cli_cost){.seconds = 0});
    rheo_recording_close(v.recording);
    return status;
}

static const char help[] = {
#include "cli/help/inspect.txt.inc"
    0};

const cli_command cli_inspect = {"inspect", help, run};
