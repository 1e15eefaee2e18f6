/* rheolog scenes: lists the built-in scenes, or every parameter of a scene. */
#include "cli/cli.h"

#include "json/json_writer.h"
#include "cli/scenes.h"

static int print_scene(const rheo_scene *scene, bool as_json)
{
    uint64_t count;
    rheo_error error = {""};
    const rheo_result result = rheo_scene_particle_count(scene, &count, &error);
    if (result != RHEO_OK)
        return cli_error(result, &error);
    const unsigned long long particles = count;
    if (!as_json) {
        cli_print(stdout, 43, "%-20s %9llu particles  %s\n", scene->name, particles, scene->about);
        return CLI_DONE;
    }
    rheo__json json = {.file = stdout};
    rheo__json_begin_object(&json, NULL);
    rheo__json_text(&json, "name", scene->name);
    rheo__json_text(&json, "model", rheo_model_name(scene->world.model));
    rheo__json_integer(&json, "particles", particles);
    rheo__json_integer(&json, "steps", scene->steps);
    rheo__json_text(&json, "about", scene->about);
    rheo__json_end_object(&json);
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
    bool json = false, parameters = false, markdown = false;
    const cli_option options[] = {
        {"--parameters", NULL, NULL, CLI_FLAG, &parameters},
        {"--json", NULL, NULL, CLI_FLAG, &json},
        {"--markdown", NULL, NULL, CLI_FLAG, &markdown},
        {0},
    };
    const int status = cli_parse(&cli_scenes, options, &argc, argv);
    if (status != CLI_GO_ON)
        return status;
    if (argc > 0 && !parameters)
        return cli_usage(&cli_scenes, "takes no operand without --parameters; got \"%s\"", argv[0]);
    if (argc > 0 && markdown)
        return cli_usage(&cli_scenes, "--markdown prints all parameters; leave \"%s\" out", argv[0]);
    for (int i = 0; i < argc; i++)
        if (cli_parameters_wanted(1, argv + i) == 0)
            return cli_usage(&cli_scenes, "no parameter begins with \"%s\"", argv[i]);
    if (json && markdown)
        return cli_usage(&cli_scenes, "give one of --json and --markdown");
    if (markdown)
        cli_parameters_markdown();
    else if (parameters)
        (json ? cli_parameters_json : cli_parameters_text)((size_t)argc, argv);
    else
        return list_scenes(json);
    return CLI_DONE;
}

static const char help[] = {
#include "cli/help/scenes.txt.inc"
    0};

const cli_command cli_scenes = {"scenes", help, run};
