/* rheolog metrics: the metrics stored in a recording as CSV. Nothing is simulated. */
#include "cli/cli.h"

#include <stdlib.h>

static void print_header(const rheo_recording *recording)
{
    for (uint32_t i = 0; i < rheo_recording_metric_count(recording); i++)
        printf("%s%s", i ? "," : "", rheo_recording_metric_name(recording, i));
    putchar('\n');
}

static void print_row(const double *values, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        char text[32];
        cli_number_text(values[i], text, sizeof text);
        printf("%s%s", i ? "," : "", text);
    }
    putchar('\n');
}

static int print_metrics(rheo_recording *recording)
{
    const rheo_recording_info info = rheo_recording_get_info(recording);
    const uint32_t count = rheo_recording_metric_count(recording);
    double *values = malloc((count + 1) * sizeof *values);
    if (!values)
        return cli_fail(CLI_SYSTEM, "no memory");
    print_header(recording);
    int status = info.complete ? CLI_DONE : CLI_BAD;
    for (uint64_t step = info.first_step; step <= info.last_step; step++) {
        rheo_error error = {""};
        const rheo_result result = rheo_recording_metrics(recording, step, values, &error);
        if (result != RHEO_OK) {
            status = cli_error(result, &error);
            break;
        }
        print_row(values, count);
    }
    free(values);
    return status;
}

static int run(int argc, char **argv)
{
    const cli_option options[] = {{NULL, NULL, NULL, CLI_FLAG, NULL, NULL}};
    int status = cli_parse(&cli_metrics, options, &argc, argv);
    if (status != CLI_GO_ON)
        return status;
    if (argc != 1)
        return cli_usage(&cli_metrics, "needs one recording; got %d", argc);
    rheo_recording *recording = NULL;
    if ((status = cli_open_recording(argv[0], &recording)) != CLI_DONE)
        return status;
    status = print_metrics(recording);
    rheo_recording_close(recording);
    return status;
}

const cli_command cli_metrics = {
    "metrics",
    "print what was measured at every step, as CSV",
    "metrics F.rlog",
    "Prints the metrics stored in a recording as CSV on standard output: a header, then one line a step. "
    "Nothing\n"
    "is simulated. Numbers are as short as reads back to the same double. Of a truncated recording the whole "
    "steps\n"
    "are printed, with a warning and exit code 2.",
    "examples:\n"
    "  rheolog metrics ball.rlog > ball.csv\n"
    "  rheolog metrics ball.rlog | cut -d, -f1,4\n"
    "\n"
    "exit codes: 0 done; 2 bad usage, not a recording, or truncated; 3 the system failed (disk, memory)",
    run,
};
