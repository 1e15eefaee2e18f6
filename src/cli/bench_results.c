/*
 * Reads the lines of JSON that `rheolog bench --json` and `rheolog run --json` print, in this version and in older
 * ones. A program that is built without jansson needs it too, so this is a reader of its own: it looks for known keys
 * and skips all others.
 */
#include "cli/bench_results.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { DEEPEST = 8 };

typedef struct reader {
    const char *at;
    unsigned depth; /* of the object or list that is read */
    cli_bench_result *result;
    /* Members whose meaning depends on others. */
    char stage[32];          /* limits: stage of the line; run: of the element of "stages" */
    double median, substeps; /* limits: of the stage; table2: per step */
    bool per_substep;
} reader;

/* ---- Meaning ---- */

static void add_stage(cli_bench_result *r, const char *name, double ns)
{
    if (r->stages == CLI_BENCH_MAX_STAGES || isnan(ns))
        return;
    snprintf(r->stage[r->stages], sizeof r->stage[0], "%.31s", name);
    r->ns[r->stages++] = ns;
}

static void take_key(cli_bench_result *r, int key, const char *text)
{
    snprintf(r->key[key], sizeof r->key[key], "%.63s", text);
    r->has[key] = true;
}

static void take_text(reader *r, const char *name, const char *text)
{
    static const char *const keys[CLI_BENCH_KEYS] = {"case", "window", "kind", "scheme", "setting", "study"};
    if (r->depth > 1) {
        if (strcmp(name, "name") == 0)
            snprintf(r->stage, sizeof r->stage, "%.31s", text);
        return;
    }
    for (int k = 0; k < CLI_BENCH_KEYS; k++)
        if (strcmp(name, keys[k]) == 0)
            take_key(r->result, k, text);
    if (strcmp(name, "scene") == 0)
        take_key(r->result, CLI_BENCH_CASE, text);
    if (strcmp(name, "stage") == 0)
        snprintf(r->stage, sizeof r->stage, "%.31s", text);
    if (strcmp(name, "hash") == 0)
        snprintf(r->result->hash, sizeof r->result->hash, "%.23s", text);
    if (strcmp(name, "particles") == 0)
        snprintf(r->result->particles, sizeof r->result->particles, "%.23s", text);
}

/* Columns ns_... that are sums or statistics and no stages. */
static bool is_sum(const char *name)
{
    static const char *const sums[] = {"ns_least",         "ns_largest",
                                       "ns_substep_least", "ns_substep_largest",
                                       "ns_particle_step", "ns_without_history",
                                       "ns_history_part",  "ns_common",
                                       "ns_own",           "ns_per_particle_substep",
                                       "ns_limit",         "ns_step"};
    for (size_t i = 0; i < sizeof sums / sizeof *sums; i++)
        if (strcmp(name, sums[i]) == 0)
            return true;
    return false;
}

static void take_number(reader *r, const char *name, double number)
{
    if (r->depth > 1) {
        if (strcmp(name, "ns_per_particle_step") == 0)
            add_stage(r->result, r->stage, number);
    } else if (strcmp(name, "ns_median") == 0 || strcmp(name, "ns_particle_time") == 0 ||
               strcmp(name, "ns_per_particle_step") == 0) {
        r->median = number;
    } else if (strcmp(name, "us_time") == 0) {
        r->median = 1000 * number;
    } else if (strcmp(name, "ns_step") == 0) {
        r->median = isnan(r->median) ? number : r->median; /* a point of a study without a time step */
    } else if (strcmp(name, "ns_substep_median") == 0) {
        r->median = number;
        r->per_substep = true;
    } else if (strcmp(name, "substeps") == 0) {
        r->substeps = number;
    } else if (strncmp(name, "ns_", 3) == 0 && !is_sum(name)) {
        add_stage(r->result, name + 3, number);
    }
}

/* ---- Syntax ---- */

static void skip_blanks(reader *r)
{
    r->at += strspn(r->at, " \t\r");
}

static bool read_mark(reader *r, char mark)
{
    if (*r->at != mark)
        return false;
    r->at++;
    skip_blanks(r);
    return true;
}

static bool read_text(reader *r, char *text, size_t size)
{
    size_t n = 0;
    if (*r->at != '"')
        return false;
    for (r->at++; *r->at != '"'; r->at++) {
        if (*r->at == '\\' && r->at[1])
            r->at++;
        if (*r->at == 0 || *r->at == '\n')
            return false;
        if (n + 1 < size)
            text[n++] = *r->at;
    }
    r->at++;
    text[n] = 0;
    return true;
}

static bool read_value(reader *r, const char *name);

/* Reads an object or a list. The elements of a list have its name. */
static bool read_members(reader *r, const char *name)
{
    const char end = *r->at == '{' ? '}' : ']';
    if (r->depth == DEEPEST)
        return false;
    r->depth++;
    read_mark(r, *r->at);
    bool good = true;
    for (bool first = true; good && *r->at != end; first = false) {
        char member[64];
        snprintf(member, sizeof member, "%s", name);
        good = first || read_mark(r, ',');
        if (good && end == '}') {
            good = read_text(r, member, sizeof member);
            skip_blanks(r);
            good = good && read_mark(r, ':');
        }
        good = good && read_value(r, member);
        skip_blanks(r);
    }
    r->depth--;
    r->at += good;
    return good;
}

static bool read_value(reader *r, const char *name)
{
    char text[128];
    if (*r->at == '{' || *r->at == '[')
        return read_members(r, name);
    if (*r->at == '"') {
        if (!read_text(r, text, sizeof text))
            return false;
        take_text(r, name, text);
        return true;
    }
    const size_t length = strspn(r->at, "+-.0123456789abcdefghijklmnopqrstuvwxyzE");
    if (length == 0 || length >= sizeof text)
        return false;
    snprintf(text, sizeof text, "%.*s", (int)length, r->at);
    r->at += length;
    char *end;
    const double number = strtod(text, &end);
    if (*end == 0 && strchr("-0123456789", text[0])) {
        take_number(r, name, number);
        take_text(r, name, text); /* numbers may tell cases apart */
        return true;
    }
    return strcmp(text, "null") == 0 || strcmp(text, "true") == 0 || strcmp(text, "false") == 0;
}

/* ---- Lines ---- */

/* Completes a case whose time of the whole step is known. */
static void complete(reader *r)
{
    cli_bench_result *result = r->result;
    result->total = r->median;
    if (r->per_substep) {
        for (uint32_t s = 0; s < result->stages; s++)
            result->ns[s] *= r->substeps;
        result->total *= r->substeps;
    }
    if (result->stages && strcmp(result->stage[result->stages - 1], "rest") != 0) {
        double rest = result->total;
        for (uint32_t s = 0; s < result->stages; s++)
            rest -= result->ns[s];
        add_stage(result, "rest", rest);
    }
}

bool cli_bench_read_results(const char *text, cli_bench_results *results, char wrong[64])
{
    for (const char *line = text; *line; line += strcspn(line, "\n"), line += *line == '\n') {
        cli_bench_result next = {.total = NAN};
        reader r = {.at = line, .result = &next, .median = NAN, .substeps = 1};
        snprintf(wrong, 64, "%.*s", (int)strcspn(line, "\n"), line);
        if (*line == '\n')
            continue;
        if (*line != '{' || !read_value(&r, "") || (*r.at && *r.at != '\n') ||
            (isnan(r.median) && !next.has[CLI_BENCH_STUDY]) ||
            !(next.has[CLI_BENCH_CASE] || next.has[CLI_BENCH_SETTING]))
            return false;
        /* error prints a line for each quantity of a setting, and points without a cost. */
        if (next.has[CLI_BENCH_STUDY] && (isnan(r.median) || cli_bench_find_result(results, &next)))
            continue;
        /* limits prints a line for each stage of a case. */
        cli_bench_result *last = results->count ? &results->item[results->count - 1] : NULL;
        if (r.stage[0] && next.stages == 0) {
            next.total = 0;
            if (last && cli_bench_find_result(&(cli_bench_results){1, last}, &next)) {
                add_stage(last, r.stage, r.median);
                last->total += r.median;
                continue;
            }
            add_stage(&next, r.stage, r.median);
            next.total = r.median;
        } else {
            complete(&r);
        }
        cli_bench_result *item = realloc(results->item, (results->count + 1) * sizeof *item);
        if (!item)
            return false;
        results->item = item;
        results->item[results->count++] = next;
    }
    snprintf(wrong, 64, "nothing");
    return results->count > 0;
}

const cli_bench_result *cli_bench_find_result(const cli_bench_results *results, const cli_bench_result *like)
{
    for (uint32_t i = 0; i < results->count; i++) {
        const cli_bench_result *r = &results->item[i];
        bool same = true;
        for (int k = 0; k < CLI_BENCH_KEYS; k++)
            same = same && (!r->has[k] || !like->has[k] || strcmp(r->key[k], like->key[k]) == 0);
        if (same)
            return r;
    }
    return NULL;
}

double cli_bench_result_stage(const cli_bench_result *result, const char *stage)
{
    for (uint32_t s = 0; s < result->stages; s++)
        if (strcmp(result->stage[s], stage) == 0)
            return result->ns[s];
    return NAN;
}
