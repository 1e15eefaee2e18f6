/* rheolog rerecord: makes a recording again from itself with this build, and says whether it differs. */
#include "cli/cli.h"

static void print_json(const char *old_path, const char *new_path, const rheo_verification *v)
{
    rheo__json json = {.file = stdout};
    rheo__json_begin_object(&json, NULL);
    rheo__json_text(&json, "old", old_path);
    rheo__json_text(&json, "new", new_path);
    cli_verification_json(&json, v);
    rheo__json_end_object(&json);
}

static int rerecord(const char *old_path, const char *new_path, bool full, bool force, bool json)
{
    rheo_verification v;
    rheo_error error = {""};
    cli_watch_signals();
    cli_watch_name(old_path);
    const rheo_result result = rheo_rerecord(old_path, new_path, full, force, &v, &error);
    cli_watch_end();
    if (result != RHEO_OK)
        return cli_error(result, &error);
    if (json) {
        print_json(old_path, new_path, &v);
    } else {
        printf("%s, %s: %s\n", old_path, new_path, v.message);
        if (v.verdict == RHEO_DIFFERS)
            cli_growth_text(&v);
    }
    return v.verdict == RHEO_SAME ? CLI_DONE : CLI_DIFFERS;
}

static int run(int argc, char **argv)
{
    const char *output = NULL, *simd = NULL;
    bool full = false, force = false, json = false;
    const cli_option options[] = {
        {"--output", "-o", "NEW.rlog", CLI_TEXT, &output}, {"--full", NULL, NULL, CLI_FLAG, &full},
        {"--simd", NULL, "NAME", CLI_TEXT, &simd},         {"--force", NULL, NULL, CLI_FLAG, &force},
        {"--json", NULL, NULL, CLI_FLAG, &json},           {0},
    };
    int status = cli_parse(&cli_rerecord, options, &argc, argv);
    if (status != CLI_GO_ON)
        return status;
    if (argc != 1)
        return cli_usage(&cli_rerecord, "needs one recording; got %d", argc);
    if (!output)
        return cli_usage(&cli_rerecord, "needs -o NEW.rlog, the file to write");
    if ((status = cli_use_simd(simd)) != CLI_DONE || (status = cli_check_recording(argv[0])) != CLI_DONE)
        return status;
    if (cli_same_file(argv[0], output))
        return cli_fail(CLI_BAD, "%s cannot be recorded onto itself; write another file, then `rheolog bless`",
                        argv[0]);
    if ((status = cli_check_output(output, force ? RHEO_OUTPUT_REPLACE : RHEO_OUTPUT_NEW)) != CLI_DONE)
        return status;
    return rerecord(argv[0], output, full, force, json);
}

static const char help[] = {
#include "cli/help/rerecord.txt.inc"
    0};

const cli_command cli_rerecord = {"rerecord", help, run};
