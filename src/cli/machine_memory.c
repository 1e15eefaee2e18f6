/* The memory of this machine, and whether a scene fits into it. Where nothing is known, everything does. */
#define _DEFAULT_SOURCE
#define _POSIX_C_SOURCE 200809L
#include <stdint.h>
#include <string.h>
#include <unistd.h>
#ifndef __wasi__
#include <sys/resource.h>
#endif

#include "cli/run.h"

/* The smallest limit, and what sets it. */
typedef struct limit {
    double bytes; /* 0: none is known */
    const char *of;
} limit;

static void tighten(limit *l, double bytes, const char *of)
{
    if (bytes > 0 && (!(l->bytes > 0) || bytes < l->bytes))
        *l = (limit){bytes, of};
}

#ifdef __linux__
/* The number in a file; 0: there is none, or "max". */
static double number_in(const char *path)
{
    char line[64] = "";
    uint64_t number;
    FILE *file = fopen(path, "r");
    const bool read = file && fgets(line, sizeof line, file);
    if (file)
        fclose(file);
    line[strcspn(line, "\n")] = 0;
    return read && cli_number_from(line, &number) ? (double)number : 0;
}

/* Limits of a control group and those above it, whose folders begin at `root`. */
static void tighten_to_group(limit *l, const char *root, const char *group, const char *name)
{
    char path[1200], folder[1024];
    snprintf(folder, sizeof folder, "%s", group);
    for (;;) {
        snprintf(path, sizeof path, "%s%s/%s", root, strcmp(folder, "/") == 0 ? "" : folder, name);
        tighten(l, number_in(path), "the limit of the control group");
        char *last = strrchr(folder, '/');
        if (!last)
            return;
        *last = 0;
    }
}

/* The groups of this process: "0::/GROUP" in version 2, "9:memory:/GROUP" in version 1. */
static void tighten_to_groups(limit *l)
{
    char line[1024];
    FILE *file = fopen("/proc/self/cgroup", "r");
    while (file && fgets(line, sizeof line, file)) {
        line[strcspn(line, "\n")] = 0;
        const char *kind = strchr(line, ':'), *group = kind ? strchr(kind + 1, ':') : NULL;
        if (!group)
            continue;
        if (group == kind + 1)
            tighten_to_group(l, "/sys/fs/cgroup", group + 1, "memory.max");
        else if (strncmp(kind, ":memory:", 8) == 0)
            tighten_to_group(l, "/sys/fs/cgroup/memory", group + 1, "memory.limit_in_bytes");
    }
    if (file)
        fclose(file);
}
#endif

static limit memory_limit(void)
{
    limit l = {0, ""};
#if defined _SC_PHYS_PAGES && defined _SC_PAGESIZE
    const long pages = sysconf(_SC_PHYS_PAGES), page = sysconf(_SC_PAGESIZE); /* -1: not known */
    tighten(&l, pages > 0 ? (double)pages * (double)page : 0, "the memory of this machine");
#endif
#ifdef RLIMIT_AS
    struct rlimit space = {0};
    if (getrlimit(RLIMIT_AS, &space) == 0 && space.rlim_cur != RLIM_INFINITY)
        tighten(&l, (double)space.rlim_cur, "the limit of the process");
#endif
#ifdef __linux__
    tighten_to_groups(&l);
#endif
    tighten(&l, (double)SIZE_MAX, "the most that this build can use");
    return l;
}

int cli_check_memory(const char *name, const rheo_scene *scene, uint64_t steps)
{
    rheo_memory needed;
    char bytes[32], there[32];
    if (rheo_scene_memory(scene, steps, &needed, NULL) != RHEO_OK)
        return CLI_DONE; /* making the scene says why */
    const limit l = memory_limit();
    if (!(needed.all > l.bytes))
        return CLI_DONE;
    cli_bytes(needed.all, bytes, sizeof bytes);
    cli_bytes(l.bytes, there, sizeof there);
    const char *lower = "lower particles, or raise fluid.spacing";
    if (needed.history > needed.all / 2)
        lower = "lower particles, or history.window and history.lag; history.kind full and tempered need least";
    else if (needed.neighbours > needed.all / 2 && scene->world.model == RHEO_MODEL_THICKENING)
        lower = "lower particles, or fluid.support, which has many neighbours at this spacing";
    return cli_fail(CLI_SYSTEM, "%s needs about %s of memory for %llu particle%s; %s is %s: %s", name, bytes,
                    (unsigned long long)needed.particles, cli_plural(needed.particles), l.of, there, lower);
}
