/*
 * Chooses the states of a page by its budget: stages of the step that the page looks at first, then ends of steps, denser near the
 * steps that it looks at. What does not fit is left out.
 */
#include "cli/report.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli/steps.h"

enum { FRAME_JSON = 220, ARRAY_JSON = 64 }; /* bytes of a frame and of each of its arrays in JSON, about */
enum { DETAILED_FRAMES = 40 };              /* that may have details of the particles that the story names */
enum { MOST_STEPS = 1000 };                 /* more are no use to a slider */
enum { LEAST_REST = 60000 };                /* for the part about stages */

/* Where the bytes go. */
typedef struct budget {
    uint64_t all, details, stages; /* for frames and details together; shares of that */
    uint32_t particles;            /* the most in a frame */
    uint64_t *step;                /* ends of steps in the order of choice; then sorted */
    size_t steps;
    size_t detailed; /* of the frames near the focus so many have details */
} budget;

static uint32_t quantities_up_to(const cli_page *page, int ranks)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < page->quantities; i++)
        count += page->quantity[i].rank <= ranks;
    return count;
}

/* Bytes of a frame in the file, at most, but for values that are far from the others. */
static uint64_t frame_bytes(const cli_page *page, uint32_t particles, int ranks, bool exact)
{
    const uint64_t arrays = quantities_up_to(page, ranks);
    return cli_page_base64_size((uint64_t)particles * (exact ? 4 : 2) * (3 + arrays)) + FRAME_JSON +
           ARRAY_JSON * (arrays + 1);
}

/* Bytes of the frames so far. */
static uint64_t frames_bytes(const cli_page *page)
{
    uint64_t data = 0, json = 0;
    for (size_t i = 0; i < page->blocks.count; i++)
        data += page->blocks.block[i].size;
    for (size_t i = 0; i < page->frames; i++)
        json += FRAME_JSON + ARRAY_JSON * (uint64_t)(page->quantities + 1);
    return cli_page_base64_size(data) + json;
}

/* ---- How frames are encoded ---- */

static const struct {
    bool exact;
    int ranks, far_ranks;
    uint64_t wanted; /* ends of steps, if the recording has so many */
} LEVELS[] = {{true, 2, 2, 200}, {false, 2, 2, 100}, {false, 1, 1, 60}, {false, 1, 0, 10}, {false, 0, 0, 1}};

/* Takes the best encoding with which the wanted number of frames fits. False: not even one fits. */
static bool choose_level(cli_page *page, const budget *b, uint64_t steps)
{
    enum { LEVEL_COUNT = sizeof LEVELS / sizeof *LEVELS, STAGES = 12 };
    for (size_t i = 0; i < LEVEL_COUNT; i++) {
        const uint64_t wanted = steps < LEVELS[i].wanted ? steps : LEVELS[i].wanted;
        const uint64_t stages = i + 1 < LEVEL_COUNT ? STAGES : 0;
        const uint64_t frame = frame_bytes(page, b->particles, LEVELS[i].far_ranks, LEVELS[i].exact),
                       rich = frame_bytes(page, b->particles, LEVELS[i].ranks, LEVELS[i].exact);
        if ((wanted + stages) * frame + (LEVELS[i].ranks > LEVELS[i].far_ranks ? 3 * rich : 0) > b->all - b->details)
            continue;
        page->exact = LEVELS[i].exact;
        page->ranks = LEVELS[i].ranks;
        page->far_ranks = LEVELS[i].far_ranks;
        return true;
    }
    return false;
}

/* ---- Going to states ---- */

static int failed(const cli_page_recording *r, rheo_result result, const rheo_error *error)
{
    return result == RHEO_ERROR_STOPPED ? cli_fail(CLI_INTERRUPTED, "%s: interrupted", r->path)
                                        : cli_file_error(r->path, result, error);
}

/* The state of the second recording there. *world: NULL if it has none. Returns an exit code. */
static int seek_other(cli_page *page, uint64_t step, const char *stage, const rheo_world **world)
{
    rheo_error error = {""};
    *world = NULL;
    if (!page->g.path || step < page->g.info.first_step ||
        step > page->g.info.last_step + (*stage && page->g.diagnosis.failed) || page->divergence_unknown <= step)
        return CLI_DONE;
    const rheo_result result = *stage ? rheo_player_seek_stage(page->g.player, step, stage, &error)
                                      : rheo_player_seek(page->g.player, step, &error);
    if (result == RHEO_ERROR_DIFFERS && !*stage)
        page->divergence_unknown = step;
    if (result == RHEO_OK)
        *world = rheo_player_world(page->g.player);
    return result == RHEO_OK || result == RHEO_ERROR_DIFFERS || result == RHEO_ERROR_ARGUMENT ||
                   result == RHEO_ERROR_STATE
               ? CLI_DONE
               : failed(&page->g, result, &error);
}

static int add_state(cli_page *page, uint64_t step, const char *stage, uint32_t run, int ranks, uint32_t priority)
{
    const rheo_world *other = NULL;
    int status = seek_other(page, step, stage, &other);
    return status == CLI_DONE
               ? cli_page_add_frame(page, rheo_player_world(page->f.player), other, step, stage, run, ranks, priority)
               : status;
}

/* ---- Stages ---- */

/* The stage run of the step that the page looks at first. "": none. */
static const char *stage_of_focus(const cli_page *page, uint64_t step)
{
    if (page->chain.told && page->chain.link[0].step == step)
        return page->chain.link[0].stage;
    if (page->g.path && page->difference.verdict == RHEO_DIFFERS && page->difference.first.step == step)
        return page->difference.first.stage;
    return "";
}

/* Goes through the stages of a step. The player is at the step before. */
static int for_each_stage(cli_page *page, uint64_t step,
                          int (*visit)(cli_page *, uint64_t, const char *, uint32_t, void *), void *data)
{
    const rheo_world *world;
    int status = CLI_DONE;
    uint32_t run = 0, last = 0;
    do {
        char name[CLI_STAGE_NAME];
        rheo_error error = {""};
        uint32_t stage;
        const rheo_result result = rheo_player_stage(page->f.player, &stage, &error);
        if (result == RHEO_ERROR_STATE && step > page->f.info.last_step)
            return CLI_DONE; /* the stage that failed */
        if (result != RHEO_OK)
            return failed(&page->f, result, &error);
        world = rheo_player_world(page->f.player);
        cli_stage_run_name(world, stage, &last, name);
        status = visit(page, step, name, run++, data);
    } while (status == CLI_DONE && rheo_world_stages_done(world) > 0);
    return status;
}

/* Which stage runs are shown, and when there is no more room. */
typedef struct window {
    uint32_t runs, anchor, from, to;
    uint64_t limit;
    const char *wanted;
    bool details;
} window;

static int count_run(cli_page *page, uint64_t step, const char *stage, uint32_t run, void *data)
{
    window *w = data;
    cli_page_profile *p = &page->profile;
    if (p->step == step && !cli_page_profile_add(p, rheo_player_world(page->f.player), stage))
        return cli_page_no_memory();
    w->runs = run + 1;
    if (strcmp(stage, w->wanted) == 0)
        w->anchor = run;
    return CLI_DONE;
}

static int show_run(cli_page *page, uint64_t step, const char *stage, uint32_t run, void *data)
{
    window *w = data;
    if (run < w->from || run > w->to || frames_bytes(page) > w->limit)
        return CLI_DONE;
    int status = add_state(page, step, stage, run, page->far_ranks, 1);
    if (status == CLI_DONE && w->details)
        status = cli_page_add_details(page, rheo_player_world(page->f.player), step, run, 0, false);
    return status;
}

/* Shows all of its runs, or those before and after that of the focus; of a step that failed the last ones. */
static int show_stages(cli_page *page, const budget *b, uint64_t step, uint64_t bytes, bool details)
{
    rheo_error error = {""};
    const bool first = page->profile.runs == 0;
    /* Most runs change only some arrays. */
    const uint64_t most = bytes / frame_bytes(page, b->particles, page->far_ranks, page->exact) + 2;
    const uint32_t room = (uint32_t)(most < 100 ? most : 100);
    window w = {.anchor = UINT32_MAX,
                .limit = frames_bytes(page) + bytes,
                .wanted = stage_of_focus(page, step),
                .details = details};
    for (int pass = 0; pass < 2; pass++) {
        const rheo_result result = rheo_player_seek(page->f.player, step - 1, &error);
        if (result != RHEO_OK)
            return failed(&page->f, result, &error);
        if (first && !pass) {
            page->profile.step = step;
            if (!cli_page_profile_begin(&page->profile, rheo_player_world(page->f.player)))
                return cli_page_no_memory();
        }
        const int status = for_each_stage(page, step, pass ? show_run : count_run, &w);
        if (status != CLI_DONE)
            return status;
        if (w.anchor == UINT32_MAX) /* the end, if the step failed */
            w.anchor = step > page->f.info.last_step ? w.runs : 0;
        const uint32_t shown = w.anchor ? room : 2 * room;
        w.from = w.runs <= shown || w.anchor < shown / 2 ? 0 : w.anchor - shown / 2;
        w.from = w.runs > shown && w.from > w.runs - shown ? w.runs - shown : w.from;
        w.to = w.from + shown - 1;
    }
    return CLI_DONE;
}

static int collect_stages(cli_page *page, const budget *b)
{
    const uint64_t first = page->f.info.first_step + 1, last = page->f.info.last_step + page->f.diagnosis.failed;
    const uint64_t focus = page->focus[0] < first ? first : page->focus[0];
    page->begin_stage = stage_of_focus(page, page->focus[0]);
    if (focus > last || b->stages == 0)
        return CLI_DONE;
    const bool both = page->f.diagnosis.failed && focus != last;
    int status = show_stages(page, b, focus, both ? b->stages / 2 : b->stages, true);
    if (both && status == CLI_DONE)
        status = show_stages(page, b, last, b->stages / 2, true);
    const uint64_t neighbour[] = {focus + 1, focus - 1};
    for (int i = 0; i < 2 && status == CLI_DONE; i++)
        if (neighbour[i] >= first && neighbour[i] <= page->f.info.last_step && 2 * frames_bytes(page) <= b->stages)
            status = show_stages(page, b, neighbour[i], b->stages - frames_bytes(page), false);
    return status;
}

/* ---- Steps ---- */

/* How much a step is worth: more near those that the page looks at, the first of all. */
static double worth_of(const cli_page *page, uint64_t step)
{
    double worth = 0.02;
    for (uint32_t i = 0; i < page->focuses; i++) {
        const uint64_t f = page->focus[i], away = f > step ? f - step : step - f;
        worth += (i == 0 ? 4. : 1.) / ((double)away + 2) / ((double)away / 8 + 1);
    }
    return worth;
}

static bool is_chosen(const budget *b, uint64_t step)
{
    for (size_t i = 0; i < b->steps; i++)
        if (b->step[i] == step)
            return true;
    return false;
}

static void choose(const cli_page *page, budget *b, size_t most, uint64_t step)
{
    const rheo_recording_info *info = &page->f.info;
    if (b->steps < most && step >= info->first_step && step <= info->last_step && !is_chosen(b, step))
        b->step[b->steps++] = step;
}

static int compare_steps(const void *a, const void *b)
{
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

/* Splits the gap that is worth most, in its middle by worth, until there are so many steps. */
static void split_gaps(const cli_page *page, budget *b, size_t most, const double *sum, uint64_t first)
{
    while (b->steps < most) {
        double worth = 0;
        size_t widest = b->steps;
        qsort(b->step, b->steps, sizeof *b->step, compare_steps);
        for (size_t i = 0; i + 1 < b->steps; i++) {
            const double gap = sum[b->step[i + 1] - first] - sum[b->step[i] + 1 - first];
            if (b->step[i + 1] > b->step[i] + 1 && gap > worth) {
                worth = gap;
                widest = i;
            }
        }
        if (widest == b->steps)
            break;
        uint64_t step = b->step[widest] + 1;
        while (step + 1 < b->step[widest + 1] && sum[step + 1 - first] - sum[b->step[widest] + 1 - first] < worth / 2)
            step++;
        choose(page, b, most, step);
    }
}

static bool choose_steps(cli_page *page, budget *b, size_t most)
{
    const rheo_recording_info *info = &page->f.info;
    const uint64_t first = info->first_step, steps = page->f.steps;
    b->step = malloc((most + 1) * sizeof *b->step);
    double *sum = malloc((size_t)(steps + 1) * sizeof *sum);
    if (b->step && sum) {
        const uint64_t focus = page->focus[0] < info->last_step ? page->focus[0] : info->last_step;
        choose(page, b, most, focus);
        choose(page, b, most, first);
        choose(page, b, most, info->last_step);
        choose(page, b, most, focus - 1);
        choose(page, b, most, focus + 1);
        for (uint32_t i = 1; i < page->focuses && 2 * b->steps < most; i++)
            choose(page, b, most, page->focus[i]);
        sum[0] = 0;
        for (uint64_t i = 0; i < steps; i++)
            sum[i + 1] = sum[i] + worth_of(page, first + i);
        split_gaps(page, b, most, sum, first);
        qsort(b->step, b->steps, sizeof *b->step, compare_steps);
    }
    free(sum);
    return b->step != NULL;
}

static uint64_t distance(uint64_t a, uint64_t b)
{
    return a > b ? a - b : b - a;
}

static int collect_steps(cli_page *page, budget *b)
{
    const rheo_recording_info *info = &page->f.info;
    const uint64_t focus = page->focus[0] < info->last_step ? page->focus[0] : info->last_step;
    int status = CLI_DONE;
    for (size_t i = 0; i < b->steps && status == CLI_DONE; i++) {
        rheo_error error = {""};
        const uint64_t step = b->step[i], away = distance(step, focus);
        const rheo_result result = rheo_player_seek(page->f.player, step, &error);
        if (result != RHEO_OK)
            return failed(&page->f, result, &error);
        const bool rich = away <= 1;
        size_t nearer = 0;
        for (size_t k = 0; k < b->steps; k++)
            nearer += distance(b->step[k], focus) < away;
        const uint32_t priority = away == 0 ? 0 : (uint32_t)nearer + 2;
        status = add_state(page, step, "", UINT32_MAX, rich ? page->ranks : page->far_ranks, priority);
        const rheo_world *world = rheo_player_world(page->f.player);
        if (status == CLI_DONE && nearer < b->detailed)
            status = cli_page_add_details(page, world, step, UINT32_MAX, nearer + 1, false);
        if (status == CLI_DONE && away == 0 &&
            cli_page_detail_size(world) * rheo_world_particle_count(world) < b->details / 2)
            status = cli_page_add_details(page, world, step, UINT32_MAX, UINT32_MAX, true);
    }
    return status;
}

/* ---- All ---- */

static int compare_frames(const void *a, const void *b)
{
    const cli_page_frame *x = a, *y = b;
    return x->step != y->step ? x->step < y->step ? -1 : 1 : (x->run > y->run) - (x->run < y->run);
}

static int compare_details(const void *a, const void *b)
{
    const cli_page_detail *x = a, *y = b;
    return x->priority != y->priority ? x->priority < y->priority ? -1 : 1
           : x->step != y->step       ? x->step < y->step ? -1 : 1
           : x->run != y->run         ? x->run < y->run ? -1 : 1
                                      : (x->particle > y->particle) - (x->particle < y->particle);
}

/* Keeps the details of the largest priority that fit, and one of each particle and frame. */
static void keep_details(cli_page *page, uint64_t most)
{
    uint64_t bytes = 0;
    if (page->details)
        qsort(page->detail, page->details, sizeof *page->detail, compare_details);
    for (size_t i = 0; i < page->details; i++) {
        cli_page_detail *d = &page->detail[i];
        for (size_t k = 0; k < i && !d->left_out; k++)
            d->left_out = !page->detail[k].left_out && page->detail[k].particle == d->particle &&
                          page->detail[k].step == d->step && page->detail[k].run == d->run;
        d->left_out = d->left_out || bytes + d->size + 40 > most;
        bytes += d->left_out ? 0 : d->size + 40;
    }
}

/* The most particles in a step: they are only ever added. */
static uint32_t most_particles(const cli_page *page)
{
    uint64_t count = page->f.info.particles;
    rheo_command c;
    for (uint64_t i = 0; rheo_recording_command(page->f.recording, i, &c, NULL) == RHEO_OK; i++)
        count += c.kind == RHEO_COMMAND_ADD_PARTICLES ? c.count : 0;
    return (uint32_t)count;
}

static budget budget_of(const cli_page *page, uint64_t fixed_bytes)
{
    budget b = {.all = page->max_bytes > fixed_bytes ? page->max_bytes - fixed_bytes : 0,
                .particles = most_particles(page)};
    const uint64_t detail = cli_page_detail_size(rheo_player_world(page->f.player)), share = b.all * 15 / 100,
                   named = DETAILED_FRAMES * detail * page->particles, all = detail * b.particles;
    const uint64_t wanted = named + (all < share / 2 ? all : 0);
    b.details = wanted < share ? wanted : share;
    b.stages = (b.all - b.details) * 35 / 100;
    return b;
}

int cli_page_take_stages(cli_page *page, uint64_t fixed_bytes)
{
    const rheo_world *world = rheo_player_world(page->f.player);
    const budget b = budget_of(page, fixed_bytes);
    cli_page_quantities_of(page, world);
    if (!choose_level(page, &b, page->f.steps)) {
        char text[32];
        const uint64_t least = fixed_bytes + frame_bytes(page, b.particles, 0, false) * 100 / 85 + LEAST_REST;
        cli_bytes((double)least, text, sizeof text);
        return cli_fail(CLI_BAD,
                        "--max-size %llu is too small for one state of %u particles; %llu (%s) would be enough",
                        (unsigned long long)page->max_bytes, (unsigned)b.particles, (unsigned long long)least, text);
    }
    page->extent = rheo_world_extent(world);
    return collect_stages(page, &b);
}

int cli_page_take_steps(cli_page *page, uint64_t fixed_bytes)
{
    const rheo_world *world = rheo_player_world(page->f.player);
    budget b = budget_of(page, fixed_bytes);
    const uint64_t detail = cli_page_detail_size(world) * (page->particles ? page->particles : 1);
    b.detailed = (size_t)(b.details * 3 / 2 / detail + 3);
    const uint64_t taken = b.details + frames_bytes(page), left = b.all > taken ? b.all - taken : 0,
                   frame = frame_bytes(page, b.particles, page->far_ranks, page->exact),
                   rich = 3 * (frame_bytes(page, b.particles, page->ranks, page->exact) - frame);
    uint64_t most = left > rich + frame ? (left - rich) / frame : 1;
    most = most < MOST_STEPS ? most : MOST_STEPS;
    most = most < page->f.steps ? most : page->f.steps;
    if (!choose_steps(page, &b, (size_t)most))
        return cli_page_no_memory();
    const int status = collect_steps(page, &b);
    free(b.step);
    if (page->frames)
        qsort(page->frame, page->frames, sizeof *page->frame, compare_frames);
    keep_details(page, b.details);
    const rheo_extent last = rheo_world_extent(rheo_player_world(page->f.player));
    page->extent = rheo_extent_of_both(&page->extent, &last);
    cli_page_find_ranges(page);
    return status;
}
