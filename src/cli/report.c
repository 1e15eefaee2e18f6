/* rheolog report: writes one file for a browser, with what a recording shows. */
#include "cli/report.h"

#include <stdlib.h>
#include <string.h>

#include "cli/steps.h"
#include "json/file_name.h"

enum { MAX_SIZE = 10000000, BUDGET_TEXT = 4096 };

typedef struct arguments {
    const char *output, *simd;
    cli_number max_size;
    bool force, json;
} arguments;

static int check_usage(const arguments *a, int operands)
{
    if (operands < 1 || operands > 2)
        return cli_usage(&cli_report, "needs one recording, or two to compare; got %d", operands);
    if (!a->output || !*a->output)
        return cli_usage(&cli_report, "needs -o FILE.html: the file to write");
    if (!rheo__json_ends_with(a->output, ".html"))
        return cli_usage(&cli_report, "-o needs a name that ends with .html; got \"%s\"", a->output);
    const int status = cli_check_folder(a->output);
    return status == CLI_DONE ? cli_refuse_existing(a->output, a->force) : status;
}

/* ---- The page ---- */

static int compare(cli_page *page)
{
    rheo_error error = {""};
    const rheo_result result = rheo_diff(page->f.path, page->g.path, &page->difference, &error);
    if (result != RHEO_OK)
        return cli_error(result, &error);
    if (page->difference.verdict == RHEO_UNREADABLE || page->difference.verdict == RHEO_NOT_COMPARED)
        return cli_fail(CLI_BAD, "%s", page->difference.message);
    return CLI_DONE;
}

static uint64_t fixed_bytes(const cli_page *page)
{
    return cli_page_template_size() + page->summary.size + page->story.size + page->divergence.size +
           page->metrics_part.size + page->stages_part.size + page->commands.size + BUDGET_TEXT + 1000 * page->marks;
}

static uint64_t all_bytes(const cli_page *page)
{
    uint64_t data = 0;
    for (size_t i = 0; i < page->blocks.count; i++)
        data += page->blocks.block[i].used ? page->blocks.block[i].size : 0;
    return cli_page_template_size() + page->summary.size + page->budget.size + page->story.size +
           page->divergence.size + page->metrics_part.size + page->stages_part.size + page->commands.size +
           page->meta.size + cli_page_base64_size(data);
}

/* Leaves out the frame that is wanted least. False: only those are left that are always there. */
static bool leave_out(cli_page *page)
{
    cli_page_frame *least = NULL;
    for (size_t i = 0; i < page->frames; i++)
        if (!page->frame[i].left_out && page->frame[i].priority > 0 &&
            (!least || page->frame[i].priority >= least->priority))
            least = &page->frame[i];
    if (least)
        least->left_out = true;
    return least != NULL;
}

static int fit(cli_page *page)
{
    for (;;) {
        int status = cli_page_write_meta(page);
        if (status == CLI_DONE)
            status = cli_page_write_budget(page);
        if (status != CLI_DONE || all_bytes(page) <= page->max_bytes)
            return status;
        if (!leave_out(page))
            return cli_fail(CLI_BAD, "--max-size %llu is too small; %llu would be enough",
                            (unsigned long long)page->max_bytes, (unsigned long long)all_bytes(page));
    }
}

static int make_page(cli_page *page)
{
    int status = cli_page_read(&page->f);
    if (status == CLI_DONE && page->g.path)
        status = cli_page_read(&page->g);
    if (status == CLI_DONE && page->g.path)
        status = compare(page);
    if (status != CLI_DONE)
        return status;
    cli_doctor_chain_begin(page->f.recording, &page->f.diagnosis, &page->chain);
    cli_doctor_chain_follow(page->f.recording, &page->chain);
    if ((status = cli_page_find_focus(page)) == CLI_DONE && (status = cli_page_write_story(page)) == CLI_DONE &&
        (status = cli_page_write_commands(page)) == CLI_DONE &&
        (status = cli_page_write_divergence(page)) == CLI_DONE &&
        (status = cli_page_write_metrics(page)) == CLI_DONE &&
        (status = cli_page_take_stages(page, fixed_bytes(page))) == CLI_DONE &&
        (status = cli_page_write_stages(page)) == CLI_DONE &&
        (status = cli_page_take_steps(page, fixed_bytes(page))) == CLI_DONE)
        status = fit(page);
    return status;
}

static void release(cli_page *page)
{
    cli_page_text *const text[] = {&page->summary,      &page->budget,      &page->story,    &page->divergence,
                                   &page->metrics_part, &page->stages_part, &page->commands, &page->meta};
    for (size_t i = 0; i < sizeof text / sizeof *text; i++)
        free(text[i]->at);
    for (size_t i = 0; i < page->frames; i++) {
        free(page->frame[i].body);
        free(page->frame[i].position.far);
        for (uint32_t q = 0; q < page->quantities; q++)
            free(page->frame[i].value[q].far);
    }
    for (size_t i = 0; i < page->details; i++)
        free(page->detail[i].json);
    for (uint32_t q = 0; q < page->quantities; q++)
        free(page->quantity[q].sample);
    cli_page_blocks_release(&page->blocks);
    cli_page_profile_release(&page->profile);
    free(page->frame);
    free(page->detail);
    free(page->mark);
    free(page->stage);
    cli_page_recording_release(&page->g);
    cli_page_recording_release(&page->f);
}

/* ---- The command ---- */

static void print_json(const arguments *a, const cli_page *page, int status)
{
    rheo__json json = {.file = stdout};
    cli_page_counts counts;
    cli_page_count(page, &counts);
    rheo__json_begin_object(&json, NULL);
    rheo__json_text(&json, "file", page->f.path);
    rheo__json_text(&json, "other", page->g.path);
    rheo__json_text(&json, "output", a->output);
    rheo__json_text(&json, "outcome", status == CLI_DIFFERS ? "differs" : cli_status_name(status));
    rheo__json_text(&json, "reason", status == CLI_DONE ? NULL : cli_said());
    if (status == CLI_DONE) {
        rheo__json_text(&json, "verdict", page->f.diagnosis.healthy ? "healthy" : "unhealthy");
        rheo__json_integer(&json, "bytes", page->bytes);
        rheo__json_integer(&json, "max_bytes", page->max_bytes);
        rheo__json_bool(&json, "exact", page->exact);
        rheo__json_integer(&json, "steps", counts.steps);
        rheo__json_integer(&json, "stages", counts.stages);
        rheo__json_integer(&json, "details", counts.details);
    }
    rheo__json_end_object(&json);
}

static int report(const arguments *a, cli_page *page)
{
    cli_watch_signals();
    int status = make_page(page);
    cli_watch_end();
    if (status == CLI_DONE && cli_interrupted())
        status = cli_fail(CLI_INTERRUPTED, "%s: interrupted", page->f.path);
    if (status == CLI_DONE)
        status = cli_write_file(a->output, cli_page_write, page);
    if (status != CLI_DONE)
        return status;
    page->bytes = (uint64_t)cli_file_bytes(a->output);
    if (!a->json)
        printf("%s\n", a->output);
    return CLI_DONE;
}

static int run(int argc, char **argv)
{
    arguments a = {.max_size = {false, MAX_SIZE}};
    const cli_option options[] = {
        {"--output", "-o", "FILE", CLI_TEXT, &a.output}, {"--max-size", NULL, "SIZE", CLI_SIZE, &a.max_size},
        {"--simd", NULL, "NAME", CLI_TEXT, &a.simd},     {"--force", NULL, NULL, CLI_FLAG, &a.force},
        {"--json", NULL, NULL, CLI_FLAG, &a.json},       {0},
    };
    int status = cli_parse(&cli_report, options, &argc, argv);
    if (status != CLI_GO_ON)
        return status;
    cli_page *page = calloc(1, sizeof *page);
    if (!page)
        return cli_page_no_memory();
    page->f.path = argc > 0 ? argv[0] : NULL;
    page->g.path = argc > 1 ? argv[1] : NULL;
    page->max_bytes = a.max_size.value;
    page->divergence_unknown = UINT64_MAX;
    if ((status = check_usage(&a, argc)) == CLI_DONE && (status = cli_use_simd(a.simd)) == CLI_DONE)
        status = report(&a, page);
    if (a.json)
        print_json(&a, page, status);
    release(page);
    free(page);
    return status;
}

static const char help[] = {
#include "cli/help/report.txt.inc"
    0};

const cli_command cli_report = {"report", help, run};
