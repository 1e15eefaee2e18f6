/* Names of files, for scene files and the program. */
#ifndef RHEOLOG_JSON_FILE_NAME_H
#define RHEOLOG_JSON_FILE_NAME_H

#include <stdbool.h>
#include <string.h>

/* The name without folders; it is the end of the path. */
static inline const char *rheo__json_file_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

/* Whether a name has this ending and more. */
static inline bool rheo__json_ends_with(const char *name, const char *ending)
{
    const size_t length = strlen(name), of_ending = strlen(ending);
    return length > of_ending && strcmp(name + length - of_ending, ending) == 0;
}

#endif
