/* rheolog metrics: prints the recorded metrics as CSV. Nothing is simulated. */
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
    const cli_option options[] = {{0}};
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

static const char help[] = {
#include "cli/help/metrics.txt.inc"
    0};

const cli_command cli_metrics = {"metrics", help, run};
