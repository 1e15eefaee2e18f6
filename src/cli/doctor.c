/*
 * rheolog doctor: reads from a recording where, when and why the run went bad. Only the chain of causes at the end simulates, a
 * few steps (doctor_why.c).
 */
#include "cli/cure.h"

#include <math.h>
#include <string.h>

#include "cli/doctor_why.h"
#include "cli/provenance.h"
#include "cli/shell.h"

static const char *verdict_of(const rheo_diagnosis *d)
{
    return d->healthy ? "healthy" : "unhealthy";
}

/* ---- JSON ---- */

static void write_name(rheo__json *json, const char *key, const char *name)
{
    rheo__json_text(json, key, name && name[0] ? name : NULL);
}

/* The measure that has this value at the particle or spring of a finding. */
static void write_seen(rheo__json *json, const rheo_finding *f)
{
    write_name(json, "seen", f->seen);
    rheo__json_known_integer(json, "seen_step", f->seen[0], f->seen_step);
    rheo__json_number(json, "seen_value", f->seen[0] ? f->seen_value : NAN);
}

static void write_finding(rheo__json *json, const rheo_finding *f)
{
    rheo__json_begin_object(json, NULL);
    rheo__json_integer(json, "step", f->step);
    write_name(json, "measure", f->measure);
    write_name(json, "stage", f->stage);
    rheo__json_index(json, "id", f->id);
    rheo__json_index(json, "other_id", f->other_id);
    write_seen(json, f);
    rheo__json_number(json, "value", f->value);
    rheo__json_number(json, "limit", f->limit);
    rheo__json_number(json, "peak", f->peak);
    rheo__json_integer(json, "peak_step", f->peak_step);
    rheo__json_integer(json, "steps", f->steps);
    rheo__json_bool(json, "severe", f->severe);
    rheo__json_end_object(json);
}

/* Writes the first finding; all members are null if the run is healthy. */
static void write_cause(rheo__json *json, const rheo_diagnosis *d)
{
    static const char *const KEYS[] = {"step",  "stage",          "id",   "other_id",  "measure",   "value",
                                       "limit", "unhealthy_step", "seen", "seen_step", "seen_value"};
    const rheo_finding *c = &d->cause;
    if (d->healthy) {
        for (size_t i = 0; i < sizeof KEYS / sizeof *KEYS; i++)
            rheo__json_null(json, KEYS[i]);
        return;
    }
    rheo__json_integer(json, "step", c->step);
    write_name(json, "stage", c->stage);
    rheo__json_index(json, "id", c->id);
    rheo__json_index(json, "other_id", c->other_id);
    write_name(json, "measure", c->measure);
    rheo__json_number(json, "value", c->value);
    rheo__json_number(json, "limit", c->limit);
    rheo__json_integer(json, "unhealthy_step", d->unhealthy_step);
    write_seen(json, c);
}

static void print_json(const char *file, const cli_doctor_case *c, const cli_doctor_chain *chain)
{
    const rheo_diagnosis *d = c->diagnosis;
    rheo__json json = {.file = stdout};
    rheo__json_begin_object(&json, NULL);
    rheo__json_text(&json, "file", file);
    rheo__json_text(&json, "verdict", verdict_of(d));
    write_cause(&json, d);
    write_name(&json, "why", d->why);
    cli_failure_json(&json, d->failed, &d->failure, "location", NULL);
    rheo__json_integer(&json, "first_step", d->first_step);
    rheo__json_integer(&json, "last_step", d->last_step);
    rheo__json_bool(&json, "complete", d->complete);
    rheo__json_known_integer(&json, "sign_step", !d->healthy, d->sign_step);
    rheo__json_bool(&json, "ill_from_start", d->ill_from_start);
    rheo__json_begin_list(&json, "suspects");
    for (uint32_t i = 0; i < d->suspect_count && i < RHEO_MAX_SUSPECTS; i++) {
        rheo__json_begin_object(&json, NULL);
        rheo__json_integer(&json, "step", d->suspects[i].step);
        rheo__json_text(&json, "text", d->suspects[i].text);
        rheo__json_end_object(&json);
    }
    rheo__json_end_list(&json);
    rheo__json_bool(&json, "being_written", d->being_written);
    rheo__json_begin_list(&json, "findings");
    for (uint32_t i = 0; i < d->finding_count; i++)
        write_finding(&json, &d->findings[i]);
    rheo__json_end_list(&json);
    rheo__json_begin_list(&json, "advice");
    for (uint32_t i = 0; i < d->advice_count; i++) {
        if (!cli_cure_possible(c, &d->advice[i]))
            continue;
        rheo__json_begin_object(&json, NULL);
        rheo__json_text(&json, "text", d->advice[i].text);
        write_name(&json, "set", d->advice[i].set);
        char command[CLI_COMMAND_LINE];
        rheo__json_text(&json, "command", cli_cure(c, &d->advice[i], command, sizeof command) ? command : NULL);
        rheo__json_end_object(&json);
    }
    rheo__json_end_list(&json);
    cli_doctor_chain_json(&json, chain);
    rheo__json_end_object(&json);
}

static void print_unreadable(const char *file, const char *why)
{
    rheo__json json = {.file = stdout};
    rheo__json_begin_object(&json, NULL);
    rheo__json_text(&json, "file", file);
    rheo__json_text(&json, "verdict", "unreadable");
    rheo__json_null(&json, "step");
    rheo__json_null(&json, "stage");
    rheo__json_null(&json, "id");
    rheo__json_text(&json, "why", why);
    rheo__json_end_object(&json);
}

/* ---- Text ---- */

static void print_findings(const rheo_diagnosis *d)
{
    if (d->finding_count)
        puts(d->healthy ? "notices, first step out of range first:" : "measures out of range, first step first:");
    for (uint32_t i = 0; i < d->finding_count; i++) {
        const rheo_finding *f = &d->findings[i];
        char text[256], peak[32], also[128] = "";
        rheo_finding_text(f, text, sizeof text);
        if (f->steps > 1)
            snprintf(also, sizeof also, "  (%llu steps, up to %s in step %llu)", (unsigned long long)f->steps,
                     rheo_number_brief(f->peak, 3, peak), (unsigned long long)f->peak_step);
        cli_print(stdout, 14, "  step %-6llu %-25s %s%s\n", (unsigned long long)f->step, f->measure, text, also);
    }
}

static void print_look(const char *file, const rheo_diagnosis *d)
{
    const rheo_finding *c = &d->cause;
    const uint64_t seen = c->seen[0] ? c->seen_step : c->step;
    const unsigned long long at = seen <= d->last_step ? seen : d->last_step;
    puts("look closer:");
    cli_print_command("  rheolog inspect", file);
    printf(" --step %llu", at);
    if (c->other_id >= 0)
        printf(" --spring %lld:%lld", (long long)c->id, (long long)c->other_id);
    else if (c->id >= 0)
        printf(" --particle %lld", (long long)c->id);
    putchar('\n');
    if (!d->ill_from_start && c->step > d->first_step) { /* there is a good state before it */
        cli_print_command("  rheolog checkpoint", file);
        printf(" --step %llu -o before.rlog\n", (unsigned long long)c->step - 1);
    }
    cli_print_command("  rheolog log", file);
    putchar('\n');
}

/* Commands are never wrapped, so that people can copy them. */
static void print_advice(const cli_doctor_case *c)
{
    const rheo_diagnosis *d = c->diagnosis;
    bool any = false;
    for (uint32_t i = 0; i < d->advice_count; i++) {
        char command[CLI_COMMAND_LINE];
        const rheo_advice *a = &d->advice[i];
        const char *how = !a->set[0] || a->can_continue ? ""
                          : d->suspect_count            ? "give the command again after setting "
                                                        : "make the scene again with ";
        if (!cli_cure_possible(c, a))
            continue;
        if (!any)
            puts("what helps (numbers are estimates from the recorded metrics):");
        any = true;
        cli_print(stdout, 4, "  %s%s%s%s\n", how, a->set, a->set[0] ? ": " : "", a->text);
        if (cli_cure(c, a, command, sizeof command))
            printf("    %s\n", command);
    }
}

static void print_text(const char *file, const cli_doctor_case *c, cli_doctor_chain *chain)
{
    const rheo_diagnosis *d = c->diagnosis;
    cli_print(stdout, 4, "%s: %s\n", file, d->why); /* the message begins with the verdict */
    print_findings(d);
    if (d->healthy)
        return;
    print_advice(c);
    print_look(file, d);
    fflush(stdout); /* the chain may take seconds */
    cli_doctor_chain_follow(c->recording, chain);
    cli_doctor_chain_text(file, chain);
}

/* ---- The command ---- */

/* `brief`: one line, as one of several recordings. */
static int examine(const char *file, bool json, bool brief)
{
    rheo_error error = {""};
    if (!cli_is_file(file, &error)) {
        if (json)
            print_unreadable(file, error.message);
        return cli_fail(CLI_BAD, "%s", error.message);
    }
    rheo_recording *recording = NULL;
    rheo_result result = rheo_recording_open(file, &recording, &error);
    const bool opened = result == RHEO_OK;
    rheo_diagnosis d;
    if (opened)
        result = rheo_recording_check(recording, &error); /* the diagnosis reads no states */
    if (result == RHEO_OK)
        result = rheo_diagnose(recording, &d, &error);
    if (json && cli_code(result) == CLI_BAD)
        print_unreadable(file, error.message);
    if (result != RHEO_OK) {
        rheo_recording_close(recording);
        return opened ? cli_file_error(file, result, &error) : cli_error(result, &error);
    }
    const cli_doctor_case c = {file, recording, &d};
    cli_doctor_chain chain;
    cli_doctor_chain_begin(recording, &d, &chain);
    if (json)
        cli_doctor_chain_follow(recording, &chain);
    if (json)
        print_json(file, &c, &chain);
    else if (brief)
        cli_print(stdout, 4, "%s: %s\n", file, d.why);
    else
        print_text(file, &c, &chain);
    if (!json && !brief)
        cli_emitters_text(rheo_recording_definition(recording));
    if (!d.complete)
        cli_warn_incomplete(file, recording);
    rheo_recording_close(recording);
    return !d.healthy ? CLI_DIFFERS : d.complete ? CLI_DONE : CLI_BAD;
}

static int run(int argc, char **argv)
{
    bool json = false;
    const cli_option options[] = {
        {"--json", NULL, NULL, CLI_FLAG, &json},
        {0},
    };
    const int status = cli_parse(&cli_doctor, options, &argc, argv);
    if (status != CLI_GO_ON)
        return status;
    if (argc == 0)
        return cli_usage(&cli_doctor, "needs at least one recording");
    int worst = CLI_DONE;
    for (int i = 0; i < argc; i++) {
        const int code = examine(argv[i], json, argc > 1);
        worst = code > worst ? code : worst;
    }
    return worst;
}

static const char help[] = {
#include "cli/help/doctor.txt.inc"
    0};

const cli_command cli_doctor = {"doctor", help, run};
