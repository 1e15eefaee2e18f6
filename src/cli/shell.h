/* Words of command lines for a POSIX shell. */
#ifndef CLI_SHELL_H
#define CLI_SHELL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/* Prints the begin of a command line and the name of a file. */
void cli_print_command(const char *begin, const char *file);
/* Writes a blank and a word, in quotes if a shell would change it. Bytes that are not printable become '?'. */
void cli_put_word(FILE *file, const char *word);

/* Does so with the name of a file, which is not taken for an option. */
void cli_put_file(FILE *file, const char *name);

enum { CLI_FILE_WORD = 4096 };
/* The name of a file as a word of a command line within a message; returns `text`. */
const char *cli_file_word(const char *name, char text[CLI_FILE_WORD]);

/*
 * Reads the next word that cli_put_word() wrote and moves *at past it. False at the end, or if it is too long or not
 * such a word, which leaves *at where it is.
 */
bool cli_next_word(const char **at, char *word, size_t size);

#endif
