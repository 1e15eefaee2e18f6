/*
 * Writes when the stages of a few steps began and ended, as trace events for Perfetto and chrome://tracing. Every case is a
 * process; its steps contain their substeps, and these their stages. Between stages the state is checked, which usual steps
 * do once in a substep, so there are gaps, and steps take longer than those that are measured.
 */
#include <stdlib.h>

#include "cli/bench.h"

enum { STEPS = 10 };

/* A run of a stage. */
typedef struct event {
    uint32_t item, stage;   /* case, and stage of its world */
    uint64_t step, substep; /* substep from 1; 0: the stage runs once in the step */
    double begin, seconds;
} event;

typedef struct trace {
    const cli_bench_cases *cases;
    event *event;
    size_t count, room;
} trace;

/* ---- Measuring ---- */

/* Adds an event; its time and substep come later. NULL: no memory. */
static event *add(trace *t)
{
    if (t->count == t->room) {
        const size_t room = t->room ? 2 * t->room : 1024;
        event *more = realloc(t->event, room * sizeof *more);
        if (!more)
            return NULL;
        t->event = more;
        t->room = room;
    }
    return &t->event[t->count++];
}

static double seconds_of(const rheo_world *world, uint32_t stage)
{
    rheo_stage_info info = {0};
    rheo_world_stage(world, stage, &info);
    return info.seconds;
}

static int trace_stage(trace *t, uint32_t item, rheo_world *world)
{
    rheo_error error = {""};
    double before[CLI_BENCH_MAX_STAGES];
    const uint64_t step = rheo_world_step_count(world) + 1;
    uint32_t stage;
    for (uint32_t s = 0; s < CLI_BENCH_MAX_STAGES; s++)
        before[s] = seconds_of(world, s);
    const double begin = cli_now();
    const rheo_result result = rheo_world_step_stage(world, &stage, &error);
    if (result != RHEO_OK)
        return cli_error(result, &error);
    event *e = add(t);
    if (!e)
        return cli_fail(CLI_SYSTEM, "no memory for a trace of %zu stages", t->count);
    *e = (event){.item = item,
                 .stage = stage,
                 .step = step,
                 .begin = begin,
                 .seconds = stage < CLI_BENCH_MAX_STAGES ? seconds_of(world, stage) - before[stage] : 0};
    return CLI_DONE;
}

/* Numbers the substeps of a step: a stage that runs more than once runs once in each. */
static void number_substeps(trace *t, size_t first)
{
    for (size_t i = first; i < t->count; i++) {
        uint64_t before = 0, after = 0;
        for (size_t k = first; k < t->count; k++) {
            before += k < i && t->event[k].stage == t->event[i].stage;
            after += k > i && t->event[k].stage == t->event[i].stage;
        }
        t->event[i].substep = before + after ? before + 1 : 0;
    }
}

static int trace_case(trace *t, uint32_t item, uint64_t steps)
{
    const cli_bench_case *c = &t->cases->item[item];
    cli_bench_run run;
    int status = cli_bench_begin_run(c, c->warm_up, &run);
    if (status != CLI_DONE)
        return status;
    for (uint64_t step = 0; step < steps && status == CLI_DONE; step++) {
        const size_t first = t->count;
        do
            status = trace_stage(t, item, run.world);
        while (status == CLI_DONE && rheo_world_stages_done(run.world) > 0);
        number_substeps(t, first);
    }
    cli_bench_end_run(&run);
    return status;
}

/* ---- The file ---- */

static void begin_event(rheo__json *json, const char *name, const char *kind, uint32_t item)
{
    rheo__json_begin_object(json, NULL);
    rheo__json_text(json, "name", name);
    rheo__json_text(json, "ph", kind);
    rheo__json_integer(json, "pid", item + UINT64_C(1));
    rheo__json_integer(json, "tid", 1);
}

static void put_process(rheo__json *json, const cli_bench_case *c, uint32_t item)
{
    char name[128];
    if (*c->scheme)
        snprintf(name, sizeof name, "%s, %s%s%s, d = %u", c->name, c->scheme, *c->kind ? ", " : "", c->kind,
                 c->window);
    else /* no other model has a history */
        snprintf(name, sizeof name, "%s", c->name);
    begin_event(json, "process_name", "M", item);
    rheo__json_begin_object(json, "args");
    rheo__json_text(json, "name", name);
    rheo__json_end_object(json);
    rheo__json_end_object(json);
}

/* From the beginning of the first to the end of the last event. */
static void put_span(rheo__json *json, const char *name, const char *category, const event *first, const event *last,
                     double origin)
{
    begin_event(json, name, "X", first->item);
    rheo__json_text(json, "cat", category);
    rheo__json_decimals(json, "ts", 3, 1e6 * (first->begin - origin));
    rheo__json_decimals(json, "dur", 3, 1e6 * (last->begin + last->seconds - first->begin));
    rheo__json_begin_object(json, "args");
    rheo__json_integer(json, "step", first->step);
    if (first->substep && first->substep == last->substep)
        rheo__json_integer(json, "substep", first->substep);
    rheo__json_end_object(json);
    rheo__json_end_object(json);
}

/* The last event of the step, or of the substep, that begins with an event. */
static size_t end_of(const trace *t, size_t first, bool substep)
{
    const event *e = &t->event[first];
    size_t last = first;
    while (last + 1 < t->count && t->event[last + 1].item == e->item && t->event[last + 1].step == e->step &&
           (!substep || t->event[last + 1].substep == e->substep))
        last++;
    return last;
}

static void put_events(rheo__json *json, const trace *t)
{
    char name[64];
    const event *e = t->event;
    for (size_t i = 0; i < t->count; i++) {
        const bool begins_step = i == 0 || e[i].item != e[i - 1].item || e[i].step != e[i - 1].step;
        if (begins_step) {
            snprintf(name, sizeof name, "step %llu", (unsigned long long)e[i].step);
            put_span(json, name, "step", &e[i], &e[end_of(t, i, false)], e[0].begin);
        }
        if (e[i].substep && (begins_step || e[i].substep != e[i - 1].substep)) {
            snprintf(name, sizeof name, "substep %llu", (unsigned long long)e[i].substep);
            put_span(json, name, "substep", &e[i], &e[end_of(t, i, true)], e[0].begin);
        }
        const cli_bench_case *c = &t->cases->item[e[i].item];
        put_span(json, e[i].stage < c->stages ? c->stage[e[i].stage] : "stage", "stage", &e[i], &e[i], e[0].begin);
    }
}

static void put_trace(FILE *file, const void *data)
{
    const trace *t = data;
    rheo__json json = {.file = file, .lines = 2};
    rheo__json_begin_object(&json, NULL);
    rheo__json_text(&json, "displayTimeUnit", "ns");
    rheo__json_begin_object(&json, "otherData");
    rheo__json_text(&json, "program", rheo_version());
    rheo__json_text(&json, "machine", cli_bench_machine());
    rheo__json_text(&json, "simd", rheo_simd());
    rheo__json_end_object(&json);
    rheo__json_begin_list(&json, "traceEvents");
    for (uint32_t i = 0; i < t->cases->count; i++)
        put_process(&json, &t->cases->item[i], i);
    put_events(&json, t);
    rheo__json_end_list(&json);
    rheo__json_end_object(&json);
}

int cli_bench_trace(const cli_bench_cases *cases, const cli_bench_arguments *a)
{
    trace t = {.cases = cases};
    int status = CLI_DONE;
    for (uint32_t i = 0; i < cases->count && status == CLI_DONE; i++)
        status = trace_case(&t, i, STEPS);
    if (status == CLI_DONE)
        status = cli_write_file(a->trace, put_trace, &t);
    free(t.event);
    return status;
}
