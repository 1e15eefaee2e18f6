/* Puts the parts of a page into its template, src/cli/report/page.html. */
#include "cli/report.h"

#include <string.h>

static const unsigned char template[] = {
#include "cli/report/page.html.inc"
    0};
static const unsigned char style[] = {
#include "cli/report/page.css.inc"
    0};
static const unsigned char script[] = {
#include "cli/report/page.js.inc"
    0};

static void put_part(FILE *file, const cli_page_text *text)
{
    if (text->at)
        fwrite(text->at, 1, text->size, file);
}

/* Writes what a marker stands for. False: it is none. */
static bool put_marker(FILE *file, const char *name, const cli_page *page)
{
    const struct {
        const char *name;
        const cli_page_text *text;
    } parts[] = {{"summary", &page->summary},       {"budget", &page->budget},        {"story", &page->story},
                 {"divergence", &page->divergence}, {"metrics", &page->metrics_part}, {"stages", &page->stages_part},
                 {"commands", &page->commands}};
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
        if (strcmp(parts[i].name, name) == 0) {
            put_part(file, parts[i].text);
            return true;
        }
    if (strcmp(name, "title") == 0) {
        fputs("<title>", file);
        cli_page_put(file, page->f.name);
        if (page->g.path) {
            fputs(" and ", file);
            cli_page_put(file, page->g.name);
        }
        fputs(" - rheolog report</title>\n", file);
    } else if (strcmp(name, "style") == 0) {
        fprintf(file, "<style>\n%s</style>\n", (const char *)style);
    } else if (strcmp(name, "script") == 0) {
        fprintf(file, "<script type=\"module\">\n%s</script>\n", (const char *)script);
    } else if (strcmp(name, "meta") == 0) {
        fputs("<script type=\"application/json\" id=\"report-meta\">\n", file);
        put_part(file, &page->meta);
        fputs("</script>\n", file);
    } else if (strcmp(name, "data") == 0) {
        fputs("<script type=\"text/plain\" id=\"report-data\">", file);
        cli_page_put_base64(file, &page->blocks);
        fputs("</script>\n", file);
    } else {
        return false;
    }
    return true;
}

uint64_t cli_page_template_size(void)
{
    return sizeof template + sizeof style + sizeof script + 400;
}

void cli_page_write(FILE *file, const void *data)
{
    static const char begin[] = "<!--@", end[] = "-->";
    for (const char *line = (const char *)template; *line;) {
        const char *next = strchr(line, '\n');
        const size_t length = next ? (size_t)(next - line) : strlen(line), least = strlen(begin) + strlen(end);
        char name[32] = "";
        if (length > least && length - least < sizeof name && strncmp(line, begin, strlen(begin)) == 0 &&
            strncmp(line + length - strlen(end), end, strlen(end)) == 0)
            memcpy(name, line + strlen(begin), length - least);
        if (!*name || !put_marker(file, name, data)) {
            fwrite(line, 1, length, file);
            fputc('\n', file);
        }
        line += length + (next != NULL);
    }
}
