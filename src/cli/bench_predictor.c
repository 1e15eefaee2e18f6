/*
 * rheolog bench predictor: runs random scenes, and compares what the measures of the doctor said in each step with
 * whether the run blew up, which is decided without them (bench_predictor_run.c).
 */
#include "cli/bench_predictor.h"

#include <stdlib.h>

#include "cli/steps.h"

enum { MOST_SCENES = 100000 };

static int run_all(cli_bench_arguments *a, cli_predictor_results *r)
{
    const double start = cli_now();
    a->progress.last = start;
    for (uint32_t i = 0; i < r->count; i++) {
        cli_predictor_run *run = &r->run[i];
        rheo_scene scene;
        rheo_error error = {""};
        if (cli_interrupted())
            return cli_fail(CLI_INTERRUPTED, "interrupted after %u of %u scenes", i, r->count);
        run->seed = a->seed + i;
        run->group = cli_predictor_group(run->seed);
        const rheo_result result = cli_predictor_scene(run->group, run->seed, &scene, &error);
        if (result != RHEO_OK)
            return cli_error(result, &error);
        const int status = cli_predictor_examine(&scene, run, &r->group[run->group]);
        rheo_scene_release(&scene);
        if (status != CLI_DONE)
            return status;
        const double time = cli_now();
        if (cli_progress_due(&a->progress, time)) {
            char left[32];
            cli_duration((time - start) / (i + 1) * (r->count - i - 1), left, sizeof left);
            cli_progress_say(&a->progress, time, "scene %u of %u, %s left", i + 1, r->count, left);
        }
    }
    return CLI_DONE;
}

int cli_predictor_check(const cli_predictor_results *r)
{
    int status = CLI_DONE;
    for (uint32_t g = 0; g < CLI_PREDICTOR_GROUPS; g++)
        for (uint32_t m = 0; m < r->group[g].count; m++) {
            cli_predictor_row row;
            cli_predictor_judge(r, g, m, &row);
            if (row.measure->kind[0] == 'b' && row.alone_bad > 0)
                status = cli_fail(CLI_DIFFERS, "%s: %u scene%s blew up below the bound of %s, %.3g",
                                  cli_predictor_group_name[g], row.alone_bad, cli_plural(row.alone_bad),
                                  row.measure->name, row.measure->limit);
        }
    return status;
}

int cli_bench_run_predictor(cli_bench_arguments *a)
{
    if (a->scene_count < 1 || a->scene_count > MOST_SCENES)
        return cli_usage(&cli_bench, "--count must be from 1 to %d", MOST_SCENES);
    int status = a->folder ? cli_make_folder(a->folder) : CLI_DONE;
    if (status == CLI_DONE && a->folder)
        status = cli_predictor_check_files(a->folder);
    if (status != CLI_DONE)
        return status;
    cli_predictor_results r = {.count = (uint32_t)a->scene_count};
    r.run = calloc(r.count, sizeof *r.run);
    if (!r.run)
        return cli_fail(CLI_SYSTEM, "no memory for the results of %u scenes", r.count);
    cli_watch_signals();
    status = run_all(a, &r);
    cli_progress_end(&a->progress);
    if (status == CLI_DONE)
        status = cli_predictor_report(&r, a);
    if (status == CLI_DONE)
        status = cli_predictor_check(&r);
    free(r.run);
    return status;
}
