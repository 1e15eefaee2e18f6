#define _POSIX_C_SOURCE 200809L
#include "fuzz_support.h"

#include <dirent.h>
#include <string.h>

uint8_t *read_file(const char *path, size_t *size)
{
    FILE *file = fopen(path, "rb");
    HOLDS(file);
    fseek(file, 0, SEEK_END);
    long end = ftell(file);
    HOLDS(end >= 0);
    rewind(file);
    uint8_t *bytes = malloc((size_t)end + 1);
    HOLDS(fread(bytes, 1, (size_t)end, file) == (size_t)end);
    fclose(file);
    *size = (size_t)end;
    return bytes;
}

#ifdef RHEO__LIBFUZZER

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    drive(bytes, size);
    return 0;
}

#endif

static size_t read_path(const char *path)
{
    size_t size, files = 0;
    DIR *folder = opendir(path);
    if (!folder) {
        uint8_t *bytes = read_file(path, &size), *exact = malloc(size ? size : 1);
        memcpy(exact, bytes, size); /* a block of the exact size, so that reading past the end is found */
        free(bytes);
        drive(exact, size);
        free(exact);
        return 1;
    }
    for (const struct dirent *entry; (entry = readdir(folder)) != NULL;) {
        char file[1024];
        snprintf(file, sizeof file, "%s/%s", path, entry->d_name);
        if (entry->d_name[0] != '.')
            files += read_path(file);
    }
    closedir(folder);
    return files;
}

int read_arguments(int argc, char **argv, const char *inputs)
{
    size_t files = 0;
    for (int i = 1; i < argc; i++)
        files += read_path(argv[i]);
    printf("%zu %s read\n", files, inputs);
    return files == 0;
}
