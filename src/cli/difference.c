/* What verify, diff and bless print of a difference. */
#include "cli/cli.h"

#include <string.h>

#include "cli/scene_json.h"

const char *cli_verdict_name(rheo_verdict verdict)
{
    return verdict == RHEO_SAME ? "same" : verdict == RHEO_DIFFERS ? "differs" : "unreadable";
}

int cli_verdict_code(rheo_verdict verdict)
{
    return verdict == RHEO_SAME ? CLI_DONE : verdict == RHEO_DIFFERS ? CLI_DIFFERS : CLI_BAD;
}

static void print_key(const char *key, const char *value)
{
    printf("%s\": ", key);
    cli_json_string(stdout, value);
}

void cli_difference_json(const rheo_difference *d)
{
    static const char *const ORIGIN[] = {"no", "simulated", "solved", "stored"};
    printf("{\"step\": %llu, ", (unsigned long long)d->step);
    print_key("\"stage", d->stage);
    print_key(", \"field", d->field);
    print_key(", \"origin", ORIGIN[d->origin]);
    if (d->origin == RHEO_VALUES_NONE) {
        fputs(", \"value_field\": null, \"id\": null, \"other_id\": null, \"component\": null, \"expected\": null, "
              "\"actual\": null, \"expected_bits\": null, \"actual_bits\": null, \"ulps\": null, \"count\": null}",
              stdout);
        return;
    }
    print_key(", \"value_field", d->value_field);
    printf(", \"id\": %llu, \"other_id\": ", (unsigned long long)d->id);
    if (d->other_id) /* the larger of two ids is never 0 */
        printf("%llu", (unsigned long long)d->other_id);
    else
        fputs("null", stdout);
    printf(", \"component\": %u, \"expected\": ", (unsigned)d->component);
    cli_json_number(stdout, d->expected);
    fputs(", \"actual\": ", stdout);
    cli_json_number(stdout, d->actual);
    printf(", \"expected_bits\": \"0x%llx\", \"actual_bits\": \"0x%llx\", \"ulps\": ",
           (unsigned long long)d->expected_bits, (unsigned long long)d->actual_bits);
    if (d->ulps != UINT64_MAX)
        printf("%llu", (unsigned long long)d->ulps);
    else
        fputs("null", stdout);
    printf(", \"count\": %llu}", (unsigned long long)d->count);
}

void cli_verification_json(const rheo_verification *v)
{
    printf("\"verdict\": \"%s\", \"steps\": %llu, \"first\": ", cli_verdict_name(v->verdict),
           (unsigned long long)v->steps);
    if (v->verdict == RHEO_DIFFERS)
        cli_difference_json(&v->first);
    else
        fputs("null", stdout);
    fputs(", \"growth\": [", stdout);
    for (uint32_t i = 0; i < v->growth_count; i++) {
        const rheo_growth *g = &v->growth[i];
        printf("%s{\"step\": %llu, ", i ? ", " : "", (unsigned long long)g->step);
        print_key("\"field", g->field);
        printf(", \"count\": %llu, \"ulps\": %llu}", (unsigned long long)g->count, (unsigned long long)g->ulps);
    }
    print_key("], \"message", v->message);
}

/* A line a step: how many items of each field differ, and by how much. */
void cli_growth_text(const rheo_verification *v)
{
    if (v->growth_count)
        puts("  how it grows (items that differ at the end of the step, largest difference in ulps):");
    for (uint32_t i = 0; i < v->growth_count; i++) {
        const rheo_growth *g = &v->growth[i];
        if (i == 0 || g->step != v->growth[i - 1].step)
            printf("%s    step %llu:", i ? "\n" : "", (unsigned long long)g->step);
        else
            putchar(',');
        printf(" %s %llu", g->field, (unsigned long long)g->count);
        if (g->ulps)
            printf(" (%llu)", (unsigned long long)g->ulps);
    }
    if (v->growth_count)
        putchar('\n');
}
