/* The part of a page that says what the page holds, and with which commands the rest is seen. */
#define _POSIX_C_SOURCE 200809L /* open_memstream() */
#include "cli/report.h"

#include <stdlib.h>

void cli_page_count(const cli_page *page, cli_page_counts *counts)
{
    *counts = (cli_page_counts){0};
    for (size_t i = 0; i < page->frames; i++) {
        const cli_page_frame *frame = &page->frame[i];
        counts->steps += !frame->left_out && !frame->stage[0];
        counts->stages += !frame->left_out && frame->stage[0];
    }
    for (size_t i = 0; i < page->details; i++)
        counts->details += !page->detail[i].left_out;
}

int cli_page_write_budget(cli_page *page)
{
    char size[32];
    cli_page_counts counts;
    cli_page_count(page, &counts);
    free(page->budget.at);
    page->budget = (cli_page_text){0};
    if (!cli_page_begin(&page->budget))
        return cli_page_no_memory();
    FILE *file = page->budget.file;
    cli_bytes((double)page->max_bytes, size, sizeof size);
    fprintf(
        file,
        "<p>This file has at most %s (<code>--max-size</code>). It holds the state at the end of %zu of %llu steps, "
        "denser near those that the story names, %zu states within steps, and the values of %zu particles in such "
        "states with springs and past. Numbers of the view are %s; others are exact.%s</p>\n",
        size, counts.steps, (unsigned long long)page->f.steps, counts.stages, counts.details,
        page->exact ? "float32" : "rounded to 16 bits between the least and the largest of a state",
        page->ranks > page->far_ranks ? " Away from the first step, states have only the most important quantities."
                                      : "");
    fputs("<p>The rest is in the recording:</p>\n<ul>\n<li>", file);
    cli_page_put_command(file, "rheolog inspect", page->f.name, " --step N --particle P");
    fputs(", a particle at any step, with <code>--stage NAME</code> within it</li>\n<li>", file);
    cli_page_put_command(file, "rheolog track", page->f.name, " --particle P");
    fputs(", through time</li>\n<li>", file);
    cli_page_put_command(file, "rheolog why", page->f.name, " --step N --particle P --depth 20");
    fputs(", who changed it, and what that came from</li>\n<li>", file);
    cli_page_put_command(file, "rheolog export", page->f.name, " -o FOLDER --format csv --step N");
    fputs(", all particles</li>\n<li>", file);
    cli_page_put_command(file, "rheolog report", page->f.name, " -o FILE.html --max-size 50M");
    fputs(", a page with more states</li>\n</ul>\n", file);
    return cli_page_end(&page->budget) ? CLI_DONE : cli_page_no_memory();
}
