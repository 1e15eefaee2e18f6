/* rheolog verify: simulates recordings again and compares every step; the heart of a test with golden
 * recordings. */
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
    printf("%s: %s\n", file, v->message); /* which begins with the verdict */
    if (v->verdict != RHEO_DIFFERS)
        return;
    cli_growth_text(v);
    if (v->first.stage[0] && v->first.step > 0)
        printf("  next: `rheolog checkpoint %s --step %llu -o before.rlog` keeps the last state that agrees; if the "
               "change "
               "is\n  meant, record anew and `rheolog bless %s NEW.rlog --because \"...\"`\n",
               file, (unsigned long long)v->first.step - 1, file);
    else
        printf("  next: the first state itself is not what its hash says; take the file from where it was "
               "made\n");
}

/* CLI_DONE: *v holds the verdict. */
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
    return result == RHEO_OK ? CLI_DONE : cli_fail(CLI_SYSTEM, "%s: %s", file, error.message);
}

static int run(int argc, char **argv)
{
    bool json = false;
    const char *simd = NULL;
    const cli_option options[] = {
        {"--json", NULL, NULL, CLI_FLAG, &json, "one JSON object a file, one a line, instead of text"},
        {"--simd", NULL, "NAME", CLI_TEXT, &simd, CLI_SIMD_HELP},
        {NULL, NULL, NULL, CLI_FLAG, NULL, NULL},
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
        fflush(stdout); /* a file may take minutes; main() finds a failure */
        differs = differs || v.verdict == RHEO_DIFFERS;
        unreadable = unreadable || v.verdict == RHEO_UNREADABLE;
    }
    return failed ? CLI_SYSTEM : unreadable ? CLI_BAD : differs ? CLI_DIFFERS : CLI_DONE;
}

const cli_command cli_verify = {
    "verify",
    "simulate recordings again and compare every step",
    "verify F.rlog... [--json] [--simd NAME]",
    "Simulates each recording again from its first keyframe, with the recorded commands, and compares the hash of\n"
    "every field after every stage of every step; a run that ended with a step that went bad must fail again, at\n"
    "the same place. Names the first difference: step, stage, field; the particle, component and both values, if\n"
    "only one value differs right after that stage (the recorded one is then solved from its hash), or if the\n"
    "recording was made with --full (values at the end of the step); and how the difference grows wherever the\n"
    "recording holds a state. A damaged or truncated file is `unreadable`; it says how many steps held.",
    "examples:\n"
    "  rheolog verify replays/*.rlog          a test: fails as soon as anything changed\n"
    "  rheolog verify --json ball.rlog\n"
    "\n"
    "--json keys: file, hash (of this build's state after the last step that was compared; equal states have equal\n"
    "hashes on any machine; null if there is none), verdict (same, differs, unreadable), steps (compared and held),\n"
    "first (null, or step, stage, field, known (no, solved, stored), value_field, id, other_id, component, expected\n"
    "(recorded), actual, expected_bits, actual_bits, ulps, count), growth (list of step, field, count, ulps),\n"
    "message\n"
    "exit codes: 0 all are the same; 1 one differs; 2 one is unreadable or missing, or none was given; 3 the system\n"
    "failed (disk, memory)",
    run,
};
