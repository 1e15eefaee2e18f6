/* Command lines that try a cure of the doctor, for a POSIX shell. */
#include "cli/cure.h"

#include <stdarg.h>
#include <string.h>

__attribute__((format(printf, 3, 4))) static void add(char *text, size_t size, const char *format, ...)
{
    const size_t used = strlen(text);
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text + used, size - used, format, arguments);
    va_end(arguments);
}

/* The quote that a shell needs around a text. */
static const char *quote_for(const char *text)
{
    return strpbrk(text, " []();&|<>$`\"\\*?#~") ? "'" : "";
}

static void add_set(char *text, size_t size, const char *path, const char *value)
{
    const char *quote = quote_for(value);
    add(text, size, " --set %s%s=%s%s", quote, path, value, quote);
}

/* The step that a cure reaches, at least as many steps after the sign as a continued one makes. */
static uint64_t steps_from(const rheo_diagnosis *d, uint64_t from)
{
    const uint64_t least = d->sign_step + CLI_CURE_STEPS / 2;
    return from + CLI_CURE_STEPS > least ? CLI_CURE_STEPS : least - from;
}

/* Gives the commands again that preceded the first step, because a run that continues before them lacks them. */
static void add_commands(const rheo_diagnosis *d, const rheo_advice *a, char *text, size_t size)
{
    const size_t length = strcspn(a->set, "=");
    for (uint32_t i = 0; i < d->suspect_count && i < RHEO_MAX_SUSPECTS; i++) {
        const rheo_command *c = &d->suspects[i];
        const bool replaced = strlen(c->path) == length && strncmp(c->path, a->set, length) == 0;
        if (c->step == a->from + 1 && c->kind == RHEO_COMMAND_SET && !replaced)
            add_set(text, size, c->path, c->value);
    }
}

/* The scene of the recording is a built-in one, whose command can be given again as it was. */
static bool is_builtin(const char *made_by)
{
    static const char begin[] = "rheolog run ";
    if (strncmp(made_by, begin, strlen(begin)) != 0)
        return false;
    char name[128];
    rheo_scene scene;
    snprintf(name, sizeof name, "%.*s", (int)strcspn(made_by + strlen(begin), " "), made_by + strlen(begin));
    if (rheo_scene_builtin(name, &scene, NULL) != RHEO_OK)
        return false;
    rheo_scene_release(&scene);
    return true;
}

bool cli_cure(const cli_doctor_case *c, const rheo_advice *a, char *text, size_t size)
{
    const rheo_recording_info info = rheo_recording_get_info(c->recording);
    const rheo_diagnosis *d = c->diagnosis;
    const char *quote = quote_for(c->file);
    text[0] = 0;
    if (a->can_continue) {
        add(text, size, "rheolog run --from %s%s@%llu%s --steps %llu", quote, c->file, (unsigned long long)a->from,
            quote, (unsigned long long)steps_from(d, a->from));
        if (a->set[0])
            add_commands(d, a, text, size);
    } else if (!a->set[0] || d->first_step > 0 || d->suspect_count) { /* or its commands would be missing */
        return false;
    } else if (is_builtin(info.made_by)) {
        add(text, size, "%s --steps %llu", info.made_by, (unsigned long long)steps_from(d, 0));
    } else if (info.scene_text[0]) {
        add(text, size, "rheolog log %s%s%s --scene > again.json && rheolog run again.json --steps %llu", quote,
            c->file, quote, (unsigned long long)steps_from(d, 0));
    } else {
        return false;
    }
    if (a->set[0]) {
        char path[64];
        snprintf(path, sizeof path, "%.*s", (int)strcspn(a->set, "="), a->set);
        add_set(text, size, path, a->set + strlen(path) + 1);
    }
    add(text, size, " -o cured%s.rlog --force", strcmp(c->file, "cured.rlog") == 0 ? "-2" : "");
    return strlen(text) + 1 < size;
}
