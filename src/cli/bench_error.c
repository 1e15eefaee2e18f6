/* rheolog bench error: speed against error of every choice. Each study has its own file, error_NAME.c. */
#include "cli/error.h"

#include <stdlib.h>
#include <string.h>

#include "cli/error_trials.h"
#include "cli/steps.h"

static const cli_error_study STUDY[] = {
    {"history", "thickening", "memories, against the fractional derivative of signals", cli_error_history},
    {"steps", "thickening", "time step, substeps and schemes, against closed forms and the limit step -> 0",
     cli_error_steps},
    {"sweeps", "thickening", "order of pairs: images of a run, spin, pressure", cli_error_sweeps},
    {"springs", "thickening", "solvers of stiff springs: stiffness reached, and error", cli_error_springs},
    {"spacing", "thickening", "spacing of the particles, against the limit spacing -> 0", cli_error_spacing},
    {"number", NULL, "growth of roundings in the built-in scenes, in spacings", cli_error_number},
    {"heat", "melting", "conduction in a slab: spacing, substep and Laplacian, against closed forms", cli_error_heat},
    {"channel", "melting", "flow between walls: spacing, substep, solver, stress, walls, against closed forms",
     cli_error_channel},
    {"column", "melting", "a column at rest, against hydrostatics, and one that collapses", cli_error_column},
    {"bunny", "melting", "the bunny that melts, against finer runs", cli_error_bunny},
};
enum { STUDIES = sizeof STUDY / sizeof *STUDY };

bool cli_error_list_has(const char *list, const char *word)
{
    const size_t length = strlen(word);
    for (;;) {
        const size_t n = strcspn(list, ",");
        if (n == length && strncmp(list, word, n) == 0)
            return true;
        if (!list[n])
            return false;
        list += n + 1;
    }
}

static bool is_wanted(const cli_bench_arguments *a, const cli_error_study *study)
{
    return (!a->model || !study->model || strcmp(a->model, study->model) == 0) &&
           (!a->studies || cli_error_list_has(a->studies, study->name));
}

/* Refuses a word of --study that is no study, with the list of those that there are. */
static int check_names(const cli_bench_arguments *a)
{
    for (const char *list = a->studies; list; list = *list ? list + 1 : NULL) {
        const size_t n = strcspn(list, ",");
        bool known = false;
        char names[256] = "";
        for (size_t i = 0; i < STUDIES; i++) {
            known = known || (strlen(STUDY[i].name) == n && strncmp(STUDY[i].name, list, n) == 0);
            snprintf(names + strlen(names), sizeof names - strlen(names), "%s%s",
                     i == 0             ? ""
                     : i + 1 == STUDIES ? " and "
                                        : ", ",
                     STUDY[i].name);
        }
        if (!known)
            return cli_usage(&cli_bench, "there is no study \"%.*s\"; there are %s", n < 64 ? (int)n : 64, list,
                             names);
        list += n;
        if (!*list)
            break;
    }
    return CLI_DONE;
}

/* Refuses a word of --scenes that is no case of the studies, with the list of those that there are. */
static int check_cases(cli_bench_arguments *a)
{
    char cases[CLI_CASE_NAMES] = "", list[2 * CLI_CASE_NAMES] = "";
    int status = CLI_DONE;
    a->cases = cases;
    for (size_t i = 0; i < STUDIES && status == CLI_DONE; i++)
        if (is_wanted(a, &STUDY[i]))
            status = STUDY[i].run(a, &(cli_error_points){.count = 0});
    a->cases = NULL;
    for (size_t i = 0, length = 0; cases[i]; i++)
        length += (size_t)snprintf(list + length, sizeof list - length, cases[i] == ',' ? ", " : "%c", cases[i]);
    for (const char *word = a->scenes; status == CLI_DONE; word++) {
        char name[64];
        const size_t length = strcspn(word, ",");
        snprintf(name, sizeof name, "%.*s", length < sizeof name ? (int)length : 0, word);
        if (!*name || !cli_error_list_has(cases, name))
            status = cli_usage(&cli_bench, "no study that was chosen has a scene \"%s\"; there are %s", name, list);
        word += length;
        if (!*word)
            break;
    }
    return status;
}

/* Refuses what cannot be measured or written, before anything runs. */
static int check(cli_bench_arguments *a)
{
    if (a->model && strcmp(a->model, "thickening") != 0 && strcmp(a->model, "melting") != 0)
        return cli_usage(&cli_bench, "--model is thickening or melting; got \"%s\"", a->model);
    int status = check_names(a);
    size_t wanted = 0;
    for (size_t i = 0; i < STUDIES; i++)
        wanted += is_wanted(a, &STUDY[i]);
    if (status == CLI_DONE && !wanted)
        status = cli_usage(&cli_bench, "no study of --study %s is of the model %s", a->studies, a->model);
    if (status == CLI_DONE && a->scenes)
        status = check_cases(a);
    if (status == CLI_DONE && a->folder)
        status = cli_make_folder(a->folder);
    for (size_t i = 0; i < STUDIES && status == CLI_DONE && a->folder; i++)
        if (is_wanted(a, &STUDY[i]))
            status = cli_error_check_files(&STUDY[i], a->folder);
    return status;
}

int cli_bench_run_error(cli_bench_arguments *a)
{
    cli_bench_table table = {.json = a->json};
    bool first = true;
    int status = check(a);
    for (size_t i = 0; i < STUDIES && status == CLI_DONE; i++) {
        cli_error_points points = {0};
        if (!is_wanted(a, &STUDY[i]))
            continue;
        status = STUDY[i].run(a, &points);
        cli_progress_end(&a->progress);
        if (status == CLI_DONE && points.count) {
            cli_error_judge(&points);
            if (a->csv || a->json) {
                cli_error_rows(&STUDY[i], &points, &table);
            } else {
                fputs(first ? "" : "\n", stdout);
                cli_error_print(&STUDY[i], &points);
            }
        }
        if (status == CLI_DONE && a->folder && points.count)
            status = cli_error_write(&STUDY[i], &points, a->folder);
        first = first && !points.count;
        free(points.item);
    }
    if (status == CLI_DONE && !a->csv && !a->json)
        puts(
            "\n*: on the front: no other setting is both cheaper and closer. error: relative, unless the study says\n"
            "otherwise. order: observed, to the next coarser setting of the series. ns/step: per particle; us/time: per\n"
            "particle and unit of simulated time. substeps: in all steps; iterations: of the solver, per substep.");
    return status;
}
