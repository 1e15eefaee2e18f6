/*
 * Reads the lines of `rheolog debug`: from a terminal with libedit if the program was built with it, which brings line
 * editing, a history and completion; else plainly.
 */
#include "cli/debug.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#ifdef CLI_WITH_LIBEDIT
#include <histedit.h>
#endif

/* ---- Completion ---- */

static const char *const ITEMS[] = {"particle", "spring", "ball", NULL};

typedef struct words {
    const char *begin; /* what the words must begin with */
    void (*receive)(void *data, const char *word);
    void *data;
} words;

static void offer(const words *w, const char *word)
{
    if (word && strncmp(word, w->begin, strlen(w->begin)) == 0)
        w->receive(w->data, word);
}

static void offer_all(const words *w, const char *const *list)
{
    for (; *list; list++)
        offer(w, *list);
}

static void offer_commands(const words *w)
{
    const cli_debug_command *c;
    for (size_t i = 0; (c = cli_debug_command_at(i)) != NULL; i++)
        offer(w, c->name);
}

static void offer_stages(const words *w, const rheo_world *world)
{
    rheo_stage_info stage;
    for (uint32_t i = 0; rheo_world_stage(world, i, &stage) == RHEO_OK; i++)
        offer(w, stage.name);
}

static void offer_metrics(const words *w, const rheo_world *world)
{
    const char *name;
    for (uint32_t i = 0; (name = rheo_world_metric_name(world, i)) != NULL; i++)
        offer(w, name);
}

static void offer_quantities(const words *w, const rheo_world *world)
{
    static const char *const OTHERS[] = {"vx",     "vy",          "vz",      "neighbours",   "springs",   "spin",
                                         "length", "rest_length", "stretch", "history_rate", "stiffness", NULL};
    const rheo_quantity *q;
    offer_all(w, OTHERS);
    for (uint32_t i = 0; (q = rheo_world_quantity(world, i)) != NULL; i++)
        offer(w, q->name);
}

static void offer_parameters(const words *w, const rheo_world *world)
{
    const rheo_world_def *def = rheo_world_definition(world);
    const rheo_parameter *p;
    for (size_t i = 0; (p = rheo_world_def_parameter_at(def, i)) != NULL; i++)
        if (p->models >> def->model & 1)
            offer(w, p->path);
}

size_t cli_debug_complete(const cli_session *s, const char *line, void (*receive)(void *data, const char *word),
                          void *data)
{
    char command[32];
    const char *rest = line + strspn(line, " \t"), *last = strrchr(line, ' ');
    const rheo_world *world = cli_debug_world(s);
    const words w = {last ? last + 1 : line, receive, data};
    const size_t length = strlen(w.begin);
    if (w.begin <= rest || !cli_debug_word(&rest, command, sizeof command)) {
        offer_commands(&w);
        return length;
    }
    const cli_debug_command *c, *found = NULL;
    for (size_t i = 0; !found && (c = cli_debug_command_at(i)) != NULL; i++)
        if (strncmp(c->name, command, strlen(command)) == 0)
            found = c;
    const char *name = found ? found->name : "";
    if (strcmp(name, "help") == 0) {
        offer_commands(&w);
    } else if (strcmp(name, "goto") == 0) {
        offer_all(&w, (const char *const[]){"first", "last", NULL});
        offer_stages(&w, world);
    } else if (strcmp(name, "set") == 0) {
        offer_parameters(&w, world);
    } else if (strcmp(name, "print") == 0) {
        offer_all(&w, ITEMS);
        offer_metrics(&w, world);
    } else if (strcmp(name, "track") == 0) {
        offer_all(&w, ITEMS);
        offer_quantities(&w, world);
    } else if (strcmp(name, "why") == 0) {
        offer(&w, "particle");
        offer_all(&w, (const char *const[]){"position", "velocity", "density", "temperature", "derivative", NULL});
    } else if (strcmp(name, "when") == 0 || strcmp(name, "until") == 0 || strcmp(name, "back") == 0) {
        offer_all(&w, ITEMS);
        offer_all(&w, (const char *const[]){"any", "exists", "and", "or", "not", NULL});
        if (strcmp(name, "back") == 0)
            offer(&w, "until");
        offer_metrics(&w, world);
        offer_quantities(&w, world);
    }
    return length;
}

/* ---- Reading ---- */

struct cli_input {
    bool terminal;
#ifdef CLI_WITH_LIBEDIT
    cli_session *session;
    EditLine *editor;
    History *history;
    const char *prompt;
#endif
};

/* Reads a line. What does not fit is left out. */
static bool read_plain(const char *prompt, char line[CLI_DEBUG_LINE], bool *interrupted)
{
    fputs(prompt, stdout);
    fflush(stdout);
    errno = 0;
    if (!fgets(line, CLI_DEBUG_LINE, stdin)) {
        *interrupted = ferror(stdin) && errno == EINTR;
        clearerr(stdin);
        return false;
    }
    if (!strchr(line, '\n'))
        for (int c = getchar(); c != EOF && c != '\n';)
            c = getchar();
    line[strcspn(line, "\n")] = 0;
    return true;
}

#ifdef CLI_WITH_LIBEDIT

static char *prompt_of(EditLine *editor)
{
    cli_input *input = NULL;
    static char prompt[160];
    el_get(editor, EL_CLIENTDATA, &input);
    snprintf(prompt, sizeof prompt, "%s", input->prompt);
    return prompt;
}

/* What the words that were offered have in common, and their number. */
typedef struct common {
    char word[64];
    size_t count;
    bool list; /* print them */
} common;

static void receive(void *data, const char *word)
{
    common *c = data;
    if (c->list)
        printf("  %s", word);
    if (c->count++ == 0)
        snprintf(c->word, sizeof c->word, "%s", word);
    size_t same = 0;
    while (c->word[same] && c->word[same] == word[same])
        same++;
    c->word[same] = 0;
}

/* Completes the word before the cursor; lists the words if there are several and nothing can be added. */
static unsigned char complete(EditLine *editor, int key)
{
    (void)key;
    cli_input *input = NULL;
    char line[CLI_DEBUG_LINE];
    common c = {.count = 0};
    const LineInfo *info = el_line(editor);
    el_get(editor, EL_CLIENTDATA, &input);
    snprintf(line, sizeof line, "%.*s", (int)(info->cursor - info->buffer), info->buffer);
    const size_t length = cli_debug_complete(input->session, line, receive, &c);
    if (c.count == 0)
        return CC_ERROR;
    if (c.count > 1 && strlen(c.word) <= length) {
        c = (common){.list = true};
        putchar('\n');
        cli_debug_complete(input->session, line, receive, &c);
        putchar('\n');
        fflush(stdout);
        return CC_REDISPLAY;
    }
    if (el_insertstr(editor, c.word + length) != 0 || (c.count == 1 && el_insertstr(editor, " ") != 0))
        return CC_ERROR;
    return CC_REFRESH;
}

static bool open_editor(cli_input *input)
{
    HistEvent event;
    input->editor = el_init("rheolog", stdin, stdout, stderr);
    input->history = history_init();
    if (!input->editor || !input->history)
        return false;
    history(input->history, &event, H_SETSIZE, 1000);
    history(input->history, &event, H_SETUNIQUE, 1);
    el_set(input->editor, EL_CLIENTDATA, input);
    el_set(input->editor, EL_PROMPT, prompt_of);
    el_set(input->editor, EL_EDITOR, "emacs");
    el_set(input->editor, EL_HIST, history, input->history);
    el_set(input->editor, EL_ADDFN, "complete", "Completes the word", complete);
    el_set(input->editor, EL_BIND, "^I", "complete", NULL);
    el_set(input->editor, EL_BIND, "^R", "em-inc-search-prev", NULL);
    el_set(input->editor, EL_SIGNAL, 0);
    return true;
}

static bool read_edited(cli_input *input, const char *prompt, char line[CLI_DEBUG_LINE], bool *interrupted)
{
    HistEvent event;
    int length = 0;
    input->prompt = prompt;
    errno = 0;
    const char *text = el_gets(input->editor, &length);
    if (!text || length <= 0) {
        *interrupted = length < 0 && errno == EINTR;
        el_reset(input->editor);
        return false;
    }
    snprintf(line, CLI_DEBUG_LINE, "%.*s", (int)strcspn(text, "\n"), text);
    if (*line)
        history(input->history, &event, H_ENTER, line);
    return true;
}

#endif

cli_input *cli_input_open(cli_session *s)
{
    cli_input *input = calloc(1, sizeof *input);
    if (!input)
        return NULL;
    input->terminal = isatty(STDIN_FILENO) == 1 && isatty(STDOUT_FILENO) == 1;
#ifdef CLI_WITH_LIBEDIT
    input->session = s;
    if (input->terminal && !open_editor(input)) {
        cli_input_close(input);
        return NULL;
    }
#else
    (void)s;
#endif
    return input;
}

void cli_input_close(cli_input *input)
{
#ifdef CLI_WITH_LIBEDIT
    if (input->editor)
        el_end(input->editor);
    if (input->history)
        history_end(input->history);
#endif
    free(input);
}

bool cli_input_is_terminal(const cli_input *input)
{
    return input->terminal;
}

bool cli_input_read(cli_input *input, const char *prompt, char line[CLI_DEBUG_LINE], bool *interrupted)
{
    *interrupted = false;
#ifdef CLI_WITH_LIBEDIT
    if (input->editor)
        return read_edited(input, prompt, line, interrupted);
#endif
    (void)input;
    return read_plain(prompt, line, interrupted);
}
