/*
 * rheolog debug: a prompt at a place in a recording. debug_commands.c has the table of its commands, debug_look.c those that
 * look, debug_fork.c the place and the fork, debug_input.c reads lines.
 */
#include "cli/debug.h"

#include <errno.h>
#include <string.h>

#include "json/file_name.h"

/* Writes "(bad 18 forces@2) "; a star after the step says that it is one of the fork. */
static void write_prompt(const cli_session *s, char *prompt, size_t size)
{
    char stage[32];
    const unsigned long long step = cli_debug_place(s, stage);
    snprintf(prompt, size, "(%s %llu%s%s%s) ", s->name, step, s->fork.tip ? "*" : "", *stage ? " " : "", stage);
}

static bool is_blank(const char *line)
{
    return line[strspn(line, " \t\r")] == 0;
}

/* Runs a line, or the last one again if it is empty. */
static int run_line(cli_session *s, const char *line)
{
    if (!is_blank(line))
        snprintf(s->last, sizeof s->last, "%s", line);
    cli_watch_keyboard(false);
    cli_watch();
    const cli_cost before = cli_cost_now();
    const int status = is_blank(s->last) ? CLI_DONE : cli_debug_run(s, s->last);
    cli_watch_end();
    fflush(stdout);
    if (s->cost)
        cli_say_cost(before);
    return status;
}

/* ---- Input from a person, or a pipe ---- */

static int run_input(cli_session *s)
{
    char prompt[160], line[CLI_DEBUG_LINE];
    bool interrupted;
    cli_input *input = cli_input_open(s);
    if (!input)
        return cli_fail(CLI_SYSTEM, "no memory");
    while (!s->quit) {
        write_prompt(s, prompt, sizeof prompt);
        cli_watch_keyboard(true);
        const bool more = cli_input_read(input, prompt, line, &interrupted);
        if (interrupted)
            putchar('\n');
        else if (more && !cli_input_is_terminal(input))
            printf("%s\n", line); /* so that the output reads as a session */
        else if (!more)
            putchar('\n');
        fflush(stdout);
        if (!interrupted && !more)
            break;
        if (!interrupted)
            run_line(s, line); /* an error was printed, and does not end the session */
    }
    cli_input_close(input);
    return CLI_DONE;
}

/* ---- Commands from a file ---- */

/* Runs the commands of a file up to its first error. Empty lines and those that begin with # are left out. */
static int run_file(cli_session *s, const char *path)
{
    char line[CLI_DEBUG_LINE], prompt[160], place[CLI_DEBUG_LINE];
    FILE *file = fopen(path, "r");
    int status = file ? CLI_DONE : cli_fail(CLI_BAD, "cannot read %s: %s", path, strerror(errno));
    for (unsigned number = 1; status == CLI_DONE && !s->quit && fgets(line, sizeof line, file); number++) {
        const size_t length = strcspn(line, "\n");
        snprintf(place, sizeof place, "%.200s, line %u: ", path, number);
        cli_say_where(place);
        if (!line[length] && length == sizeof line - 1)
            status = cli_fail(CLI_BAD, "the line is longer than %zu bytes", sizeof line - 2);
        line[length] = 0;
        if (status != CLI_DONE || is_blank(line) || *line == '#')
            continue;
        write_prompt(s, prompt, sizeof prompt);
        printf("%s%s\n", prompt, line);
        fflush(stdout);
        status = run_line(s, line);
        if (status == CLI_DONE && cli_interrupted())
            status = cli_fail(CLI_INTERRUPTED, "interrupted");
    }
    if (file && status == CLI_DONE && ferror(file))
        status = cli_fail(CLI_BAD, "cannot read %s: %s", path, strerror(errno));
    cli_say_where("");
    if (file)
        fclose(file);
    return status;
}

/* ---- The command ---- */

static int debug(cli_session *s, const char *commands)
{
    rheo_error error = {""};
    const rheo_result result = rheo_player_open(s->recording, NULL, &s->player, &error);
    if (result != RHEO_OK)
        return cli_file_error(s->file, result, &error);
    cli_watch_keyboard(false);
    const int status = commands ? run_file(s, commands) : run_input(s);
    cli_debug_fork_release(&s->fork);
    rheo_player_close(s->player);
    return status;
}

static int run(int argc, char **argv)
{
    static cli_session s;
    const char *commands = NULL, *simd = NULL;
    const cli_option options[] = {
        {"--execute", "-x", "FILE", CLI_TEXT, &commands},
        {"--cost", NULL, NULL, CLI_FLAG, &s.cost},
        {"--simd", NULL, "NAME", CLI_TEXT, &simd},
        {0},
    };
    int status = cli_parse(&cli_debug, options, &argc, argv);
    if (status != CLI_GO_ON)
        return status;
    if (argc != 1)
        return cli_usage(&cli_debug, "needs one recording; got %d", argc);
    s.file = argv[0];
    if ((status = cli_use_simd(simd)) != CLI_DONE || (status = cli_open_recording(s.file, &s.recording)) != CLI_DONE)
        return status;
    s.info = rheo_recording_get_info(s.recording);
    snprintf(s.name, sizeof s.name, "%.63s", rheo__json_file_name(s.file));
    if (rheo__json_ends_with(s.name, ".rlog"))
        s.name[strlen(s.name) - 5] = 0;
    status = debug(&s, commands);
    rheo_recording_close(s.recording);
    return status;
}

static const char help[] = {
#include "cli/help/debug.txt.inc"
    0};

const cli_command cli_debug = {"debug", help, run};
