/* The parts of a page that say what was done: how the recording was made, and its commands. */
#define _POSIX_C_SOURCE 200809L /* open_memstream() */
#include "cli/report.h"

#include <string.h>

#include "cli/provenance.h"

enum { MOST = 1000 }; /* commands that are listed */

static void put_parameters(FILE *file, const cli_page *page)
{
    const rheo_world_def *def = rheo_recording_definition(page->f.recording);
    char value[CLI_PARAMETER_VALUE], usual[CLI_PARAMETER_VALUE];
    const rheo_parameter *p;
    fputs(
        "<h3>Parameters that differ from their defaults</h3>\n<div class=\"scroll\">\n<table class=\"parameters\">\n"
        "<thead><tr><th scope=\"col\">parameter</th><th scope=\"col\">value</th><th scope=\"col\">default</th>"
        "<th scope=\"col\">unit</th><th scope=\"col\">meaning</th></tr></thead>\n<tbody>\n",
        file);
    for (size_t i = 0; (p = cli_next_differing(def, &i, value, usual)) != NULL;) {
        const char *const cell[] = {value, *usual ? usual : "none", strcmp(p->unit, "1") ? p->unit : "", p->about};
        fputs("<tr><th scope=\"row\">", file);
        cli_page_put(file, p->path);
        fputs("</th>", file);
        for (size_t c = 0; c < sizeof cell / sizeof *cell; c++) {
            fputs("<td>", file);
            cli_page_put(file, cell[c]);
            fputs("</td>", file);
        }
        fputs("</tr>\n", file);
    }
    fputs("</tbody>\n</table>\n</div>\n<h3>Commands</h3>\n", file);
}

int cli_page_write_commands(cli_page *page)
{
    rheo_world_def def = *rheo_recording_definition(page->f.recording);
    const uint64_t all = rheo_recording_command_count(page->f.recording), count = all < MOST ? all : MOST;
    if (!cli_page_begin(&page->commands))
        return cli_page_no_memory();
    FILE *file = page->commands.file;
    put_parameters(file, page);
    if (count == 0)
        fputs("<p>No commands were given.</p>\n", file);
    else
        fputs("<ol class=\"commands\">\n", file);
    int status = CLI_DONE;
    for (uint64_t i = 0; i < count && status == CLI_DONE; i++) {
        rheo_command c;
        rheo_error error = {""};
        char before[96] = "";
        const rheo_result result = rheo_recording_command(page->f.recording, i, &c, &error);
        if (result != RHEO_OK) {
            status = cli_file_error(page->f.path, result, &error);
            break;
        }
        if (c.kind == RHEO_COMMAND_SET) {
            rheo_world_def_get(&def, c.path, before, sizeof before);
            rheo_world_def_set(&def, c.path, c.value, NULL);
        }
        fputs("<li>before ", file);
        cli_page_put_link(file, c.step, "", -1);
        fprintf(file, "step %llu</a>: ", (unsigned long long)c.step);
        cli_page_put(file, c.text);
        if (before[0]) {
            fputs("; before, it was ", file);
            cli_page_put(file, before);
        }
        fputs("</li>\n", file);
    }
    if (count)
        fputs("</ol>\n", file);
    if (count < all) {
        fprintf(file, "<p>And %llu more: ", (unsigned long long)(all - count));
        cli_page_put_command(file, "rheolog log", page->f.name, "");
        fputs("</p>\n", file);
    }
    return cli_page_end(&page->commands) ? status : cli_page_no_memory();
}
