/*
 * rheolog table: makes one table of many recordings, a row each: how it ended, its settings, and its metrics at events.
 * Nothing is simulated unless an event is a condition on particles, springs or the ball.
 */
#include "cli/table.h"

#include <stdlib.h>
#include <string.h>

#include "json/file_name.h"

typedef struct arguments {
    const char *settings, *metrics, *output;
    cli_list at;
    bool json, force;
} arguments;

/* ---- Events ---- */

/* What follows a word and blanks; NULL: the text does not begin so. */
static const char *after_word(const char *text, const char *word)
{
    const size_t length = strlen(word);
    if (strncmp(text, word, length) != 0 || text[length] != ' ')
        return NULL;
    return text + length + strspn(text + length, " ");
}

/* "step 5" and "time 2.5" are events; "step > 5" is a condition. */
static int read_event(const char *text, cli_event *event)
{
    const char *number, *end;
    *event = (cli_event){.kind = CLI_AT_CONDITION, .text = text};
    if (!*text)
        return cli_usage(&cli_table, "--at needs end, step N, time T or a condition; got an empty text");
    if (strcmp(text, "end") == 0)
        event->kind = CLI_AT_END;
    else if ((number = after_word(text, "step")) != NULL && cli_number_from(number, &event->step))
        event->kind = CLI_AT_STEP;
    else if ((number = after_word(text, "time")) != NULL) {
        event->time = rheo_text_number(number, &end);
        if (end != number && !*end)
            event->kind = CLI_AT_TIME;
    }
    return CLI_DONE;
}

static int read_events(const cli_list *at, cli_sweep *s)
{
    int status = CLI_DONE;
    if (at->count > CLI_TABLE_EVENTS)
        return cli_usage(&cli_table, "takes at most %d --at; got %zu", CLI_TABLE_EVENTS, at->count);
    for (s->events = 0; s->events < at->count && status == CLI_DONE; s->events++)
        status = read_event(at->item[s->events], &s->event[s->events]);
    if (at->count == 0)
        s->event[s->events++] = (cli_event){.kind = CLI_AT_END, .text = "end"};
    return status;
}

/* ---- Columns ---- */

static int unknown_metric(const cli_sweep *s, const char *name)
{
    char suggestion[CLI_SUGGESTION];
    const char *names[256];
    size_t count = 0;
    for (; count < s->metrics.count && count < 256; count++)
        names[count] = s->metrics.column[count].name;
    return cli_usage(&cli_table, "there is no metric \"%s\"%s", name,
                     *cli_did_you_mean(name, rheo_nearest_word(name, names, count), suggestion)
                         ? suggestion
                         : "; `rheolog metrics --list` lists them");
}

/* Whether a name of a list may be a column although no recording has it. If not, says so. */
static int check_name(const cli_sweep *s, const char *name, bool of_metrics)
{
    if (of_metrics)
        return s->metrics.count ? unknown_metric(s, name) : CLI_DONE;
    if (rheo_scene_parameter_find(name))
        return CLI_DONE;
    char suggestion[CLI_SUGGESTION];
    return cli_usage(&cli_table, "there is no parameter \"%s\"%s", name,
                     *cli_did_you_mean(name, rheo_scene_parameter_nearest(name), suggestion)
                         ? suggestion
                         : "; `rheolog scenes --parameters` lists them");
}

static bool is_chosen(const size_t *chosen, size_t count, size_t column)
{
    size_t i = 0;
    while (i < count && chosen[i] != column)
        i++;
    return i < count;
}

/* Takes the columns of a list. A name that no recording has becomes an empty column if it is a parameter. */
static int choose_list(const cli_sweep *s, cli_columns *columns, const char *list, size_t **chosen, size_t *count)
{
    int status = CLI_DONE;
    for (const char *word = list; word && status == CLI_DONE; word = *word ? word + 1 : NULL) {
        const size_t length = strcspn(word, ",");
        char name[96];
        snprintf(name, sizeof name, "%.*s", length < sizeof name ? (int)length : 0, word);
        if (cli_columns_find(columns, name) == columns->count)
            status = check_name(s, name, columns == &s->metrics);
        const size_t column = status == CLI_DONE ? cli_columns_add(columns, 0, name) : 0;
        size_t *more = realloc(*chosen, (*count + 1) * sizeof *more);
        if (!more || column == SIZE_MAX)
            return cli_fail(CLI_SYSTEM, "no memory for the table");
        *chosen = more;
        if (status == CLI_DONE && !is_chosen(more, *count, column))
            more[(*count)++] = column;
        word += length;
    }
    return status;
}

/* Chooses the settings by a word, or all metrics (NULL). */
static int choose_all(const cli_columns *columns, const char *word, size_t **chosen, size_t *count)
{
    *chosen = malloc((columns->count + 1) * sizeof **chosen);
    if (!*chosen)
        return cli_fail(CLI_SYSTEM, "no memory for the table");
    for (size_t i = 0; i < columns->count; i++) {
        const cli_column *c = &columns->column[i];
        if (!word || (strcmp(word, "changed") == 0 ? c->changed : strcmp(word, "differing") == 0 && c->differs))
            (*chosen)[(*count)++] = i;
    }
    return CLI_DONE;
}

static int choose_columns(cli_sweep *s, const arguments *a)
{
    const char *word = a->settings ? a->settings : "differing";
    const bool is_word = strcmp(word, "differing") == 0 || strcmp(word, "changed") == 0 || strcmp(word, "none") == 0;
    int status = is_word ? choose_all(&s->settings, word, &s->setting, &s->setting_count)
                         : choose_list(s, &s->settings, word, &s->setting, &s->setting_count);
    if (status == CLI_DONE)
        status = a->metrics ? choose_list(s, &s->metrics, a->metrics, &s->metric, &s->metric_count)
                            : choose_all(&s->metrics, NULL, &s->metric, &s->metric_count);
    return status;
}

/* ---- The command ---- */

static int check_output(const arguments *a, int files, char **file)
{
    if (a->force && !a->output)
        return cli_usage(&cli_table, "--force goes with -o");
    if (!a->output)
        return CLI_DONE;
    if (rheo__json_ends_with(a->output, ".rlog")) /* as in `-o *.rlog` */
        return cli_usage(&cli_table, "-o %s: a table is no recording; give another name", a->output);
    for (int i = 0; i < files; i++)
        if (cli_same_file(file[i], a->output))
            return cli_fail(CLI_BAD, "%s is read and cannot be written by -o too", a->output);
    return cli_check_replaced(a->output, a->force);
}

/* A recording that cannot be read has a row, too. Only what stops the command leaves no table. */
static int read_rows(cli_sweep *s, int files, char **file, int *worst)
{
    s->row = calloc((size_t)files + 1, sizeof *s->row);
    if (!s->row)
        return cli_fail(CLI_SYSTEM, "no memory for the table");
    for (; s->rows < (size_t)files; s->rows++) {
        cli_row *row = &s->row[s->rows];
        row->file = file[s->rows];
        const int status = cli_read_row(s, row);
        if (cli_interrupted() || status == CLI_INTERRUPTED)
            return cli_fail(CLI_INTERRUPTED, "interrupted after %zu of %d recordings", s->rows, files);
        if (cli_refused_condition() || (status == CLI_SYSTEM && !row->reason))
            return status;
        *worst = status > *worst ? status : *worst;
    }
    return CLI_DONE;
}

static void release(cli_sweep *s)
{
    for (size_t i = 0; s->row && i <= s->rows; i++) { /* also the one that stopped the command */
        cli_row *row = &s->row[i];
        for (size_t k = 0; k < row->settings; k++)
            free(row->setting[k]);
        for (size_t e = 0; e < CLI_TABLE_EVENTS; e++)
            free(row->at[e].cell);
        free(row->setting);
        free(row->reason);
    }
    free(s->row);
    free(s->setting);
    free(s->metric);
    cli_columns_release(&s->settings);
    cli_columns_release(&s->metrics);
}

static int make_table(cli_sweep *s, const arguments *a, int files, char **file)
{
    int worst = CLI_DONE;
    cli_watch_signals();
    int status = read_rows(s, files, file, &worst);
    if (status == CLI_DONE)
        status = choose_columns(s, a);
    if (status != CLI_DONE)
        return status;
    void (*put)(FILE *, const void *) = a->json ? cli_put_table_json : cli_put_table_csv;
    if (a->output)
        status = cli_write_file(a->output, put, s);
    else
        put(stdout, s);
    return status > worst ? status : worst;
}

static int run(int argc, char **argv)
{
    arguments a = {.settings = NULL};
    const cli_option options[] = {
        {"--set-columns", NULL, "NAMES", CLI_TEXT, &a.settings},
        {"--metrics", NULL, "NAME,NAME,...", CLI_TEXT, &a.metrics},
        {"--at", NULL, "EVENT", CLI_LIST, &a.at},
        {"--output", "-o", "FILE", CLI_TEXT, &a.output},
        {"--force", NULL, NULL, CLI_FLAG, &a.force},
        {"--json", NULL, NULL, CLI_FLAG, &a.json},
        {0},
    };
    cli_sweep sweep = {.row = NULL};
    int status = cli_parse(&cli_table, options, &argc, argv);
    if (status != CLI_GO_ON)
        return status;
    if (argc == 0)
        return cli_usage(&cli_table, "needs at least one recording");
    if ((status = read_events(&a.at, &sweep)) == CLI_DONE && (status = check_output(&a, argc, argv)) == CLI_DONE)
        status = make_table(&sweep, &a, argc, argv);
    release(&sweep);
    return status;
}

static const char help[] = {
#include "cli/help/table.txt.inc"
    0};

const cli_command cli_table = {"table", help, run};
