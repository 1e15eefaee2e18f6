/* Words of command lines for a POSIX shell (shell.h). */
#define _POSIX_C_SOURCE 200809L /* open_memstream() */
#include "cli/shell.h"

#include <stdlib.h>
#include <string.h>

#include "rheolog/base.h"

/* No shell changes these. */
static const char PLAIN[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-+=.,:/@%";

void cli_put_word(FILE *file, const char *word)
{
    if (*word && word[strspn(word, PLAIN)] == 0) {
        fprintf(file, " %s", word);
        return;
    }
    fputs(" '", file);
    while (*word) {
        const size_t length = rheo_printable_length(word);
        if (length == 0)
            fputc('?', file);
        else if (*word == '\'')
            fputs("'\\''", file);
        else
            fwrite(word, 1, length, file);
        word += length ? length : 1;
    }
    fputc('\'', file);
}

void cli_put_file(FILE *file, const char *name)
{
    char plain[4096];
    if (*name == '-' && snprintf(plain, sizeof plain, "./%s", name) < (int)sizeof plain)
        name = plain;
    cli_put_word(file, name);
}

const char *cli_file_word(const char *name, char text[CLI_FILE_WORD])
{
    char *word = NULL;
    size_t size;
    FILE *file = open_memstream(&word, &size);
    if (file)
        cli_put_file(file, name);
    const bool good = file && fclose(file) == 0;
    snprintf(text, CLI_FILE_WORD, "%s", good ? word + 1 : name); /* without the blank */
    free(word);
    return text;
}

void cli_print_command(const char *begin, const char *file)
{
    fputs(begin, stdout);
    cli_put_file(stdout, file);
}

bool cli_next_word(const char **at, char *word, size_t size)
{
    const char *from = *at + strspn(*at, " ");
    size_t used = 0;
    if (!*from)
        return false;
    bool quoted = false;
    for (; *from && (quoted || *from != ' '); from++) {
        if (*from == '\'') {
            quoted = !quoted;
            continue;
        }
        if (!quoted && from[0] == '\\' && from[1] == '\'')
            from++;
        else if (!quoted && !strchr(PLAIN, *from))
            return false;
        if (used + 1 >= size)
            return false;
        word[used++] = *from;
    }
    word[used] = 0;
    *at = quoted ? *at : from;
    return !quoted;
}
