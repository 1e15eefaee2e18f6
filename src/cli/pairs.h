/* The pairs of recordings that `diff` compares: two files, or files of the same name in two folders. */
#ifndef CLI_PAIRS_H
#define CLI_PAIRS_H

#include "cli/cli.h"

typedef struct cli_pair {
    char *a, *b; /* paths; one of the two files may not exist */
} cli_pair;

typedef struct cli_pairs {
    cli_pair *pair;
    size_t count;
} cli_pairs;

/*
 * Finds the pairs for the operands: A B, where either may be a folder that has a file with the name of the other; or
 * FOLDER B..., where a B that is a folder stands for all names *.rlog of both folders, in the order of the names.
 * Prints a message unless it returns CLI_DONE. Release the pairs in either case.
 */
int cli_find_pairs(const cli_command *command, int operands, char **operand, cli_pairs *pairs);
void cli_release_pairs(cli_pairs *pairs);

#endif
