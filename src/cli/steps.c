/* Steps of a recording that a command writes, one file or several for each. */
#define _POSIX_C_SOURCE 200809L
#define _FILE_OFFSET_BITS 64
#include "cli/steps.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "json/file_name.h"

/* ---- Options ---- */

bool cli_steps_are_several(const cli_steps *steps)
{
    return steps->list || steps->every.given || steps->from.given || steps->to.given;
}

/* Reads N,N,... */
static int read_list(const cli_command *command, cli_steps *steps)
{
    const char *text = steps->list;
    for (steps->count = 0; text; steps->count++) {
        char word[32];
        const size_t length = strcspn(text, ","), i = (size_t)steps->count;
        if (i == CLI_MOST_STEPS)
            return cli_usage(command, "--steps takes at most %d steps", CLI_MOST_STEPS);
        snprintf(word, sizeof word, "%.*s", length < sizeof word ? (int)length : 0, text);
        if (!cli_number_from(word, &steps->at[i]) || (i > 0 && steps->at[i] <= steps->at[i - 1]))
            return cli_usage(command, "--steps needs whole numbers that ascend, such as 0,20,50; got \"%s\"",
                             steps->list);
        text = text[length] ? text + length + 1 : NULL;
    }
    return CLI_DONE;
}

int cli_check_steps(const cli_command *command, cli_steps *steps)
{
    if (steps->step.given && cli_steps_are_several(steps))
        return cli_usage(command, "--step N is one step; it does not go with --steps, --every, --from and --to");
    if (steps->list && (steps->every.given || steps->from.given || steps->to.given))
        return cli_usage(command, "--steps lists all steps; it does not go with --every, --from and --to");
    if (steps->stage && !steps->step.given)
        return cli_usage(command, "--stage needs --step N: the step that the stage belongs to");
    if (steps->list)
        return read_list(command, steps);
    if (steps->every.given && steps->every.value == 0)
        return cli_usage(command, "--every needs 1 or more; got 0");
    return CLI_DONE;
}

static int check_step(const char *path, const rheo_recording *recording, const char *option, const cli_number *step)
{
    return step->given ? cli_check_step(path, recording, option, step->value) : CLI_DONE;
}

int cli_choose_steps(const char *path, const rheo_recording *recording, cli_steps *steps)
{
    const rheo_recording_info info = rheo_recording_get_info(recording);
    int status = CLI_DONE;
    for (uint64_t i = 0; steps->list && i < steps->count && status == CLI_DONE; i++)
        status = cli_check_step(path, recording, "--steps", steps->at[i]);
    if (steps->list) {
        steps->first = steps->at[0];
        steps->last = steps->at[steps->count - 1];
        return status;
    }
    status = check_step(path, recording, "--step", &steps->step);
    if (status == CLI_DONE)
        status = check_step(path, recording, "--from", &steps->from);
    if (status == CLI_DONE)
        status = check_step(path, recording, "--to", &steps->to);
    if (status != CLI_DONE)
        return status;
    steps->last = steps->step.given ? steps->step.value : steps->to.given ? steps->to.value : info.last_step;
    steps->first = steps->from.given              ? steps->from.value
                   : cli_steps_are_several(steps) ? info.first_step
                                                  : steps->last;
    steps->apart = steps->every.given ? steps->every.value : 1;
    if (steps->first > steps->last)
        return cli_fail(CLI_BAD, "--from %llu is greater than --to %llu", (unsigned long long)steps->first,
                        (unsigned long long)steps->last);
    steps->count = (steps->last - steps->first) / steps->apart + 1;
    return CLI_DONE;
}

uint64_t cli_step_at(const cli_steps *steps, uint64_t index)
{
    return steps->list ? steps->at[index] : steps->first + index * steps->apart;
}

int cli_read_number(const cli_command *command, const char *option, const char *text, double minimum, double maximum,
                    bool inside, double *value)
{
    char *end = NULL;
    const double number = text ? strtod(text, &end) : *value;
    const bool read = !text || (*text && *end == 0 && strspn(text, "+-.0123456789eE") == strlen(text));
    if (!read || !(inside ? number > minimum && number < maximum : number >= minimum && number <= maximum))
        return cli_usage(command, "%s needs a number %s %g and %g; got \"%s\"", option,
                         inside ? "strictly between" : "between", minimum, maximum, text);
    *value = number;
    return CLI_DONE;
}

int cli_read_numbers(const cli_command *command, const char *option, const char *text, uint32_t count, double limit,
                     double *value)
{
    for (uint32_t i = 0; i < count; i++) {
        char word[64] = "";
        const size_t length = strcspn(text, ",");
        if ((text[length] == ',') != (i + 1 < count))
            return cli_usage(command, "%s needs %u numbers with commas between them", option, count);
        if (length < sizeof word)
            memcpy(word, text, length);
        const int status = cli_read_number(command, option, word, -limit, limit, false, &value[i]);
        if (status != CLI_DONE)
            return status;
        text += length + 1;
    }
    return CLI_DONE;
}

int cli_read_range(const cli_command *command, const char *text, double range[2])
{
    if (!strchr(text, ','))
        return cli_usage(command, "--range needs MIN,MAX, as 0,2.5; got \"%s\"", text);
    const int status = cli_read_numbers(command, "--range", text, 2, 1e30, range);
    if (status == CLI_DONE && !(range[0] < range[1]))
        return cli_usage(command, "--range needs MIN below MAX; got \"%s\"", text);
    return status;
}

/* ---- Files ---- */

int cli_choose_name(const char *recording, const char *folder, char name[CLI_FILE_NAME])
{
    const char *base = rheo__json_file_name(recording);
    const size_t length = strlen(base) - (rheo__json_ends_with(base, ".rlog") ? strlen(".rlog") : 0);
    if (length > 200 || strlen(folder) > 4095)
        return cli_fail(CLI_BAD, "the names %s and %s are too long to be those of files together", folder, base);
    memcpy(name, base, length);
    name[length] = 0;
    return CLI_DONE;
}

int cli_make_folder(const char *folder)
{
    struct stat status = {0};
    if (mkdir(folder, 0777) != 0 && errno != EEXIST)
        return cli_fail(errno == ENOSPC || errno == EDQUOT ? CLI_SYSTEM : CLI_BAD, "cannot make the folder %s: %s",
                        folder, strerror(errno));
    if (stat(folder, &status) != 0 || !S_ISDIR(status.st_mode))
        return cli_fail(CLI_BAD, "cannot write to %s: it is not a folder", folder);
    if (access(folder, W_OK) != 0)
        return cli_fail(CLI_BAD, "cannot write to the folder %s: %s", folder, strerror(errno));
    return CLI_DONE;
}

int cli_refuse_existing(const char *path, bool force)
{
    struct stat status = {0};
    if (lstat(path, &status) != 0)
        return CLI_DONE;
    if (stat(path, &status) != 0 || !S_ISREG(status.st_mode))
        return cli_fail(CLI_BAD, "%s exists and leads to no regular file, so it cannot be replaced", path);
    if (!force)
        return cli_fail(CLI_BAD, "%s exists; give --force to replace it, or another name after -o", path);
    return CLI_DONE;
}

int cli_results_path(const char *folder, const char *name, const char *ending, char path[CLI_FILE_PATH])
{
    const int length = snprintf(path, CLI_FILE_PATH, "%s/%s%s", folder, name, ending);
    return length < CLI_FILE_PATH ? CLI_DONE
                                  : cli_fail(CLI_BAD, "the name after -o is too long: %zu bytes", strlen(folder));
}

int cli_check_results(const char *folder, const char *name, bool plot)
{
    static const char *const ENDINGS[] = {".csv", ".svg"};
    int status = CLI_DONE;
    for (size_t i = 0; i < 1 + (size_t)plot && status == CLI_DONE; i++) {
        char path[CLI_FILE_PATH];
        if ((status = cli_results_path(folder, name, ENDINGS[i], path)) == CLI_DONE &&
            (status = cli_refuse_existing(path, true)) == CLI_DONE)
            status = cli_check_folder(path);
    }
    return status;
}

/* ---- Steps ---- */

int cli_seek(const char *path, const cli_steps *steps, rheo_player *player, uint64_t index)
{
    rheo_error error = {""};
    const uint64_t step = cli_step_at(steps, index);
    const rheo_result result = steps->stage ? rheo_player_seek_stage(player, step, steps->stage, &error)
                                            : rheo_player_seek(player, step, &error);
    return result == RHEO_OK ? CLI_DONE : cli_file_error(path, result, &error);
}

int cli_find_extent(const char *path, const cli_steps *steps, rheo_player *player, rheo_extent *extent)
{
    rheo_extent of[2];
    for (int end = 1; end >= 0; end--) {
        const int status = cli_seek(path, steps, player, end ? steps->count - 1 : 0);
        if (status != CLI_DONE)
            return status;
        of[end] = rheo_world_extent(rheo_player_world(player));
    }
    *extent = rheo_extent_of_both(&of[0], &of[1]);
    return CLI_DONE;
}

int cli_find_range(const cli_steps *steps, rheo_player *player, cli_write_step *go, void *data,
                   const rheo_picture_options *options, double range[2])
{
    const uint64_t index[3] = {steps->count - 1, steps->count / 2, 0};
    for (int i = 0; i < 3; i++) {
        rheo_error error = {""};
        double its[2];
        const int status = go(data, player, index[i]);
        if (status != CLI_DONE)
            return status;
        const rheo_result result = rheo_world_colour_range(rheo_player_world(player), options, its, &error);
        if (result != RHEO_OK)
            return cli_error(result, &error);
        range[0] = i == 0 || its[0] < range[0] ? its[0] : range[0];
        range[1] = i == 0 || its[1] > range[1] ? its[1] : range[1];
    }
    return CLI_DONE;
}

int cli_write_steps(const char *path, const cli_steps *steps, rheo_player *player, cli_write_step *write, void *data)
{
    cli_progress progress = cli_progress_begin(cli_now());
    int status = CLI_DONE;
    for (uint64_t i = 0; i < steps->count && status == CLI_DONE; i++) {
        if (cli_interrupted()) {
            cli_progress_end(&progress);
            return cli_fail(CLI_INTERRUPTED, "interrupted after %llu of %llu step%s", (unsigned long long)i,
                            (unsigned long long)steps->count, cli_plural(steps->count));
        }
        status = cli_seek(path, steps, player, i);
        if (status == CLI_DONE)
            status = write(data, player, i);
        const double now = cli_now();
        if (status == CLI_DONE && cli_progress_due(&progress, now))
            cli_progress_say(&progress, now, "step %llu: %llu of %llu step%s",
                             (unsigned long long)cli_step_at(steps, i), (unsigned long long)(i + 1),
                             (unsigned long long)steps->count, cli_plural(steps->count));
    }
    cli_progress_end(&progress);
    return status;
}

/* ---- Stages ---- */

void cli_stage_run_name(const rheo_world *world, uint32_t stage, uint32_t *last, char name[CLI_STAGE_NAME])
{
    rheo_stage_info info = {0};
    rheo_world_last_stage(world, name); /* "" after the last one of a step */
    *last += stage + 1 == rheo_world_stage_count(world);
    if (*name || rheo_world_stage(world, stage, &info) != RHEO_OK)
        return;
    snprintf(name, CLI_STAGE_NAME, info.in_substeps ? "%s@%u" : "%s", info.name, (unsigned)*last);
}
