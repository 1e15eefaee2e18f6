/* The process of a benchmark: its core, processor, compiler and memory. */
#ifdef __linux__
#define _GNU_SOURCE /* declares sched_setaffinity() */
#else
#define _POSIX_C_SOURCE 200809L
#endif
#include "cli/bench.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>
#ifdef __linux__
#include <sched.h>
#endif
#if !defined(__wasi__)
#include <sys/resource.h>
#endif

/* ---- The machine ---- */

int cli_bench_pin(void)
{
    int cpu = -1;
#ifdef __linux__
    /* The system has put the process on a free core, so it can stay there. */
    cpu = sched_getcpu();
    cpu_set_t set;
    if (cpu < 0 || cpu >= CPU_SETSIZE)
        return -1;
    CPU_ZERO(&set);
    CPU_SET(cpu, &set);
    (void)sched_setaffinity(0, sizeof set, &set); /* a failure only adds noise to the measurement */
#endif
    return cpu;
}

const char *cli_bench_machine(void)
{
    static char name[96];
    if (name[0])
        return name;
    FILE *file = fopen("/proc/cpuinfo", "r");
    char line[256];
    while (file && !name[0] && fgets(line, sizeof line, file)) {
        const char *value = strchr(line, ':');
        if (strncmp(line, "model name", 10) == 0 && value && value[1] && value[2] != '\n')
            snprintf(name, sizeof name, "%.*s", (int)strcspn(value + 2, "\n"), value + 2);
    }
    if (file)
        fclose(file);
    if (!name[0])
        snprintf(name, sizeof name, "%s", strrchr(rheo_build(), ',') + 2);
    return name;
}

/* ---- Memory of the process ---- */

#ifdef __linux__
static size_t status_bytes(const char *key)
{
    FILE *file = fopen("/proc/self/status", "r");
    char line[256];
    size_t bytes = 0;
    while (file && fgets(line, sizeof line, file))
        if (strncmp(line, key, strlen(key)) == 0)
            bytes = (size_t)strtoull(line + strlen(key), NULL, 10) * 1024;
    if (file)
        fclose(file);
    return bytes;
}
#endif

size_t cli_bench_peak_memory(void)
{
#ifdef __linux__
    const size_t peak = status_bytes("VmHWM:");
    if (peak)
        return peak;
#endif
#ifndef __wasi__
    struct rusage usage;
    const size_t unit =
#ifdef __APPLE__
        1;
#else
        1024;
#endif
    if (getrusage(RUSAGE_SELF, &usage) == 0)
        return (size_t)usage.ru_maxrss * unit;
#endif
    return 0;
}

size_t cli_bench_reset_peak_memory(void)
{
#ifdef __linux__
    FILE *file = fopen("/proc/self/clear_refs", "w");
    if (file) {
        fputs("5", file);
        fclose(file);
    }
    const size_t now = status_bytes("VmRSS:");
    if (now)
        return now;
#endif
    return cli_bench_peak_memory();
}

/* ---- Memory of the library ---- */

enum { COUNT_HEAD = 64 }; /* bytes in front of each block that hold its size; a multiple of any alignment */

static size_t counted;

static void *count_allocate(size_t bytes, void *user)
{
    (void)user;
    char *memory = bytes <= SIZE_MAX - COUNT_HEAD ? malloc(bytes + COUNT_HEAD) : NULL;
    if (!memory)
        return NULL;
    memcpy(memory, &bytes, sizeof bytes);
    counted += bytes;
    return memory + COUNT_HEAD;
}

static void count_release(void *memory, void *user)
{
    (void)user;
    char *start = (char *)memory - COUNT_HEAD;
    size_t bytes;
    memcpy(&bytes, start, sizeof bytes);
    counted -= bytes;
    free(start);
}

rheo_allocator cli_bench_allocator(void)
{
    return (rheo_allocator){count_allocate, count_release, NULL};
}

size_t cli_bench_allocated(void)
{
    return counted;
}
