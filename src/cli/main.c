/* The rheolog program: finds the command and runs it. Each command is a file of its own beside this one. */
#include "cli/cli.h"

#include <errno.h>
#include <string.h>

#include "cli/scene_json.h"

static const cli_command *const commands[] = {&cli_scenes,     &cli_run,     &cli_verify, &cli_diff,
                                              &cli_bless,      &cli_doctor,  &cli_info,   &cli_inspect,
                                              &cli_checkpoint, &cli_metrics, &cli_export, &cli_bench};

enum { COMMANDS = sizeof commands / sizeof commands[0] };

static const cli_command *find_command(const char *name)
{
    for (size_t i = 0; i < COMMANDS; i++)
        if (strcmp(commands[i]->name, name) == 0)
            return commands[i];
    return NULL;
}

static const char *nearest_command(const char *name)
{
    const char *nearest = commands[0]->name;
    for (size_t i = 1; i < COMMANDS; i++)
        if (cli_word_distance(name, commands[i]->name) < cli_word_distance(name, nearest))
            nearest = commands[i]->name;
    return nearest;
}

static void print_help(FILE *file)
{
    fputs(
        "rheolog simulates shear-thickening particle fluids, such as cornstarch in water, and solids that melt, in\n"
        "fixed steps and reproducibly to the last bit. It records a run, so that the run can be replayed, verified "
        "step by "
        "step\n"
        "(a recording kept in a repository makes a test), and resumed from any step.\n"
        "\n"
        "usage: rheolog COMMAND [options]\n"
        "\n"
        "commands:\n",
        file);
    for (size_t i = 0; i < COMMANDS; i++)
        fprintf(file, "  %-12s %s\n", commands[i]->name, commands[i]->about);
    fputs("\n"
          "rheolog COMMAND --help says more. rheolog --version prints the version and how it was built.\n"
          "\n"
          "a first run, recorded and verified:\n"
          "  rheolog scenes\n"
          "  rheolog run bowling-ball-small --steps 100 -o first.rlog\n"
          "  rheolog verify first.rlog\n"
          "\n"
          "Results go to standard output, progress and messages to standard error. Units: any consistent set; "
          "L is\n"
          "the unit of length, T of time. Y is up. Step 0 is the initial state.\n"
          "exit codes: 0 done, same; 1 differs, or the state went bad; 2 bad usage or bad input; 3 the system\n"
          "failed (disk, memory)\n",
          file);
}

static int dispatch(int argc, char **argv)
{
    if (argc < 2) {
        print_help(stderr);
        return CLI_BAD;
    }
    const char *name = argv[1];
    if (strcmp(name, "--version") == 0) {
        printf("rheolog %s\n%s\nsimd:", rheo_version(), rheo_build());
        for (uint32_t i = 0; rheo_simd_available(i); i++)
            printf(" %s", rheo_simd_available(i));
        printf(" (in use: %s)\n", rheo_simd());
        return CLI_DONE;
    }
    if (strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0 || (strcmp(name, "help") == 0 && argc == 2)) {
        print_help(stdout);
        return CLI_DONE;
    }
    const bool help = strcmp(name, "help") == 0; /* rheolog help run = rheolog run --help */
    if (help)
        name = argv[2];
    const cli_command *command = find_command(name);
    if (!command)
        return cli_fail(CLI_BAD, "unknown command \"%s\"; did you mean \"%s\"? (rheolog --help lists them)", name,
                        nearest_command(name));
    static char option[] = "--help";
    char *ask[] = {option, NULL};
    return help ? command->run(1, ask) : command->run(argc - 2, argv + 2);
}

int main(int argc, char **argv)
{
    int code = dispatch(argc, argv);
    /* A result that did not reach its reader is no result. */
    errno = 0;
    if (fflush(stdout) != 0 || ferror(stdout))
        code = cli_fail(CLI_SYSTEM, "cannot write to standard output: %s",
                        errno ? strerror(errno) : "an earlier write failed");
    return code;
}
