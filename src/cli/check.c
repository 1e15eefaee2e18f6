/* rheolog check: looks for likely mistakes in a scene. Its particles are made; nothing settles or runs. */
#include <math.h>
#include <stdlib.h>

#include "cli/preflight.h"
#include "cli/run.h"

typedef struct check_arguments {
    const char *scene;
    cli_list set;
    bool json;
} check_arguments;

static const char *verdict_of(int status)
{
    return status == CLI_DONE ? "good" : status == CLI_DIFFERS ? "warnings" : cli_status_name(status);
}

/* ---- JSON ---- */

static void write_warning(rheo__json *json, const rheo_warning *w)
{
    rheo__json_begin_object(json, NULL);
    rheo__json_text(json, "kind", rheo_warning_name(w->kind));
    rheo__json_bool(json, "refused", w->refused);
    rheo__json_text(json, "text", w->text);
    rheo__json_index(json, "shape", w->shape);
    rheo__json_index(json, "other_shape", w->other_shape);
    rheo__json_index(json, "wall", w->wall);
    rheo__json_index(json, "obstacle", w->obstacle);
    rheo__json_integer(json, "count", w->count);
    rheo__json_number(json, "value", w->value);
    rheo__json_number(json, "limit", w->limit);
    rheo__json_end_object(json);
}

/* why: the error of a scene that could not be examined, or NULL. */
static void print_json(const char *scene, int status, const char *why, uint64_t particles,
                       const rheo_warning *warnings, size_t count, const cli_preflight *preflight)
{
    rheo__json json = {.file = stdout};
    rheo__json_begin_object(&json, NULL);
    rheo__json_text(&json, "scene", scene);
    rheo__json_text(&json, "verdict", verdict_of(status));
    rheo__json_known_integer(&json, "particles", !why, particles);
    rheo__json_text(&json, "why", why);
    rheo__json_begin_list(&json, "warnings");
    for (size_t i = 0; i < count; i++)
        write_warning(&json, &warnings[i]);
    rheo__json_end_list(&json);
    cli_preflight_json(&json, preflight);
    rheo__json_end_object(&json);
}

/* ---- Text ---- */

/* probe: NULL if there is none. */
static void print_text(const char *scene, uint64_t particles, const rheo_warning *warnings, size_t count,
                       const cli_probe *probe)
{
    for (size_t i = 0; i < count; i++)
        cli_print(stdout, 4, "%s: %s\n", warnings[i].refused ? "refused" : "warning", warnings[i].text);
    const bool failed = probe && probe->failed[0];
    if (failed)
        cli_print(stdout, 4, "warning: a probe of %u unsettled particle%s: %s\n", probe->particles,
                  cli_plural(probe->particles), probe->failed);
    if (count == 0 && !failed)
        printf("%s: %llu particle%s, nothing to warn of\n", scene, (unsigned long long)particles,
               cli_plural(particles));
}

/* ---- The command ---- */

/* Examines the scene; the warnings are from malloc. */
static rheo_result examine(const rheo_scene *scene, uint64_t *particles, rheo_warning **warnings, size_t *count,
                           rheo_error *error)
{
    size_t room = 64;
    rheo_result result = rheo_scene_particle_count(scene, particles, error);
    *warnings = NULL;
    *count = 0;
    for (int pass = 0; result == RHEO_OK && pass < 2; pass++) {
        free(*warnings);
        *warnings = malloc(room * sizeof **warnings);
        if (!*warnings)
            return snprintf(error->message, sizeof error->message, "no memory for %zu warnings", room),
                   RHEO_ERROR_MEMORY;
        result = rheo_scene_warnings(scene, *warnings, room, count, error);
        if (*count <= room)
            break;
        room = *count;
    }
    return result;
}

/* Prints why the scene could not be examined, which a message has said. Returns `status`. */
static int refused(const check_arguments *a, int status)
{
    if (a->json)
        print_json(a->scene, status, cli_said(), 0, NULL, 0, NULL);
    return status;
}

static int check(const check_arguments *a, const rheo_scene *scene)
{
    rheo_error error = {""};
    rheo_warning *warnings;
    uint64_t particles;
    size_t count;
    int status = cli_check_memory(a->scene, scene, scene->steps);
    if (status != CLI_DONE)
        return refused(a, status);
    const rheo_result result = examine(scene, &particles, &warnings, &count, &error);
    if (result != RHEO_OK) {
        free(warnings);
        return refused(a, cli_scene_error(a->scene, a->set.count > 0, result, &error));
    }
    for (size_t i = 0; i < count; i++)
        if (status != CLI_BAD)
            status = warnings[i].refused ? CLI_BAD : CLI_DIFFERS;
    cli_preflight preflight;
    const bool foreseen = status != CLI_BAD && cli_preflight_find(scene, scene->steps, true, &preflight) == CLI_DONE;
    if (foreseen && preflight.probe.failed[0])
        status = CLI_DIFFERS;
    if (a->json)
        print_json(a->scene, status, NULL, particles, warnings, count, foreseen ? &preflight : NULL);
    else
        print_text(a->scene, particles, warnings, count, foreseen ? &preflight.probe : NULL);
    if (!a->json && foreseen)
        cli_preflight_print(&preflight);
    free(warnings);
    return status;
}

static int run(int argc, char **argv)
{
    check_arguments a = {.scene = NULL};
    const cli_option options[] = {
        {"--set", NULL, "KEY=VALUE", CLI_LIST, &a.set},
        {"--json", NULL, NULL, CLI_FLAG, &a.json},
        {0},
    };
    int status = cli_parse(&cli_check, options, &argc, argv);
    if (status != CLI_GO_ON)
        return status;
    if (argc != 1)
        return cli_usage(&cli_check, "needs one scene, a built-in name or a JSON file; got %d", argc);
    a.scene = argv[0];
    rheo_scene scene = rheo_default_scene();
    status = cli_find_scene(&cli_check, a.scene, &scene);
    if (status == CLI_DONE)
        status = cli_change_scene(&cli_check, &scene, &a.set);
    status = status == CLI_DONE ? check(&a, &scene) : refused(&a, status);
    rheo_scene_release(&scene);
    return status;
}

static const char help[] = {
#include "cli/help/check.txt.inc"
    0};

const cli_command cli_check = {"check", help, run};
