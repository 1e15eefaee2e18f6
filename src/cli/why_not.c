/* rheolog why-not: says why two particles have no spring, or did not meet. */
#include <math.h>

#include "cli/inspect.h"

typedef struct request {
    const char *file, *spring, *pair;
    uint64_t step, end[2];
    bool list, json;
    const rheo_why_not *answer;
} request;

static const char *supports(const request *r, double distance, char text[32])
{
    return isnan(distance) ? "-" : rheo_number_brief(distance / r->answer->support, 5, text);
}

static bool print_step(void *data, const rheo_pair_step *s)
{
    const request *r = data;
    char distance[32], nearest[32];
    printf("%8llu  %10s  %10s", (unsigned long long)s->step, supports(r, s->distance, distance),
           supports(r, s->nearest, nearest));
    printf("%s%s%s\n", *s->stage ? "  after " : "", s->stage, s->spring ? ", with a spring" : "");
    return !ferror(stdout) && !cli_interrupted();
}

static bool print_step_json(void *data, const rheo_pair_step *s)
{
    (void)data;
    rheo__json json = {.file = stdout};
    rheo__json_begin_object(&json, NULL);
    rheo__json_integer(&json, "step", s->step);
    rheo__json_number(&json, "distance", s->distance);
    rheo__json_number(&json, "nearest", s->nearest);
    rheo__json_text(&json, "stage", *s->stage ? s->stage : NULL);
    rheo__json_bool(&json, "spring", s->spring);
    rheo__json_end_object(&json);
    return !ferror(stdout) && !cli_interrupted();
}

static bool go_on(void *data, const rheo_pair_step *s)
{
    (void)data;
    (void)s;
    return !cli_interrupted();
}

static void print_json(const request *r, int status, const rheo_why_not *w)
{
    const bool known = status == CLI_DONE;
    rheo__json json = {.file = stdout};
    rheo__json_begin_object(&json, NULL);
    rheo__json_text(&json, "file", r->file);
    rheo__json_text(&json, "outcome", !known ? cli_status_name(status) : w->holds ? "holds" : "explained");
    rheo__json_integer(&json, "id", r->end[0]);
    rheo__json_integer(&json, "other_id", r->end[1]);
    rheo__json_number(&json, "support", known ? w->support : NAN);
    rheo__json_number(&json, "distance", known ? w->at.distance : NAN);
    rheo__json_known_integer(&json, "nearest_step", known && *w->nearest.stage, w->nearest.step);
    rheo__json_text(&json, "nearest_stage", known && *w->nearest.stage ? w->nearest.stage : NULL);
    rheo__json_number(&json, "nearest", known && *w->nearest.stage ? w->nearest.nearest : NAN);
    rheo__json_known_integer(&json, "held_first", known && w->held, w->held_first);
    rheo__json_known_integer(&json, "held_last", known && w->held, w->held_last);
    rheo__json_bool(&json, "across", known && w->across);
    rheo__json_known_integer(&json, "first_looked", known, w->first);
    rheo__json_known_integer(&json, "last_looked", known, w->last);
    rheo__json_text(&json, "why", known ? w->why : NULL);
    rheo__json_integer(&json, "steps_simulated", rheo_work_done().steps);
    rheo__json_integer(&json, "states_read", rheo_work_done().states);
    rheo__json_text(&json, "reason", known ? NULL : cli_said());
    rheo__json_end_object(&json);
}

static int ask(request *r, rheo_recording *recording, rheo_why_not *w)
{
    rheo_error error = {""};
    rheo_player *player = NULL;
    cli_watch_signals();
    cli_watch_name(r->file);
    rheo_result result = rheo_player_open(recording, NULL, &player, &error);
    if (result == RHEO_OK) {
        r->answer = w;
        if (r->list && !r->json)
            printf("%8s  %10s  %10s\n", "step", "supports", "nearest");
        result = rheo_player_why_not(player, r->step, r->end[0], r->end[1], r->spring != NULL,
                                     !r->list  ? go_on
                                     : r->json ? print_step_json
                                               : print_step,
                                     r, w, &error);
    }
    rheo_player_close(player);
    if (result == RHEO_ERROR_STOPPED || (result == RHEO_OK && cli_interrupted()))
        return cli_fail(CLI_INTERRUPTED, "%s: interrupted", r->file);
    if (result != RHEO_OK)
        return cli_file_error(r->file, result, &error);
    if (!r->json)
        cli_print(stdout, 4, "%s\n", w->why);
    return CLI_DONE;
}

static int run(int argc, char **argv)
{
    request r = {.file = NULL};
    rheo_why_not w = {0};
    const char *simd = NULL;
    cli_number step = {0};
    bool cost = false;
    const cli_option options[] = {
        {"--step", NULL, "S", CLI_NUMBER, &step},   {"--spring", NULL, "A:B", CLI_TEXT, &r.spring},
        {"--pair", NULL, "A:B", CLI_TEXT, &r.pair}, {"--list", NULL, NULL, CLI_FLAG, &r.list},
        {"--cost", NULL, NULL, CLI_FLAG, &cost},    {"--simd", NULL, "NAME", CLI_TEXT, &simd},
        {"--json", NULL, NULL, CLI_FLAG, &r.json},  {0},
    };
    int status = cli_parse(&cli_why_not, options, &argc, argv);
    if (status != CLI_GO_ON)
        return status;
    if (argc != 1)
        return cli_usage(&cli_why_not, "needs one recording; got %d", argc);
    if (!step.given || (r.spring != NULL) + (r.pair != NULL) != 1)
        return cli_usage(&cli_why_not, "needs --step S, and --spring A:B or --pair A:B");
    if (!cli_ends_from(r.spring ? r.spring : r.pair, r.end))
        return cli_usage(&cli_why_not, "%s needs two different ids, as 3:12; got \"%s\"",
                         r.spring ? "--spring" : "--pair", r.spring ? r.spring : r.pair);
    r.file = argv[0];
    r.step = step.value;
    rheo_recording *recording = NULL;
    if ((status = cli_use_simd(simd)) == CLI_DONE && (status = cli_open_recording(r.file, &recording)) == CLI_DONE &&
        (status = cli_check_step(r.file, recording, "--step", r.step)) == CLI_DONE)
        status = ask(&r, recording, &w);
    if (r.json)
        print_json(&r, status, &w);
    if (cost)
        cli_say_cost((cli_cost){.seconds = 0});
    rheo_recording_close(recording);
    return status == CLI_DONE && w.holds ? CLI_DIFFERS : status;
}

static const char help[] = {
#include "cli/help/why_not.txt.inc"
    0};

const cli_command cli_why_not = {"why-not", help, run};
