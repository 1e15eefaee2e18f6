/* rheolog experiments: repeats the experiments of the papers, and says whether they show what they must. */
#include "cli/experiment.h"

#include <string.h>

#include "cli/steps.h"

static const cli_experiment *const EXPERIMENT[] = {
    &cli_experiment_ball,          &cli_experiment_ball_long,    &cli_experiment_ball_si,
    &cli_experiment_settling,      &cli_experiment_drop,         &cli_experiment_pair,
    &cli_experiment_incline,       &cli_experiment_lumps,        &cli_experiment_fingers,
    &cli_experiment_hole,          &cli_experiment_gentle,       &cli_experiment_impact,
    &cli_experiment_runner,        &cli_experiment_positions,    &cli_experiment_positions_drop,
    &cli_experiment_melting_bunny, &cli_experiment_chair,        &cli_experiment_kernel,
    &cli_experiment_melting_all,   &cli_experiment_melting_logo, &cli_experiment_melting_cost,
    &cli_experiment_melting_drop,
};
enum { EXPERIMENTS = sizeof EXPERIMENT / sizeof *EXPERIMENT };

static void list(bool json)
{
    for (size_t i = 0; i < EXPERIMENTS; i++) {
        const cli_experiment *e = EXPERIMENT[i];
        if (!json) {
            cli_print(stdout, 20, "%-18s  %s (%s)\n", e->name, e->about, e->reference);
            continue;
        }
        rheo__json line = {.file = stdout};
        rheo__json_begin_object(&line, NULL);
        rheo__json_text(&line, "experiment", e->name);
        rheo__json_text(&line, "reference", e->reference);
        rheo__json_text(&line, "about", e->about);
        rheo__json_text(&line, "scene", e->scene);
        rheo__json_end_object(&line);
    }
}

static bool wanted(const cli_experiment *e, int count, char **names)
{
    for (int i = 0; i < count; i++)
        if (strcmp(names[i], e->name) == 0)
            return true;
    return count == 0;
}

/* Refuses a name that is no experiment. */
static int check_names(int count, char **names)
{
    const char *known[EXPERIMENTS];
    char suggestion[CLI_SUGGESTION];
    for (size_t i = 0; i < EXPERIMENTS; i++)
        known[i] = EXPERIMENT[i]->name;
    for (int k = 0; k < count; k++) {
        size_t i = 0;
        while (i < EXPERIMENTS && strcmp(names[k], known[i]) != 0)
            i++;
        if (i == EXPERIMENTS)
            return cli_usage(
                &cli_experiments, "there is no experiment \"%s\"%s `rheolog experiments --list` lists them", names[k],
                *cli_did_you_mean(names[k], rheo_nearest_word(names[k], known, EXPERIMENTS), suggestion) ? suggestion
                                                                                                         : ";");
    }
    return CLI_DONE;
}

static int run_one(const cli_experiment *e, const cli_experiment_options *options, const char *folder, bool json,
                   cli_progress *progress)
{
    cli_result result;
    int status = cli_experiment_run(e, options, progress, &result);
    const bool all = status == CLI_DONE && cli_experiment_judge(&result);
    if (json)
        cli_experiment_json(&result, status);
    else if (result.finished)
        cli_experiment_print(&result, status);
    if (status == CLI_DONE && folder)
        status = cli_experiment_write(&result, folder);
    if (status == CLI_DONE && !all)
        status = CLI_DIFFERS;
    cli_experiment_release(&result);
    return status;
}

/* Refuses what cannot be written before anything runs. */
static int check_output(const char *folder, bool small, int count, char **names)
{
    int status = cli_make_folder(folder);
    for (size_t i = 0; i < EXPERIMENTS && status == CLI_DONE; i++)
        if (wanted(EXPERIMENT[i], count, names))
            status = cli_experiment_check_files(EXPERIMENT[i], small, folder);
    return status;
}

static int run(int argc, char **argv)
{
    bool small = false, json = false, only_list = false;
    const char *folder = NULL;
    cli_number seeds = {false, 1};
    cli_list set = {0};
    const cli_option options[] = {
        {"--list", NULL, NULL, CLI_FLAG, &only_list},
        {"--small", NULL, NULL, CLI_FLAG, &small},
        {"--seeds", NULL, "N", CLI_NUMBER, &seeds},
        {"--output", "-o", "FOLDER", CLI_TEXT, &folder},
        {"--set", NULL, "KEY=VALUE", CLI_LIST, &set},
        {"--json", NULL, NULL, CLI_FLAG, &json},
        {0},
    };
    int status = cli_parse(&cli_experiments, options, &argc, argv);
    if (status != CLI_GO_ON)
        return status;
    if (seeds.value < 1 || seeds.value > CLI_MOST_SEEDS)
        return cli_usage(&cli_experiments, "--seeds is 1 to %d; got %llu", CLI_MOST_SEEDS,
                         (unsigned long long)seeds.value);
    if ((status = check_names(argc, argv)) != CLI_DONE)
        return status;
    if (only_list && argc > 0)
        return cli_usage(&cli_experiments, "--list lists all experiments; leave \"%s\" out", argv[0]);
    if (only_list) {
        list(json);
        return CLI_DONE;
    }
    if (folder && (status = check_output(folder, small, argc, argv)) != CLI_DONE)
        return status;
    for (size_t i = 0; i < set.count; i++) {
        char key[128];
        const char *value = NULL;
        if ((status = cli_split_setting(&cli_experiments, set.item[i], key, sizeof key, &value)) != CLI_DONE)
            return status;
    }
    const cli_experiment_options how = {small, (uint32_t)seeds.value, &set};
    cli_watch_signals();
    cli_progress progress = cli_progress_begin(cli_now());
    int worst = CLI_DONE;
    for (size_t i = 0, shown = 0; i < EXPERIMENTS; i++) {
        if (!wanted(EXPERIMENT[i], argc, argv))
            continue;
        if (shown++ > 0 && !json)
            putchar('\n');
        status = run_one(EXPERIMENT[i], &how, folder, json, &progress);
        fflush(stdout);
        if (status > CLI_DIFFERS)
            return status;
        worst = status > worst ? status : worst;
    }
    return worst;
}

static const char help[] = {
#include "cli/help/experiments.txt.inc"
    0};

const cli_command cli_experiments = {"experiments", help, run};
