/* What a run of a scene is expected to be like and to cost, as text and as JSON. */
#include "cli/preflight.h"

#include <math.h>
#include <stdarg.h>
#include <string.h>

int cli_preflight_find(const rheo_scene *scene, uint64_t steps, bool probe, cli_preflight *p)
{
    rheo_error error = {""};
    *p = (cli_preflight){.steps = steps, .probe = {0, 0, NAN, NAN, NAN, NAN, ""}};
    rheo_result result = rheo_scene_preflight(scene, &p->numbers, &error);
    if (result == RHEO_OK)
        result = rheo_scene_memory(scene, steps, &p->memory, &error);
    if (result != RHEO_OK)
        return cli_error(result, &error);
    if (probe && p->memory.particles)
        cli_probe_scene(scene, steps, p->memory.particles, &p->probe);
    return CLI_DONE;
}

/* ---- JSON ---- */

/* A number by its key. */
typedef struct item {
    const char *key;
    double value;
} item;

void cli_preflight_json(rheo__json *json, const cli_preflight *p)
{
    if (!p) {
        rheo__json_text(json, "preflight", NULL);
        return;
    }
    const rheo_preflight *n = &p->numbers;
    const item items[] = {{"kappa", n->kappa},
                          {"kappa_impact", n->kappa_impact},
                          {"kappa_limit", n->kappa_limit},
                          {"history_difference", n->history_difference},
                          {"pressure_number", n->pressure_number},
                          {"pressure_limit", n->pressure_limit},
                          {"near_pressure_number", n->near_pressure_number},
                          {"near_pressure_limit", n->near_pressure_limit},
                          {"substeps", n->substeps},
                          {"substeps_impact", n->substeps_impact},
                          {"substeps_probe", p->probe.substeps},
                          {"substep", n->substep},
                          {"ball_resolution", n->ball_resolution},
                          {"ball_speed", n->ball_speed},
                          {"ball_way", n->ball_way},
                          {"obstacle_speed", n->obstacle_speed},
                          {"obstacle_way", n->obstacle_way},
                          {"memory_steps", n->memory_steps},
                          {"memory_seconds", n->memory_seconds},
                          {"sound_speed", n->sound_speed},
                          {"jump_least", n->jump_least},
                          {"jump_most", n->jump_most},
                          {"bytes_memory", p->memory.all},
                          {"bytes_recording", p->probe.bytes},
                          {"seconds", p->probe.seconds},
                          {"ns_particle_step", p->probe.ns}};
    rheo__json_begin_object(json, "preflight");
    rheo__json_integer(json, "steps", p->steps);
    for (size_t i = 0; i < sizeof items / sizeof *items; i++)
        rheo__json_number(json, items[i].key, items[i].value);
    rheo__json_integer(json, "emitted", p->memory.emitted);
    rheo__json_text(json, "solver", n->solver);
    rheo__json_integer(json, "probe_steps", p->probe.steps);
    rheo__json_integer(json, "probe_particles", p->probe.particles);
    rheo__json_text(json, "probe_failed", p->probe.failed[0] ? p->probe.failed : NULL);
    rheo__json_end_object(json);
}

/* ---- Text ---- */

static bool known(double value)
{
    return value == value;
}

enum { LINE = 400, INDENT = 21 };

static void add(char line[LINE], const char *format, ...) __attribute__((format(printf, 2, 3)));

static void add(char line[LINE], const char *format, ...)
{
    const size_t length = strlen(line);
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(line + length, LINE - length, format, arguments);
    va_end(arguments);
}

static void begin(char line[LINE], const char *name)
{
    snprintf(line, LINE, "  %-*s", INDENT - 2, name);
}

static void end(const char line[LINE])
{
    cli_print(stdout, INDENT, "%s\n", line);
}

static void print_number(const char *name, double value, double limit)
{
    char line[LINE];
    if (!known(value))
        return;
    begin(line, name);
    add(line, "%.3g", value);
    if (known(limit))
        add(line, ", limit %.3g", limit);
    end(line);
}

static void print_thickening(const rheo_preflight *n)
{
    char line[LINE];
    begin(line, "kappa");
    add(line, "%.3g at rest", n->kappa);
    if (known(n->kappa_impact))
        add(line, ", %.3g when the ball arrives", n->kappa_impact);
    if (known(n->kappa_limit))
        add(line, ", limit %.3g", n->kappa_limit);
    if (known(n->kappa))
        end(line);
    print_number("k substep^2/h", n->pressure_number, n->pressure_limit);
    print_number("k_near substep^2/h", n->near_pressure_number, n->near_pressure_limit);
}

static void print_substeps(const cli_preflight *p)
{
    const rheo_preflight *n = &p->numbers;
    char line[LINE];
    begin(line, "substeps");
    add(line, "%.0f in the beginning", n->substeps);
    if (known(n->substeps_impact))
        add(line, ", %.0f when the ball arrives", n->substeps_impact);
    if (known(p->probe.substeps))
        add(line, ", %.3g in the probe", p->probe.substeps);
    add(line, "; %.3g T each", n->substep);
    if (known(n->substeps))
        end(line);
}

static void print_costs(const cli_preflight *p)
{
    char text[32], line[LINE];
    const unsigned long long steps = p->steps;
    cli_bytes(p->memory.all, text, sizeof text);
    begin(line, "bytes of memory");
    add(line, "%s", text);
    end(line);
    if (!p->probe.steps)
        return;
    cli_bytes(p->probe.bytes, text, sizeof text);
    begin(line, "recording");
    add(line, "%s for %llu step%s", text, steps, cli_plural(p->steps));
    end(line);
    cli_duration(p->probe.seconds, text, sizeof text);
    begin(line, "computing");
    add(line,
        "%s of processor time for %llu step%s: %.0f ns per particle and step, from a probe of %llu step%s of %u particle%s",
        text, steps, cli_plural(p->steps), p->probe.ns, (unsigned long long)p->probe.steps,
        cli_plural(p->probe.steps), p->probe.particles, cli_plural(p->probe.particles));
    end(line);
}

void cli_preflight_print(const cli_preflight *p)
{
    const rheo_preflight *n = &p->numbers;
    char line[LINE];
    puts("expected of a run:");
    print_thickening(n);
    print_substeps(p);
    if (known(n->ball_speed)) {
        begin(line, "ball");
        add(line, "radius of %.3g spacings; arrives with %.3g L/T, %.3g supports a step", n->ball_resolution,
            n->ball_speed, n->ball_way);
        end(line);
    }
    if (known(n->obstacle_speed)) {
        begin(line, "obstacles");
        add(line, "up to %.3g L/T, %.3g supports a step", n->obstacle_speed, n->obstacle_way);
        end(line);
    }
    if (known(n->memory_steps)) {
        begin(line, "memory of history");
        add(line, "%.0f step%s, %.3g T", n->memory_steps, cli_plural((uint64_t)n->memory_steps), n->memory_seconds);
        end(line);
    }
    if (known(n->sound_speed)) {
        begin(line, "sound");
        add(line, "%.3g L/T", n->sound_speed);
        end(line);
    }
    if (known(n->jump_most)) {
        begin(line, "jump number");
        add(line, "%.3g to %.3g, %s solver", n->jump_least, n->jump_most, n->solver);
        end(line);
    }
    if (p->memory.emitted) {
        begin(line, "emitters");
        add(line, "up to %llu particles more in %llu step%s", (unsigned long long)p->memory.emitted,
            (unsigned long long)p->steps, cli_plural(p->steps));
        end(line);
    }
    print_costs(p);
}

void cli_preflight_brief(const cli_preflight *p)
{
    const rheo_preflight *n = &p->numbers;
    char bytes[32], text[LINE] = "expected: ";
    cli_bytes(p->memory.all, bytes, sizeof bytes);
    if (known(n->kappa))
        add(text, "kappa %.2g", n->kappa);
    if (known(n->kappa_impact))
        add(text, " (%.2g when the ball arrives)", n->kappa_impact);
    if (known(n->pressure_number))
        add(text, ", k substep^2/h %.2g of %.2g, k_near %.2g of %.2g; ", n->pressure_number, n->pressure_limit,
            n->near_pressure_number, n->near_pressure_limit);
    if (known(n->jump_most))
        add(text, "jump number %.2g to %.2g, %s solver; ", n->jump_least, n->jump_most, n->solver);
    if (known(n->substeps))
        add(text, "%.0f substep%s", n->substeps, n->substeps > 1 ? "s" : "");
    if (known(n->ball_way))
        add(text, "; ball of %.2g spacings, %.2g supports a step", n->ball_resolution, n->ball_way);
    if (known(n->memory_seconds))
        add(text, "; memory %.3g T", n->memory_seconds);
    add(text, "; %s", bytes);
    cli_print(stderr, 4, "%s\n", text);
}
