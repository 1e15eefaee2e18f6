/* rheolog when: says at which steps of a recording a condition holds. */
#include <string.h>

#include "cli/found.h"

typedef struct when {
    const char *file, *condition, *stage, *simd;
    bool first, last, all, cost, json;
    cli_number after, before;
    rheo_search search;
} when;

static void print_text(const rheo_found *f)
{
    char text[CLI_FOUND];
    puts(cli_found_text(f, text));
}

static void print_json(const rheo_found *f)
{
    rheo__json json = {.file = stdout};
    const bool ball = strncmp(f->item, "ball", 4) == 0, id = *f->item && strcmp(f->item, "ball") != 0,
               spring = strncmp(f->item, "spring", 6) == 0;
    rheo__json_begin_object(&json, NULL);
    rheo__json_integer(&json, "step", f->step);
    rheo__json_text(&json, "stage", *f->stage ? f->stage : NULL);
    rheo__json_text(&json, "item", !*f->item ? NULL : spring ? "spring" : ball ? "ball" : "particle");
    rheo__json_known_integer(&json, "id", id, f->id);
    rheo__json_known_integer(&json, "other_id", spring, f->other_id);
    rheo__json_text(&json, "quantity", f->quantity);
    rheo__json_number(&json, "value", f->value);
    rheo__json_end_object(&json);
}

/* Prints a place. Further ones only if a reader is there. */
static bool receive(void *data, const rheo_found *found)
{
    (((const when *)data)->json ? print_json : print_text)(found);
    return !ferror(stdout) && !cli_interrupted();
}

/* "in steps 1 to 250", or nothing. */
static const char *range(const rheo_search *s, char text[80])
{
    if (s->looked)
        snprintf(text, 80, "in steps %llu to %llu", (unsigned long long)s->first, (unsigned long long)s->last);
    else
        snprintf(text, 80, "in no step");
    return text;
}

static void print_end(const when *w, int status)
{
    const rheo_search *s = &w->search;
    rheo__json json = {.file = stdout};
    if (s->hits == 0) { /* a line for those who read `step` alone */
        rheo__json_begin_object(&json, NULL);
        rheo__json_text(&json, "step", NULL);
        rheo__json_end_object(&json);
    }
    rheo__json_begin_object(&json, NULL);
    rheo__json_text(&json, "file", w->file);
    rheo__json_text(&json, "condition", w->condition);
    rheo__json_text(&json, "outcome", status == CLI_DONE ? s->hits ? "found" : "none" : cli_status_name(status));
    rheo__json_integer(&json, "hits", s->hits);
    rheo__json_known_integer(&json, "first_looked", s->looked, s->first);
    rheo__json_known_integer(&json, "last_looked", s->looked, s->last);
    rheo__json_integer(&json, "steps_simulated", rheo_work_done().steps);
    rheo__json_integer(&json, "states_read", rheo_work_done().states);
    rheo__json_text(&json, "reason", status == CLI_DONE ? NULL : cli_said());
    rheo__json_end_object(&json);
}

static int search(when *w, rheo_recording *recording)
{
    rheo_error error = {""};
    const rheo_find_options options = {.which = w->last  ? RHEO_FIND_LAST
                                                : w->all ? RHEO_FIND_ALL
                                                         : RHEO_FIND_FIRST,
                                       .has_after = w->after.given,
                                       .after = w->after.value,
                                       .has_before = w->before.given,
                                       .before = w->before.value,
                                       .stage = w->stage,
                                       .receiver = receive,
                                       .data = w};
    char text[80];
    cli_watch_signals();
    cli_watch_name(w->file);
    const rheo_result result = rheo_recording_find(recording, w->condition, &options, &w->search, &error);
    if (result == RHEO_ERROR_STOPPED || (result == RHEO_OK && cli_interrupted())) {
        if (w->last && w->search.hits && result == RHEO_ERROR_STOPPED)
            receive(w, &w->search.found); /* the last so far */
        return cli_fail(CLI_INTERRUPTED, "%s: interrupted; %llu found %s", w->file,
                        (unsigned long long)w->search.hits, range(&w->search, text));
    }
    if (result != RHEO_OK)
        return cli_file_error(w->file, result, &error);
    if (!w->json && !w->search.hits)
        printf("%s: does not hold %s\n", w->file, range(&w->search, text));
    return CLI_DONE;
}

static int check_usage(const when *w, int argc)
{
    if (argc < 2)
        return cli_usage(&cli_when, "needs a recording and a condition in quotes, as in \"ball: y < 8\"");
    if (argc > 2)
        return cli_usage(&cli_when, "needs one recording and one condition; put the condition in quotes");
    if (w->first + w->last + w->all > 1)
        return cli_usage(&cli_when, "takes one of --first, --last and --all");
    return CLI_DONE;
}

static int run(int argc, char **argv)
{
    when w = {.file = NULL};
    const cli_option options[] = {
        {"--first", NULL, NULL, CLI_FLAG, &w.first},    {"--last", NULL, NULL, CLI_FLAG, &w.last},
        {"--all", NULL, NULL, CLI_FLAG, &w.all},        {"--after", NULL, "S", CLI_NUMBER, &w.after},
        {"--before", NULL, "S", CLI_NUMBER, &w.before}, {"--stage", NULL, "NAME", CLI_TEXT, &w.stage},
        {"--cost", NULL, NULL, CLI_FLAG, &w.cost},      {"--simd", NULL, "NAME", CLI_TEXT, &w.simd},
        {"--json", NULL, NULL, CLI_FLAG, &w.json},      {0},
    };
    rheo_recording *recording = NULL;
    int status = cli_parse(&cli_when, options, &argc, argv);
    if (status != CLI_GO_ON)
        return status;
    w.file = argc > 0 ? argv[0] : NULL;
    w.condition = argc > 1 ? argv[1] : NULL;
    if ((status = check_usage(&w, argc)) == CLI_DONE && (status = cli_use_simd(w.simd)) == CLI_DONE &&
        (status = cli_open_recording(w.file, &recording)) == CLI_DONE)
        status = search(&w, recording);
    if (w.json)
        print_end(&w, status);
    if (w.cost)
        cli_say_cost((cli_cost){.seconds = 0});
    rheo_recording_close(recording);
    return status == CLI_DONE && !w.search.hits ? CLI_DIFFERS : status;
}

static const char help[] = {
#include "cli/help/when.txt.inc"
    0};

const cli_command cli_when = {"when", help, run};
