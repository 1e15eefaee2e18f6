/* Finds the pairs of recordings that `diff` compares (pairs.h). */
#define _POSIX_C_SOURCE 200809L
#define _FILE_OFFSET_BITS 64
#include "cli/pairs.h"

#include <dirent.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "json/file_name.h"

static bool is_folder(const char *path)
{
    struct stat status = {0};
    return stat(path, &status) == 0 && S_ISDIR(status.st_mode);
}

/* Returns "folder/name" in new memory; NULL: no memory. */
static char *join(const char *folder, const char *name)
{
    size_t length = strlen(folder);
    while (length > 1 && folder[length - 1] == '/')
        length--;
    const size_t size = length + strlen(name) + 2;
    char *path = malloc(size);
    if (path)
        snprintf(path, size, "%.*s%s%s", (int)length, folder, strcmp(folder, "/") == 0 ? "" : "/", name);
    return path;
}

/* Appends a pair and owns its paths from now on. NULL stands for a path that had no memory. */
static int add(cli_pairs *pairs, char *a, char *b)
{
    cli_pair *more = realloc(pairs->pair, (pairs->count + 1) * sizeof *more);
    if (more)
        pairs->pair = more;
    if (!more || !a || !b) {
        free(a);
        free(b);
        return cli_fail(CLI_SYSTEM, "no memory");
    }
    pairs->pair[pairs->count++] = (cli_pair){a, b};
    return CLI_DONE;
}

static bool has_name(const cli_pairs *pairs, size_t first, const char *name)
{
    for (size_t i = first; i < pairs->count; i++)
        if (strcmp(rheo__json_file_name(pairs->pair[i].a), name) == 0)
            return true;
    return false;
}

/* Adds the names *.rlog of one of two folders that are not in the pairs from `first` on. */
static int add_names(cli_pairs *pairs, size_t first, const char *listed, const char *a, const char *b)
{
    DIR *folder = opendir(listed);
    if (!folder)
        return cli_fail(CLI_BAD, "cannot read the folder %s: %s", listed, strerror(errno));
    int status = CLI_DONE;
    for (const struct dirent *entry; status == CLI_DONE && (entry = readdir(folder));) {
        const size_t length = strlen(entry->d_name);
        if (length > 5 && strcmp(entry->d_name + length - 5, ".rlog") == 0 && !has_name(pairs, first, entry->d_name))
            status = add(pairs, join(a, entry->d_name), join(b, entry->d_name));
    }
    closedir(folder);
    return status;
}

static int by_name(const void *left, const void *right)
{
    const cli_pair *a = left, *b = right;
    return strcmp(a->a, b->a); /* all are in one folder, and no two names are equal */
}

static int add_folders(cli_pairs *pairs, const char *a, const char *b)
{
    const size_t first = pairs->count;
    int status = add_names(pairs, first, a, a, b);
    if (status == CLI_DONE)
        status = add_names(pairs, first, b, a, b);
    if (status == CLI_DONE && pairs->count == first)
        status = cli_fail(CLI_BAD, "%s and %s have no file *.rlog: nothing was compared", a, b);
    if (status == CLI_DONE)
        qsort(pairs->pair + first, pairs->count - first, sizeof *pairs->pair, by_name);
    return status;
}

int cli_find_pairs(const cli_command *command, int operands, char **operand, cli_pairs *pairs)
{
    if (operands < 2)
        return cli_usage(command, "needs two recordings, or a folder and recordings or another folder; got %d",
                         operands);
    if (operands > 2 && !is_folder(operand[0]))
        return cli_usage(command,
                         "compares several recordings with those in a folder: diff FOLDER NEW...; %s is no folder",
                         operand[0]);
    int status = CLI_DONE;
    for (int i = 1; i < operands && status == CLI_DONE; i++) {
        const char *a = operand[0], *b = operand[i];
        if (is_folder(a) && is_folder(b))
            status = add_folders(pairs, a, b);
        else if (is_folder(a))
            status = add(pairs, join(a, rheo__json_file_name(b)), strdup(b));
        else
            status = add(pairs, strdup(a), is_folder(b) ? join(b, rheo__json_file_name(a)) : strdup(b));
    }
    return status;
}

void cli_release_pairs(cli_pairs *pairs)
{
    for (size_t i = 0; i < pairs->count; i++) {
        free(pairs->pair[i].a);
        free(pairs->pair[i].b);
    }
    free(pairs->pair);
}
