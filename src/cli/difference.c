/* Prints differences for verify, diff and bless, and failures for info, inspect and doctor. */
#include "cli/cli.h"

#include <math.h>
#include <string.h>

const char *cli_verdict_name(rheo_verdict verdict)
{
    static const char *const NAMES[] = {"not compared", "same", "differs", "unreadable"};
    return NAMES[verdict];
}

/* The largest difference, absolute and relative to the field's largest value. */
static void write_sizes(rheo__json *json, double largest, double scale)
{
    rheo__json_number(json, "largest", largest);
    rheo__json_number(json, "relative", scale > 0 ? largest / scale : (double)NAN);
}

/* Writes the values of a difference; all are null if they are not known. */
static void write_values(rheo__json *json, const rheo_difference *d)
{
    static const char *const KEYS[] = {
        "value_step",    "value_field", "id",   "other_id", "component", "expected", "actual",
        "expected_bits", "actual_bits", "ulps", "count",    "largest",   "relative"};
    if (d->origin == RHEO_VALUES_NONE) {
        for (size_t i = 0; i < sizeof KEYS / sizeof *KEYS; i++)
            rheo__json_null(json, KEYS[i]);
        return;
    }
    char bits[32];
    rheo__json_integer(json, "value_step", d->value_step);
    rheo__json_text(json, "value_field", d->value_field);
    rheo__json_integer(json, "id", d->id);
    rheo__json_known_integer(json, "other_id", d->other_id > 0, d->other_id); /* the larger of two ids is never 0 */
    rheo__json_integer(json, "component", d->component);
    rheo__json_number(json, "expected", d->only_actual ? (double)NAN : d->expected);
    rheo__json_number(json, "actual", d->only_expected ? (double)NAN : d->actual);
    snprintf(bits, sizeof bits, "0x%llx", (unsigned long long)d->expected_bits);
    rheo__json_text(json, "expected_bits", d->only_actual ? NULL : bits);
    snprintf(bits, sizeof bits, "0x%llx", (unsigned long long)d->actual_bits);
    rheo__json_text(json, "actual_bits", d->only_expected ? NULL : bits);
    rheo__json_known_integer(json, "ulps", d->ulps != UINT64_MAX, d->ulps);
    rheo__json_integer(json, "count", d->count);
    write_sizes(json, d->largest, d->scale);
}

void cli_difference_json(rheo__json *json, const char *key, const rheo_difference *d)
{
    static const char *const ORIGIN[] = {"no", "simulated", "solved", "stored"};
    rheo__json_begin_object(json, key);
    rheo__json_integer(json, "step", d->step);
    rheo__json_text(json, "stage", d->stage);
    rheo__json_text(json, "field", d->field);
    rheo__json_text(json, "origin", ORIGIN[d->origin]);
    write_values(json, d);
    rheo__json_end_object(json);
}

void cli_verification_json(rheo__json *json, const rheo_verification *v)
{
    rheo__json_text(json, "verdict", cli_verdict_name(v->verdict));
    rheo__json_integer(json, "steps", v->steps);
    if (v->verdict == RHEO_DIFFERS)
        cli_difference_json(json, "first", &v->first);
    else
        rheo__json_null(json, "first");
    rheo__json_begin_list(json, "growth");
    for (uint32_t i = 0; i < v->growth_count; i++) {
        rheo__json_begin_object(json, NULL);
        rheo__json_integer(json, "step", v->growth[i].step);
        rheo__json_text(json, "field", v->growth[i].field);
        rheo__json_integer(json, "count", v->growth[i].count);
        rheo__json_integer(json, "ulps", v->growth[i].ulps);
        write_sizes(json, v->growth[i].largest, v->growth[i].scale);
        rheo__json_end_object(json);
    }
    rheo__json_end_list(json);
    rheo__json_text(json, "message", v->message);
    rheo__json_begin_list(json, "builds");
    for (int i = 0; i < 2 && v->build[i][0]; i++)
        rheo__json_text(json, NULL, v->build[i]);
    rheo__json_end_list(json);
}

void cli_lengths_json(rheo__json *json, const rheo_verification *v)
{
    static const char *const KEYS[] = {"a_steps", "b_steps"};
    rheo__json_bool(json, "lengths_differ", v->lengths_differ);
    for (int i = 0; i < 2; i++) {
        rheo__json_begin_list(json, KEYS[i]);
        rheo__json_integer(json, NULL, v->first_step[i]);
        rheo__json_integer(json, NULL, v->last_step[i]);
        rheo__json_end_list(json);
    }
}

void cli_accept_lengths(rheo_verification *v)
{
    char text[sizeof v->message];
    if (!v->lengths_differ)
        return;
    snprintf(text, sizeof text, "same, as far as both go%s", v->message + strcspn(v->message, ":"));
    memcpy(v->message, text, sizeof text);
    v->verdict = RHEO_SAME;
}

/* Prints one line per step: how many items of each field differ, and by how much. */
void cli_growth_text(const rheo_verification *v)
{
    char line[2048];
    size_t length = 0;
    if (v->growth_count)
        cli_print(
            stdout, 4,
            "  how it grows (items that differ at the end of the step; the largest difference, and its ratio to the "
            "field's largest value):\n");
    for (uint32_t i = 0; i < v->growth_count; i++) {
        const rheo_growth *g = &v->growth[i];
        const bool begins = i == 0 || g->step != v->growth[i - 1].step;
        const bool ends = i + 1 == v->growth_count || g->step != v->growth[i + 1].step;
        if (begins)
            length = (size_t)snprintf(line, sizeof line, "    step %llu:", (unsigned long long)g->step);
        length += (size_t)snprintf(line + length, sizeof line - length, "%s %s %llu", begins ? "" : ",", g->field,
                                   (unsigned long long)g->count);
        if (g->largest > 0 && g->scale > 0)
            length += (size_t)snprintf(line + length, sizeof line - length, " (%.2g, %.1g)", g->largest,
                                       g->largest / g->scale);
        if (ends || length > sizeof line - 128) { /* a field takes less than that */
            cli_print(stdout, 6, "%s\n", line);
            length = 0;
        }
    }
}

void cli_print_particle(const rheo_difference *d)
{
    const bool of_spring = d->location == RHEO_LOCATION_SPRING, of_both = !d->only_expected && !d->only_actual;
    if (d->origin != RHEO_VALUES_NONE && (of_spring || (d->location == RHEO_LOCATION_PARTICLE && of_both)))
        printf(" --particle %llu", (unsigned long long)d->id);
}

/* ---- Failures ---- */

void cli_failure_json(rheo__json *json, bool failed, const rheo_failure *f, const char *location_key,
                      const char *message)
{
    if (!failed) {
        rheo__json_null(json, "failure");
        return;
    }
    rheo__json_begin_object(json, "failure");
    rheo__json_integer(json, "step", f->step);
    rheo__json_text(json, "stage", f->stage[0] ? f->stage : NULL);
    rheo__json_text(json, "field", f->field);
    rheo__json_text(json, location_key, rheo_item_name(f->location));
    rheo__json_integer(json, "id", f->id);
    rheo__json_integer(json, "component", f->component);
    rheo__json_text(json, "reason", rheo_failure_reason_name(f->reason));
    rheo__json_number(json, "required", f->required != 0 ? f->required : (double)NAN);
    rheo__json_number(json, "limit", f->limit != 0 ? f->limit : (double)NAN);
    if (message)
        rheo__json_text(json, "message", message);
    rheo__json_end_object(json);
}
