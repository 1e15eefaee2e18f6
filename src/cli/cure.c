/* Command lines that try a cure of the doctor, for a POSIX shell. */
#define _POSIX_C_SOURCE 200809L /* open_memstream() */
#include "cli/cure.h"

#include <stdlib.h>
#include <string.h>

#include "cli/run.h"
#include "cli/shell.h"
#include "rheolog/scene_json.h"

static void put_set(FILE *file, const char *path, const char *value)
{
    char word[256];
    snprintf(word, sizeof word, "%s=%s", path, value);
    fputs(" --set", file);
    cli_put_word(file, word);
}

/* The step that a cure reaches, at least as many steps after the sign as a continued one makes. */
static uint64_t steps_from(const rheo_diagnosis *d, uint64_t from)
{
    const uint64_t least = d->sign_step + CLI_CURE_STEPS / 2;
    return from + CLI_CURE_STEPS > least ? CLI_CURE_STEPS : least - from;
}

/* Gives the commands again that preceded the first step, because a run that continues before them lacks them. */
static void put_commands(FILE *file, const rheo_diagnosis *d, const rheo_advice *a)
{
    const size_t length = strcspn(a->set, "=");
    for (uint32_t i = 0; i < d->suspect_count && i < RHEO_MAX_SUSPECTS; i++) {
        const rheo_command *c = &d->suspects[i];
        const bool replaced = strlen(c->path) == length && strncmp(c->path, a->set, length) == 0;
        if (c->step == a->from + 1 && c->kind == RHEO_COMMAND_SET && !replaced)
            put_set(file, c->path, c->value);
    }
}

static void put_word(FILE *file, const char *word)
{
    if (file)
        cli_put_word(file, word);
}

/*
 * Writes the command again that ran a built-in scene, word by word: the recording may come from anyone, and people
 * give the line to a shell. False: it is no command that `rheolog run` stores. file: NULL if nobody wants it.
 */
static bool put_made_by(FILE *file, const char *made_by)
{
    static const char begin[] = "rheolog run";
    char word[512];
    if (strncmp(made_by, begin, strlen(begin)) != 0)
        return false;
    const char *at = made_by + strlen(begin);
    if (!cli_next_word(&at, word, sizeof word) || !cli_is_builtin(word))
        return false;
    if (file)
        fputs(begin, file);
    put_word(file, word);
    while (cli_next_word(&at, word, sizeof word)) {
        const bool full = strcmp(word, "--full") == 0;
        if (!full && strcmp(word, "--set") != 0 && strcmp(word, "--keyframes") != 0 &&
            strcmp(word, "--max-size") != 0)
            return false;
        put_word(file, word);
        if (!full && !cli_next_word(&at, word, sizeof word))
            return false;
        if (!full)
            put_word(file, word);
    }
    return *at == 0;
}

/* Makes the scene of such a command. False: it is another command. */
static bool scene_of_command(const char *made_by, rheo_scene *scene)
{
    char word[512];
    const char *at = made_by + strlen("rheolog run");
    if (!put_made_by(NULL, made_by) || !cli_next_word(&at, word, sizeof word) ||
        rheo_scene_builtin(word, scene, NULL) != RHEO_OK)
        return false;
    bool good = true;
    while (good && cli_next_word(&at, word, sizeof word)) {
        if (strcmp(word, "--set") != 0)
            continue;
        char *value = cli_next_word(&at, word, sizeof word) ? strchr(word, '=') : NULL;
        if (value)
            *value++ = 0;
        good = value && rheo_scene_set(scene, word, value, NULL) == RHEO_OK;
    }
    if (!good)
        rheo_scene_release(scene);
    return good;
}

bool cli_recorded_scene(const rheo_recording *recording, rheo_scene *scene)
{
    const rheo_recording_info info = rheo_recording_get_info(recording);
    const char *text = info.scene_text;
    return scene_of_command(info.made_by, scene) ||
           (text[0] && rheo_scene_from_json(text, strlen(text), "again.json", scene, NULL) == RHEO_OK);
}

bool cli_cure_possible(const cli_doctor_case *c, const rheo_advice *a)
{
    rheo_scene scene;
    const char *value = strchr(a->set, '=');
    if (a->can_continue || !value || c->diagnosis->first_step > 0 || !cli_recorded_scene(c->recording, &scene))
        return true;
    char path[sizeof a->set];
    snprintf(path, sizeof path, "%.*s", (int)(value - a->set), a->set);
    const bool possible =
        rheo_scene_set(&scene, path, value + 1, NULL) == RHEO_OK && rheo_scene_check(&scene, NULL) == RHEO_OK;
    rheo_scene_release(&scene);
    return possible;
}

/* That command from malloc, or NULL. */
static char *made_again(const char *made_by)
{
    char *text = NULL;
    size_t size;
    FILE *file = open_memstream(&text, &size);
    if (!file)
        return NULL;
    const bool good = put_made_by(file, made_by);
    if (fclose(file) == 0 && good)
        return text;
    free(text);
    return NULL;
}

/* Writes how to make the scene again, up to the steps. */
static bool put_scene_again(FILE *file, const cli_doctor_case *c)
{
    const rheo_recording_info info = rheo_recording_get_info(c->recording);
    char *made = made_again(info.made_by);
    if (made) {
        fputs(made, file);
    } else if (info.scene_text[0]) {
        fputs("rheolog log", file);
        cli_put_file(file, c->file);
        fputs(" --scene > again.json && rheolog run again.json", file);
    }
    const bool can = made || info.scene_text[0];
    free(made);
    return can;
}

static bool put_cure(FILE *file, const cli_doctor_case *c, const rheo_advice *a)
{
    const rheo_diagnosis *d = c->diagnosis;
    char word[CLI_COMMAND_LINE];
    if (a->can_continue) {
        snprintf(word, sizeof word, "%s@%llu", c->file, (unsigned long long)a->from);
        fputs("rheolog run --from", file);
        cli_put_file(file, word);
    } else if (!a->set[0] || d->first_step > 0 || d->suspect_count || !put_scene_again(file, c)) {
        return false; /* or commands would be missing */
    }
    fprintf(file, " --steps %llu", (unsigned long long)steps_from(d, a->can_continue ? a->from : 0));
    if (a->set[0]) {
        if (a->can_continue)
            put_commands(file, d, a);
        fputs(" --set", file);
        cli_put_word(file, a->set);
    }
    fprintf(file, " -o cured%s.rlog --force", strcmp(c->file, "cured.rlog") == 0 ? "-2" : "");
    return true;
}

bool cli_cure(const cli_doctor_case *c, const rheo_advice *a, char *text, size_t size)
{
    char *line = NULL;
    size_t length = 0;
    FILE *file = open_memstream(&line, &length);
    if (!file)
        return false;
    bool good = put_cure(file, c, a);
    good = fclose(file) == 0 && good && length < size;
    if (good)
        memcpy(text, line, length + 1);
    free(line);
    return good;
}
