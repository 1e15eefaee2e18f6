/* rheolog why: says who changed a particle in a step, and what the largest change came from. */
#include "cli/why.h"

#include <string.h>

typedef struct printing {
    const cli_why_request *request;
    const rheo_world *world;
    uint64_t changes;
    bool not_finite; /* a value was not finite */
    rheo__json *json;
} printing;

static bool print_change(void *data, const rheo_change *change)
{
    printing *p = data;
    const cli_why_request *r = p->request;
    if (p->changes++ == 0 && !r->json)
        printf("step %llu, %s of particle %llu (unit %s):\n", (unsigned long long)r->step, r->field,
               (unsigned long long)r->id, cli_why_unit(p->world, r->field));
    for (uint32_t axis = 0; axis < change->components; axis++)
        p->not_finite = p->not_finite || change->before[axis] - change->before[axis] != 0 ||
                        change->after[axis] - change->after[axis] != 0;
    (r->json ? cli_why_change_json : cli_why_change_text)(r, change);
    return !ferror(stdout) && !cli_interrupted();
}

static bool print_link(void *data, const rheo_link *link)
{
    printing *p = data;
    char text[CLI_WHY_TEXT];
    if (p->json)
        cli_why_link_json(p->json, link);
    else
        cli_print(stdout, 4, "  %s\n", cli_why_link_text(link, text));
    return !ferror(stdout) && !cli_interrupted();
}

/* A value that is not finite is followed to where it was born. */
static uint32_t depth_of(const printing *p)
{
    enum { TO_BIRTH = 16 };
    return p->not_finite && p->request->depth < TO_BIRTH ? TO_BIRTH : p->request->depth;
}

static rheo_result print_chain(printing *p, rheo_player *player, rheo_error *error)
{
    const cli_why_request *r = p->request;
    rheo_chain chain;
    rheo__json json = {.file = stdout};
    if (r->json) {
        p->json = &json;
        rheo__json_begin_object(&json, NULL);
        rheo__json_begin_list(&json, "chain");
    } else {
        puts("causes, each from the largest contribution to the one before:");
    }
    rheo_result result =
        rheo_player_why_chain(player, r->step, r->stage, r->id, r->field, depth_of(p), print_link, p, &chain, error);
    if (r->json) {
        rheo__json_end_list(&json);
        rheo__json_text(&json, "end", result == RHEO_OK ? cli_why_end_name(chain.end) : NULL);
        rheo__json_known_integer(&json, "end_step", result == RHEO_OK, chain.step);
        rheo__json_text(&json, "why", result == RHEO_OK ? chain.why : error->message);
        rheo__json_end_object(&json);
    } else if (result == RHEO_OK) {
        cli_why_print_end(&chain);
    }
    return result;
}

rheo_result cli_why_print(const cli_why_request *r, rheo_player *player, uint64_t *changes, rheo_error *error)
{
    printing p = {.request = r, .world = rheo_player_world(player)};
    rheo_result result = rheo_player_why(player, r->step, r->stage, r->id, r->field, print_change, &p, error);
    *changes = p.changes;
    if (result == RHEO_OK && cli_interrupted())
        return RHEO_ERROR_STOPPED;
    if (result == RHEO_OK && !p.changes && !r->json)
        printf("step %llu: nothing changed the %s of particle %llu\n", (unsigned long long)r->step, r->field,
               (unsigned long long)r->id);
    return result == RHEO_OK && p.changes && depth_of(&p) > 1 ? print_chain(&p, player, error) : result;
}

/* ---- The command ---- */

static void print_end(const cli_why_request *r, int status, uint64_t changes)
{
    rheo__json json = {.file = stdout};
    rheo__json_begin_object(&json, NULL);
    rheo__json_text(&json, "file", r->file);
    rheo__json_text(&json, "outcome", status == CLI_DONE ? changes ? "found" : "none" : cli_status_name(status));
    rheo__json_integer(&json, "changes", changes);
    rheo__json_text(&json, "reason", status == CLI_DONE ? NULL : cli_said());
    rheo__json_end_object(&json);
}

static int ask(const cli_why_request *r, rheo_recording *recording, uint64_t *changes)
{
    rheo_error error = {""};
    rheo_player *player = NULL;
    cli_watch_signals();
    cli_watch_name(r->file);
    rheo_result result = rheo_player_open(recording, NULL, &player, &error);
    if (result == RHEO_OK)
        result = cli_why_print(r, player, changes, &error);
    rheo_player_close(player);
    if (result == RHEO_ERROR_STOPPED)
        return cli_fail(CLI_INTERRUPTED, "%s: interrupted", r->file);
    return result == RHEO_OK ? CLI_DONE : cli_file_error(r->file, result, &error);
}

static int run(int argc, char **argv)
{
    cli_why_request r = {.field = "position"};
    const char *simd = NULL;
    cli_number step = {0}, particle = {0}, depth = {false, 1}, top = {false, CLI_WHY_TOP};
    bool all = false;
    const cli_option options[] = {
        {"--step", NULL, "S", CLI_NUMBER, &step},      {"--particle", NULL, "ID", CLI_NUMBER, &particle},
        {"--field", NULL, "NAME", CLI_TEXT, &r.field}, {"--stage", NULL, "NAME", CLI_TEXT, &r.stage},
        {"--depth", NULL, "N", CLI_NUMBER, &depth},    {"--top", NULL, "N", CLI_NUMBER, &top},
        {"--all", NULL, NULL, CLI_FLAG, &all},         {"--simd", NULL, "NAME", CLI_TEXT, &simd},
        {"--json", NULL, NULL, CLI_FLAG, &r.json},     {0},
    };
    int status = cli_parse(&cli_why, options, &argc, argv);
    if (status != CLI_GO_ON)
        return status;
    if (argc != 1)
        return cli_usage(&cli_why, "needs one recording; got %d", argc);
    if (!step.given || !particle.given)
        return cli_usage(&cli_why, "needs --step S and --particle ID: what to explain");
    if (all && top.given)
        return cli_usage(&cli_why, "takes one of --top and --all");
    if (depth.value < 1 || depth.value > 1000)
        return cli_usage(&cli_why, "--depth needs a number from 1 to 1000");
    r.file = argv[0];
    r.step = step.value;
    r.id = particle.value;
    r.depth = (uint32_t)depth.value;
    r.top = all ? UINT64_MAX : top.value;
    rheo_recording *recording = NULL;
    uint64_t changes = 0;
    if ((status = cli_use_simd(simd)) == CLI_DONE && (status = cli_open_recording(r.file, &recording)) == CLI_DONE)
        status = ask(&r, recording, &changes);
    if (r.json)
        print_end(&r, status, changes);
    rheo_recording_close(recording);
    return status == CLI_DONE && !changes ? CLI_DIFFERS : status;
}

static const char help[] = {
#include "cli/help/why.txt.inc"
    0};

const cli_command cli_why = {"why", help, run};
