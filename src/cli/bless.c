/* rheolog bless: replaces a golden recording. No other command can do this. */
#include "cli/cli.h"

#include <string.h>

/* Number of blessings; also 0 if the recording cannot be read. */
static uint32_t blessings(const char *path)
{
    rheo_recording *recording;
    if (rheo_recording_open(path, &recording, NULL) != RHEO_OK)
        return 0;
    const uint32_t count = rheo_recording_blessing_count(recording);
    rheo_recording_close(recording);
    return count;
}

/* `at_least`: the weakest verdict that is accepted; UNKNOWN: any, and only what costs little is found out. */
static int bless(const char *old_path, const char *new_path, const char *because, bool shrink, rheo_sameness at_least)
{
    rheo_verification v;
    rheo_same_result same;
    rheo_same_options options = rheo_default_same_options();
    options.at_least = at_least == RHEO_SAMENESS_UNKNOWN ? RHEO_SAMENESS_ROUNDING : at_least;
    rheo_error error = {""};
    const bool existed = cli_exists(old_path);
    const uint32_t before = blessings(old_path);
    cli_watch_signals();
    const rheo_result result = rheo_bless_same(old_path, new_path, because, shrink, &options,
                                               at_least != RHEO_SAMENESS_UNKNOWN, &same, &v, &error);
    cli_watch_end();
    if (existed && v.verdict != RHEO_NOT_COMPARED)
        printf("%s: %s\n", old_path, v.message);
    cli_growth_text(&v);
    if (existed && same.verdict != RHEO_SAMENESS_UNKNOWN)
        cli_print(stdout, 2, "  %s\n", same.message);
    if (result != RHEO_OK)
        return cli_error(result, &error);
    const uint32_t count = blessings(old_path);
    if (count > before)
        printf("%s: %s; blessed %u time%s so far\n", old_path, existed ? "replaced" : "made", count,
               cli_plural(count));
    else
        printf("%s: not changed, there is nothing to bless\n", old_path);
    return CLI_DONE;
}

static int run(int argc, char **argv)
{
    const char *because = NULL, *at_least = NULL;
    rheo_sameness weakest = RHEO_SAMENESS_UNKNOWN;
    bool shrink = false;
    const cli_option options[] = {
        {"--because", NULL, "TEXT", CLI_TEXT, &because},
        {"--at-least", NULL, "RUNG", CLI_TEXT, &at_least},
        {"--shrink", NULL, NULL, CLI_FLAG, &shrink},
        {0},
    };
    int status = cli_parse(&cli_bless, options, &argc, argv);
    if (status != CLI_GO_ON)
        return status;
    if (argc != 2)
        return cli_usage(&cli_bless, "needs the golden recording and the new one; got %d", argc);
    if (!because || strspn(because, " \t\n") == strlen(because))
        return cli_usage(&cli_bless, "needs --because \"...\": what changed, and why that is right");
    if (at_least && (status = cli_read_sameness(&cli_bless, at_least, &weakest)) != CLI_DONE)
        return status;
    if ((status = cli_check_recording(argv[1])) != CLI_DONE)
        return status;
    if ((status = cli_check_folder(argv[0])) != CLI_DONE)
        return status;
    return bless(argv[0], argv[1], because, shrink, weakest);
}

static const char help[] = {
#include "cli/help/bless.txt.inc"
    0};

const cli_command cli_bless = {"bless", help, run};
