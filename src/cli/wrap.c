/* Wraps text for people at the width of their terminal. */
#define _DEFAULT_SOURCE
#define _POSIX_C_SOURCE 200809L
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#ifndef __wasi__
#include <sys/ioctl.h>
#endif

#include "cli/cli.h"

enum { UNKNOWN = 80, LEAST = 20 };

unsigned cli_width(FILE *file)
{
    unsigned width = 0;
    if (isatty(fileno(file)) != 1)
        return 0;
    const char *columns = getenv("COLUMNS");
    uint64_t number;
    if (columns && cli_number_from(columns, &number) && number < 100000)
        width = (unsigned)number;
#ifdef TIOCGWINSZ
    struct winsize size;
    if (!width && ioctl(fileno(file), TIOCGWINSZ, &size) == 0)
        width = size.ws_col;
#endif
    return !width ? UNKNOWN : width < LEAST ? LEAST : width;
}

/* Number of characters of UTF-8 text. */
static size_t characters(const char *text, size_t length)
{
    size_t count = 0;
    for (size_t i = 0; i < length; i++)
        count += ((unsigned char)text[i] & 0xc0) != 0x80;
    return count;
}

void cli_wrap(FILE *file, const char *text, size_t width, size_t indent, size_t column)
{
    while (*text) {
        const size_t blanks = strspn(text, " "), length = strcspn(text + blanks, " \n");
        const size_t end = column + blanks + characters(text + blanks, length);
        const bool breaks = width && column > indent && length && end > width;
        if (breaks)
            fprintf(file, "\n%*s", (int)indent, "");
        else
            fwrite(text, 1, blanks, file);
        fwrite(text + blanks, 1, length, file);
        column = breaks ? indent + characters(text + blanks, length) : end;
        text += blanks + length;
        if (*text == '\n') {
            fputc('\n', file);
            column = 0;
            text++;
        }
    }
}

void cli_vprint(FILE *file, size_t indent, size_t column, const char *format, va_list arguments)
{
    va_list again;
    char most[2048], *text = most;
    va_copy(again, arguments);
    const int length = vsnprintf(most, sizeof most, format, arguments);
    if (length >= (int)sizeof most && (text = malloc((size_t)length + 1)))
        vsnprintf(text, (size_t)length + 1, format, again);
    if (!text)
        text = most;
    cli_wrap(file, text, cli_width(file), indent, column);
    if (text != most)
        free(text);
    va_end(again);
}

void cli_print(FILE *file, size_t indent, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    cli_vprint(file, indent, 0, format, arguments);
    va_end(arguments);
}
