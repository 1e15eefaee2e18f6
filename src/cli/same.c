/* rheolog same: whether a recording whose bits this build does not reproduce still shows the same physics. */
#include "cli/cli.h"

#include <string.h>

typedef unsigned long long number;

typedef struct same {
    const char *file, *at_least, *limit, *simd;
    cli_number members, seed;
    cli_list set;
    bool self_check, keep_members, json;
    rheo_same_options options;
    rheo_same_result result;
} same;

/* ---- Text ---- */

static const char *yes(bool tried, bool passed)
{
    return !tried ? "not tried" : passed ? "yes" : "no";
}

static void print_ratio(const char *what, const rheo_same_ratio *r, const char *limit)
{
    char ratio[32];
    cli_print(stdout, 14, "; %s %s (limit %s): %s at step %llu%s%s", what, rheo_number_brief(r->ratio, 3, ratio),
              limit, r->field, (number)r->step, r->stage[0] ? ", first other stage " : "", r->stage);
}

static void print_steps(const char *name, const rheo_same_steps *s, double limit, const char *why_not)
{
    char text[32];
    rheo_number_brief(limit, 6, text);
    printf("  %-11s %s", name, yes(s->tried, s->passed));
    if (!s->tried) {
        puts(why_not);
        return;
    }
    printf(", %llu of %llu %s", (number)s->compared, (number)s->available,
           s->interval > 1 ? "ways from keyframe to keyframe" : "steps");
    if (s->decisions)
        printf(", decisions differ in %llu", (number)s->decisions);
    if (s->first.field[0])
        print_ratio("first beyond the limit", &s->first, text);
    else if (s->worst.field[0])
        print_ratio("largest ratio", &s->worst, text);
    putchar('\n');
}

static void print_metric(const rheo_same_metric *m)
{
    char was[32], is[32], shift[32], p[32];
    printf("    %s: %s, now %s %s; %s standard deviations, p = %s%s\n", m->name,
           rheo_number_brief(m->mean[0], 6, was), rheo_number_brief(m->mean[1], 6, is), m->unit,
           rheo_number_brief(m->shift, 3, shift), rheo_number_brief(m->p, 3, p), m->rejected ? ", differs" : "");
}

/* The rejected values, or the one nearest to it. */
static void print_statistics(const rheo_same_statistics *s)
{
    enum { MOST = 8 };
    printf("  %-11s %s", "statistics", yes(s->tried, s->passed));
    if (!s->tried) {
        putchar('\n');
        return;
    }
    printf(", %u recorded members%s and %u of this build, %u values, %u left out, %u differ\n", s->members[0],
           s->stored ? " (stored)" : "", s->members[1], s->metric_count, s->left_out, s->rejected);
    char moved[32];
    if (s->moved > 0)
        printf("    members begin with coordinates that are moved by up to %s of the spacing\n",
               rheo_number_brief(s->moved, 3, moved));
    else
        puts("    members begin with coordinates that are moved by 1 ulp");
    if (s->too_early)
        puts("    too early: the spread of the members still grows at the end of the recording");
    if (s->went_bad)
        cli_print(stdout, 4, "    %s\n", s->why);
    const uint32_t stored = s->metric_count < RHEO_MOST_SAME_METRICS ? s->metric_count : RHEO_MOST_SAME_METRICS;
    for (uint32_t i = 0; i < stored && i < MOST && (i == 0 || s->metrics[i].rejected); i++)
        print_metric(&s->metrics[i]);
    if (s->self_checks)
        printf("    self-check: %llu false alarms in %llu comparisons of one program with itself\n",
               (number)s->false_alarms, (number)s->self_checks);
}

static void print_text(const same *a)
{
    const rheo_same_result *r = &a->result;
    cli_print(stdout, 4, "%s: %s\n", a->file, r->message);
    printf("  %-11s %s", "bits", yes(r->bits_tried, r->bits_passed));
    if (r->bits_tried)
        printf(", %llu step%s with the recorded hashes", (number)r->bits_steps, cli_plural(r->bits_steps));
    putchar('\n');
    const bool tried = !r->bits_passed && a->options.at_least <= RHEO_SAMENESS_ROUNDING;
    print_steps("rounding", &r->rounding, a->options.limit,
                tried ? ": the recording has no states near enough (--full has all)" : "");
    print_steps("step", &r->step, 1,
                tried && !r->rounding.passed && a->options.at_least <= RHEO_SAMENESS_STEP
                    ? ": it takes the state of every step, and a memory without modes"
                    : "");
    print_statistics(&r->statistics);
}

/* ---- JSON ---- */

static void ratio_json(rheo__json *json, const char *key, const rheo_same_ratio *r)
{
    if (!r->field[0]) {
        rheo__json_null(json, key);
        return;
    }
    rheo__json_begin_object(json, key);
    rheo__json_text(json, "field", r->field);
    rheo__json_integer(json, "step", r->step);
    rheo__json_text(json, "stage", r->stage[0] ? r->stage : NULL);
    rheo__json_number(json, "ratio", r->ratio);
    rheo__json_number(json, "rms", r->rms);
    rheo__json_number(json, "rms_yardstick", r->rms_yardstick);
    rheo__json_number(json, "largest", r->largest);
    rheo__json_number(json, "largest_yardstick", r->largest_yardstick);
    rheo__json_end_object(json);
}

static void steps_json(rheo__json *json, const char *key, const rheo_same_steps *s)
{
    rheo__json_begin_object(json, key);
    rheo__json_bool(json, "tried", s->tried);
    rheo__json_bool(json, "passed", s->passed);
    rheo__json_integer(json, "interval", s->interval);
    rheo__json_integer(json, "available", s->available);
    rheo__json_integer(json, "compared", s->compared);
    rheo__json_integer(json, "decisions", s->decisions);
    ratio_json(json, "worst", &s->worst);
    ratio_json(json, "first", &s->first);
    rheo__json_end_object(json);
}

static void metric_json(rheo__json *json, const rheo_same_metric *m)
{
    rheo__json_begin_object(json, NULL);
    rheo__json_text(json, "name", m->name);
    rheo__json_text(json, "unit", m->unit);
    rheo__json_vector(json, "mean", m->mean, 2);
    rheo__json_vector(json, "deviation", m->deviation, 2);
    rheo__json_number(json, "shift", m->shift);
    rheo__json_number(json, "p", m->p);
    rheo__json_bool(json, "rejected", m->rejected);
    rheo__json_end_object(json);
}

static void statistics_json(rheo__json *json, const rheo_same_statistics *s, bool self_check)
{
    rheo__json_begin_object(json, "statistics");
    rheo__json_bool(json, "tried", s->tried);
    rheo__json_bool(json, "passed", s->passed);
    rheo__json_bool(json, "stored", s->stored);
    rheo__json_integer(json, "members_recorded", s->members[0]);
    rheo__json_integer(json, "members", s->members[1]);
    rheo__json_number(json, "moved", s->moved);
    rheo__json_integer(json, "values", s->metric_count);
    rheo__json_integer(json, "left_out", s->left_out);
    rheo__json_integer(json, "rejected", s->rejected);
    rheo__json_bool(json, "too_early", s->too_early);
    rheo__json_text(json, "went_bad", s->went_bad ? s->why : NULL);
    rheo__json_begin_list(json, "metrics");
    for (uint32_t i = 0; i < s->metric_count && i < RHEO_MOST_SAME_METRICS; i++)
        metric_json(json, &s->metrics[i]);
    rheo__json_end_list(json);
    rheo__json_known_integer(json, "self_checks", self_check, s->self_checks);
    rheo__json_known_integer(json, "false_alarms", self_check, s->false_alarms);
    rheo__json_end_object(json);
}

static void print_json(const same *a, int status)
{
    const rheo_same_result *r = &a->result;
    rheo__json json = {.file = stdout};
    rheo__json_begin_object(&json, NULL);
    rheo__json_text(&json, "file", a->file);
    rheo__json_text(&json, "verdict", rheo_sameness_name(r->verdict));
    rheo__json_text(&json, "at_least", rheo_sameness_name(a->options.at_least));
    rheo__json_bool(&json, "passed", status == CLI_DONE);
    rheo__json_text(&json, "message", r->message[0] ? r->message : cli_said());
    rheo__json_begin_object(&json, "bits");
    rheo__json_bool(&json, "tried", r->bits_tried);
    rheo__json_bool(&json, "passed", r->bits_passed);
    rheo__json_integer(&json, "steps", r->bits_steps);
    rheo__json_end_object(&json);
    steps_json(&json, "rounding", &r->rounding);
    steps_json(&json, "step", &r->step);
    statistics_json(&json, &r->statistics, a->self_check);
    rheo__json_end_object(&json);
}

/* ---- The command ---- */

int cli_read_sameness(const cli_command *command, const char *text, rheo_sameness *sameness)
{
    *sameness = rheo_sameness_by_name(text);
    return *sameness != RHEO_SAMENESS_UNKNOWN
               ? CLI_DONE
               : cli_usage(command, "--at-least needs bits, rounding, step, statistics or differs; got \"%s\"", text);
}

static int read_options(same *a)
{
    a->options = rheo_default_same_options();
    if (a->at_least) {
        const int status = cli_read_sameness(&cli_same, a->at_least, &a->options.at_least);
        if (status != CLI_DONE)
            return status;
    }
    if (a->limit) {
        const char *end;
        a->options.limit = rheo_text_number(a->limit, &end);
        if (end == a->limit || *end || !(a->options.limit >= 1 && a->options.limit <= 1e6))
            return cli_usage(&cli_same, "--limit needs a number from 1 to 1000000; got \"%s\"", a->limit);
    }
    if (a->members.given) {
        if (a->members.value < RHEO_LEAST_SAME_MEMBERS || a->members.value > RHEO_MOST_SAME_MEMBERS)
            return cli_usage(&cli_same, "--members needs %d to %d; got %llu", RHEO_LEAST_SAME_MEMBERS,
                             RHEO_MOST_SAME_MEMBERS, (number)a->members.value);
        a->options.members = (uint32_t)a->members.value;
    }
    if (a->seed.given)
        a->options.seed = a->seed.value;
    a->options.set = a->set.item;
    a->options.set_count = (uint32_t)a->set.count;
    a->options.self_check = a->self_check;
    for (size_t i = 0; i < a->set.count; i++) {
        char key[64];
        const char *value;
        const int status = cli_split_setting(&cli_same, a->set.item[i], key, sizeof key, &value);
        if (status != CLI_DONE)
            return status;
    }
    return CLI_DONE;
}

static int compare(same *a)
{
    rheo_error error = {""};
    cli_watch_signals();
    cli_watch_name(a->file);
    const rheo_result result = rheo_same(a->file, &a->options, &a->result, &error);
    cli_watch_end();
    if (result != RHEO_OK)
        return cli_error(result, &error);
    if (!a->json)
        print_text(a);
    return a->result.verdict >= a->options.at_least ? CLI_DONE : CLI_DIFFERS;
}

/* Makes the members and keeps them in the file, instead of comparing. */
static int keep_members(const same *a)
{
    rheo_error error = {""};
    cli_watch_signals();
    cli_watch_name(a->file);
    const rheo_result result = rheo_same_keep_members(a->file, a->options.members, a->options.seed, &error);
    cli_watch_end();
    if (result != RHEO_OK)
        return cli_error(result, &error);
    if (!a->json)
        printf("%s: keeps %u members\n", a->file, a->options.members);
    return CLI_DONE;
}

static void print_kept_json(const same *a, int status)
{
    rheo__json json = {.file = stdout};
    rheo__json_begin_object(&json, NULL);
    rheo__json_text(&json, "file", a->file);
    rheo__json_known_integer(&json, "members", status == CLI_DONE, a->options.members);
    rheo__json_text(&json, "message", status == CLI_DONE ? NULL : cli_said());
    rheo__json_end_object(&json);
}

static int run(int argc, char **argv)
{
    same a = {.file = NULL};
    const cli_option options[] = {
        {"--at-least", NULL, "RUNG", CLI_TEXT, &a.at_least},
        {"--set", NULL, "KEY=VALUE", CLI_LIST, &a.set},
        {"--limit", NULL, "X", CLI_TEXT, &a.limit},
        {"--members", NULL, "N", CLI_NUMBER, &a.members},
        {"--seed", NULL, "N", CLI_NUMBER, &a.seed},
        {"--self-check", NULL, NULL, CLI_FLAG, &a.self_check},
        {"--keep-members", NULL, NULL, CLI_FLAG, &a.keep_members},
        {"--simd", NULL, "NAME", CLI_TEXT, &a.simd},
        {"--json", NULL, NULL, CLI_FLAG, &a.json},
        {0},
    };
    int status = cli_parse(&cli_same, options, &argc, argv);
    if (status != CLI_GO_ON)
        return status;
    if (argc != 1)
        return cli_usage(&cli_same, "needs one golden recording; got %d", argc);
    a.file = argv[0];
    if (a.keep_members && (a.at_least || a.limit || a.set.count || a.self_check))
        return cli_usage(&cli_same,
                         "--keep-members keeps runs of this build and compares nothing, so only --members and "
                         "--seed go with it");
    if ((status = read_options(&a)) == CLI_DONE && (status = cli_use_simd(a.simd)) == CLI_DONE &&
        (status = cli_check_recording(a.file)) == CLI_DONE)
        status = a.keep_members ? keep_members(&a) : compare(&a);
    if (a.json && a.keep_members)
        print_kept_json(&a, status);
    else if (a.json)
        print_json(&a, status);
    return status;
}

static const char help[] = {
#include "cli/help/same.txt.inc"
    0};

const cli_command cli_same = {"same", help, run};
