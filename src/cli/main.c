/* The rheolog program: finds the command (commands.def) and runs it. */
#include "cli/cli.h"

#include <errno.h>
#include <string.h>

static const struct {
    const cli_command *command;
    const char *purpose; /* purpose in one line */
} COMMANDS[] = {
#define CLI_COMMAND(name, purpose) {&cli_##name, purpose},
#include "cli/commands.def"
#undef CLI_COMMAND
};

enum { COMMAND_COUNT = sizeof COMMANDS / sizeof COMMANDS[0] };

static const char help[] = {
#include "cli/help/main.txt.inc"
    0};

static const cli_command *find_command(const char *name)
{
    for (size_t i = 0; i < COMMAND_COUNT; i++)
        if (strcmp(COMMANDS[i].command->name, name) == 0)
            return COMMANDS[i].command;
    return NULL;
}

static const char *nearest_command(const char *name)
{
    const char *names[COMMAND_COUNT];
    for (size_t i = 0; i < COMMAND_COUNT; i++)
        names[i] = COMMANDS[i].command->name;
    return rheo_nearest_word(name, names, COMMAND_COUNT);
}

/* Inserts the list of commands after the line `commands:` of the text. */
static void print_help(FILE *file)
{
    const char *list = strstr(help, "\ncommands:\n") + strlen("\ncommands:\n");
    fwrite(help, 1, (size_t)(list - help), file);
    for (size_t i = 0; i < COMMAND_COUNT; i++)
        fprintf(file, "  %-12s %s\n", COMMANDS[i].command->name, COMMANDS[i].purpose);
    fputs(list, file);
}

static int dispatch(int argc, char **argv)
{
    if (argc < 2) {
        print_help(stderr);
        return CLI_BAD;
    }
    const char *name = argv[1];
    if (strcmp(name, "--version") == 0)
        return cli_version(argc - 2, argv + 2);
    if (strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0 || (strcmp(name, "help") == 0 && argc == 2)) {
        print_help(stdout);
        return CLI_DONE;
    }
    const bool asked = strcmp(name, "help") == 0; /* `rheolog help run` is the same as `rheolog run --help` */
    if (asked)
        name = argv[2];
    const cli_command *command = find_command(name);
    if (!command && *name == '-')
        return cli_fail(CLI_BAD, "unknown option %s: a command comes first, unless it is --help or --version", name);
    char suggestion[CLI_SUGGESTION];
    if (!command)
        return cli_fail(CLI_BAD, "unknown command \"%s\"%s (rheolog --help lists them)", name,
                        cli_did_you_mean(name, nearest_command(name), suggestion));
    static char option[] = "--help";
    char *ask[] = {option, NULL};
    return asked ? command->run(1, ask) : command->run(argc - 2, argv + 2);
}

int main(int argc, char **argv)
{
    cli_refuse_large_files();
    int code = dispatch(argc, argv);
    /* A full disk or a closed pipe may be noticed only when the last bytes are written. */
    errno = 0;
    if (fflush(stdout) != 0 || ferror(stdout))
        code = cli_fail(CLI_SYSTEM, "cannot write to standard output: %s",
                        errno ? strerror(errno) : "an earlier write failed");
    return code;
}
