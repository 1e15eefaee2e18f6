/* The health of a run: warns if it starts from an ill state, and says since when it is unhealthy. */
#include "cli/run.h"

#include <string.h>

/* "speed_jump is 3.6, more than 1, particle 17" */
static void describe(const rheo_finding *f, char *text, size_t size)
{
    char numbers[256];
    rheo_finding_text(f, numbers, sizeof numbers);
    snprintf(text, size, "%s is %s", f->measure, numbers);
}

/* What a recording says about its steps up to `last`. False: nothing severe. */
static bool unhealthy_until(rheo_recording *recording, uint64_t last, rheo_finding *finding)
{
    rheo_diagnosis d;
    if (rheo_diagnose(recording, &d, NULL) != RHEO_OK || d.healthy || d.unhealthy_step > last)
        return false;
    for (uint32_t i = 0; i < d.finding_count; i++)
        if (d.findings[i].severe && d.findings[i].step == d.unhealthy_step) {
            *finding = d.findings[i];
            return true;
        }
    return false;
}

static void warn(const char *what, const rheo_finding *f, const char *cure)
{
    char text[320];
    describe(f, text, sizeof text);
    cli_print(stderr, 4, "warning: %s step %llu %s%s\n", what, (unsigned long long)f->step, text, cure);
}

int cli_run_watch(cli_run_state *run, const char *output)
{
    const uint64_t step = rheo_world_step_count(run->world);
    rheo_error error = {""};
    const rheo_result result = rheo_health_open(run->world, &run->health, &error);
    if (result != RHEO_OK)
        return cli_error(result, &error);
    rheo_finding f;
    if (run->recorded > 0) { /* the steps that the file has */
        rheo_recording *there;
        if (rheo_recording_open(output, &there, NULL) == RHEO_OK) {
            run->unhealthy = unhealthy_until(there, step, &run->finding);
            rheo_recording_close(there);
        }
        return CLI_DONE;
    }
    if (run->recording && unhealthy_until(run->recording, step, &f))
        warn("the recording that the run starts from is unhealthy: in", &f, "");
    else if (rheo_health_start(run->health, &f) && f.severe)
        warn("the run is unhealthy from its start: in", &f, "; make the scene again with other parameters");
    else if (rheo_health_start(run->health, &f))
        warn("the run may go bad: in", &f, "");
    return CLI_DONE;
}

bool cli_run_examine(cli_run_state *run)
{
    if (!run->unhealthy)
        run->unhealthy = rheo_health_step(run->health, &run->finding);
    return !run->unhealthy;
}

void cli_run_unhealthy(const cli_run_state *run, char *text, size_t size)
{
    char what[320];
    describe(&run->finding, what, sizeof what);
    snprintf(text, size, "unhealthy since step %llu (%s)", (unsigned long long)run->finding.step, what);
}
