/* rheolog scenes: the built-in scenes, and every parameter that a scene has. */
#include "cli/cli.h"

#include <string.h>

#include "cli/scene_json.h"

static int print_scene(const rheo_scene *scene, bool as_json)
{
    uint64_t count;
    rheo_error error = {""};
    const rheo_result result = rheo_scene_particle_count(scene, &count, &error);
    if (result != RHEO_OK)
        return cli_error(result, &error);
    const unsigned long long particles = count;
    if (!as_json) {
        printf("%-20s %9llu particles  %s\n", scene->name, particles, scene->about);
        return CLI_DONE;
    }
    cli_json json = {.file = stdout};
    cli_json_begin_object(&json, NULL);
    cli_json_text(&json, "name", scene->name);
    cli_json_text(&json, "model", rheo_model_name(scene->world.model));
    cli_json_integer(&json, "particles", particles);
    cli_json_integer(&json, "steps", scene->steps);
    cli_json_text(&json, "about", scene->about);
    cli_json_end_object(&json);
    return CLI_DONE;
}

/* The library takes no larger numbers; in a list for people that is no bound. */
#define UNBOUNDED 1e30

/* "0 < x <= 1", as far as there are bounds. */
static void print_range(const rheo_parameter *p)
{
    char low[32], high[32], words[256];
    cli_number_text(p->minimum, low, sizeof low);
    cli_number_text(p->maximum, high, sizeof high);
    const bool from = p->minimum > -UNBOUNDED, to = p->maximum < UNBOUNDED;
    if (p->choices)
        printf("one of: %s", rheo_parameter_words(p, words, sizeof words));
    else if (from && to)
        printf("%s %s x %s %s", low, p->above_minimum ? "<" : "<=", p->below_maximum ? "<" : "<=", high);
    else if (from)
        printf("x %s %s", p->above_minimum ? ">" : ">=", low);
    else if (to)
        printf("x %s %s", p->below_maximum ? "<" : "<=", high);
    else
        printf("any");
    if (p->type == RHEO_PARAMETER_INTEGER)
        printf(", whole");
    else if (p->type == RHEO_PARAMETER_VECTOR)
        printf(", written [x, y, z]");
    else if (p->type == RHEO_PARAMETER_WINDOW)
        printf(", or a time as \"2.5 s\"");
}

enum { MAX_MODELS = 32 }; /* sets of models are 32-bit masks */

static bool is_of(const rheo_parameter *p, rheo_model model)
{
    return (p->models >> model & 1) != 0;
}

/* The defaults of the models that have it; the first of them counts where one is wanted. */
static const char *defaults_of(const rheo_parameter *p, char value[MAX_MODELS][128])
{
    const char *first = NULL;
    for (rheo_model model = 0; model < rheo_model_count(); model++) {
        const rheo_scene scene = rheo_default_model_scene(model);
        value[model][0] = 0;
        if (!is_of(p, model))
            continue;
        rheo_scene_get(&scene, p->path, value[model], sizeof value[model]);
        first = first ? first : value[model];
    }
    return first;
}

static void print_parameter_json(const rheo_parameter *p)
{
    static const char *const types[] = {"real", "integer", "vector", "choice", "window"};
    char value[MAX_MODELS][128], words[256];
    const char *first = defaults_of(p, value);
    cli_json json = {.file = stdout};
    cli_json_begin_object(&json, NULL);
    cli_json_text(&json, "path", p->path);
    cli_json_text(&json, "type", types[p->type]);
    cli_json_text(&json, "unit", p->unit ? p->unit : "");
    cli_json_parameter(&json, "default", p, first);
    cli_json_begin_object(&json, "models");
    for (rheo_model model = 0; model < rheo_model_count(); model++)
        if (is_of(p, model))
            cli_json_parameter(&json, rheo_model_name(model), p, value[model]);
    cli_json_end_object(&json);
    cli_json_number(&json, "minimum", p->minimum);
    cli_json_number(&json, "maximum", p->maximum);
    cli_json_bool(&json, "above_minimum", p->above_minimum);
    cli_json_bool(&json, "below_maximum", p->below_maximum);
    cli_json_text(&json, "choices", p->choices ? rheo_parameter_words(p, words, sizeof words) : NULL);
    cli_json_bool(&json, "live", p->live);
    cli_json_text(&json, "about", p->about);
    cli_json_end_object(&json);
}

static void print_parameter(const rheo_parameter *p)
{
    char value[MAX_MODELS][128];
    const bool unit = p->unit && *p->unit && strcmp(p->unit, "1") != 0;
    const char *first = defaults_of(p, value);
    printf("%s = %s", p->path, first);
    for (rheo_model model = 0; model < rheo_model_count(); model++)
        if (is_of(p, model) && strcmp(value[model], first) != 0)
            printf(", of %s %s", rheo_model_name(model), value[model]);
    printf("%s%s%s", unit ? "  " : "", unit ? p->unit : "", p->live ? "  (live)" : "");
    for (rheo_model model = 0; model < rheo_model_count(); model++)
        if (p->models == UINT32_C(1) << model)
            printf("  (%s)", rheo_model_name(model));
    printf("\n    %s\n    ", p->about);
    print_range(p);
    putchar('\n');
}

static int list_parameters(bool json)
{
    if (!json)
        puts("A parameter's path is its name for --set, and in a scene file {\"fluid\": {\"support\": 4}} is\n"
             "fluid.support. Live ones can be changed in a running world (--set together with --from); those\n"
             "that name a model belong to it alone.\n"
             "Units: L length, T time, M mass, K temperature.\n");
    const rheo_parameter *p = NULL;
    for (size_t i = 0; (p = rheo_scene_parameter_at(i)) != NULL; i++)
        if (strcmp(p->path, "model") == 0)
            continue; /* a scene has one from its beginning; it is not set */
        else if (json)
            print_parameter_json(p);
        else
            print_parameter(p);
    return CLI_DONE;
}

static int list_scenes(bool json)
{
    rheo_scene scene;
    int status = CLI_DONE;
    for (size_t i = 0; i < rheo_scene_builtin_count() && status == CLI_DONE; i++)
        if (rheo_scene_builtin_at(i, &scene) == RHEO_OK) {
            status = print_scene(&scene, json);
            rheo_scene_release(&scene);
        }
    return status;
}

static int run(int argc, char **argv)
{
    bool json = false, parameters = false;
    const cli_option options[] = {
        {"--parameters", NULL, NULL, CLI_FLAG, &parameters},
        {"--json", NULL, NULL, CLI_FLAG, &json},
        {0},
    };
    const int status = cli_parse(&cli_scenes, options, &argc, argv);
    if (status != CLI_GO_ON)
        return status;
    if (argc > 0)
        return cli_usage(&cli_scenes, "takes no operand; got \"%s\"", argv[0]);
    return parameters ? list_parameters(json) : list_scenes(json);
}

static const char help[] = {
#include "cli/help/scenes.txt.inc"
    0};

const cli_command cli_scenes = {"scenes", help, run};
