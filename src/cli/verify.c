/* rheolog verify: simulates recordings again and compares every step, as tests with golden recordings do. */
#include "cli/cli.h"

#include <string.h>

static void print_json(const char *file, const rheo_verification *v)
{
    cli_json json = {.file = stdout};
    cli_json_begin_object(&json, NULL);
    cli_json_text(&json, "file", file);
    if (v->has_hash)
        cli_json_hash(&json, "hash", v->hash);
    else
        cli_json_null(&json, "hash");
    cli_verification_json(&json, v);
    cli_json_end_object(&json);
}

static void print_text(const char *file, const rheo_verification *v)
{
    printf("%s: %s\n", file, v->message); /* the message begins with the verdict */
    if (v->verdict != RHEO_DIFFERS)
        return;
    cli_growth_text(v);
    if (v->first.stage[0] && v->first.step > 0)
        printf("  next: `rheolog checkpoint %s --step %llu -o before.rlog` keeps the last state that agrees; if the "
               "change "
               "is\n  intended, record again and run `rheolog bless %s NEW.rlog --because \"...\"`\n",
               file, (unsigned long long)v->first.step - 1, file);
    else
        printf("  next: the initial state does not have its recorded hash; get the original file again\n");
}

/* Verifies a file. CLI_DONE: *v has the verdict. */
static int verify(const char *file, rheo_verification *v)
{
    memset(v, 0, sizeof *v);
    const int status = cli_check_recording(file);
    if (status != CLI_DONE) {
        v->verdict = RHEO_UNREADABLE;
        snprintf(v->message, sizeof v->message, "%s: it cannot be read", cli_verdict_name(v->verdict));
        return CLI_DONE;
    }
    rheo_error error = {""};
    const rheo_result result = rheo_verify(file, v, &error);
    return result == RHEO_OK ? CLI_DONE : cli_fail(CLI_SYSTEM, "%s", error.message);
}

static int run(int argc, char **argv)
{
    bool json = false;
    const char *simd = NULL;
    const cli_option options[] = {
        {"--json", NULL, NULL, CLI_FLAG, &json},
        {"--simd", NULL, "NAME", CLI_TEXT, &simd},
        {0},
    };
    int status = cli_parse(&cli_verify, options, &argc, argv);
    if (status != CLI_GO_ON || (status = cli_use_simd(simd)) != CLI_DONE)
        return status;
    if (argc == 0)
        return cli_usage(&cli_verify, "no recordings given: nothing was verified");
    bool differs = false, unreadable = false, failed = false;
    for (int i = 0; i < argc; i++) {
        rheo_verification v;
        if (verify(argv[i], &v) != CLI_DONE) {
            failed = true;
            continue;
        }
        if (json)
            print_json(argv[i], &v);
        else
            print_text(argv[i], &v);
        fflush(stdout); /* the next file may take minutes */
        differs = differs || v.verdict == RHEO_DIFFERS;
        unreadable = unreadable || v.verdict == RHEO_UNREADABLE;
    }
    return failed ? CLI_SYSTEM : unreadable ? CLI_BAD : differs ? CLI_DIFFERS : CLI_DONE;
}

static const char help[] = {
#include "cli/help/verify.txt.inc"
    0};

const cli_command cli_verify = {"verify", help, run};
