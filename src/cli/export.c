/* rheolog export: writes steps of a recording as files for ParaView, renderers and tables. */
#define _POSIX_C_SOURCE 200809L
#define _FILE_OFFSET_BITS 64
#include "cli/cli.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "json/file_name.h"

typedef struct arguments {
    const char *file, *folder, *format, *isovalue, *resolution, *simd;
    cli_number step, every, from, to;
    bool force, json;
} arguments;

enum { MOST_FORMATS = 16 };

/* A format, and what all its files hold together. */
typedef struct output {
    rheo_export_format format;
    uint64_t vertices, triangles, left_out, without_surface;
} output;

typedef struct export_state {
    const arguments *a;
    output outputs[MOST_FORMATS], *now; /* now: the one that the functions below work on */
    uint32_t output_count;
    rheo_export_options options;
    rheo_recording *recording;
    uint64_t first, last, every, count; /* steps to write */
    char name[256];                     /* prefix of all file names */
    char path[4096 + 300];
    rheo_extent extent;
    double *times;
    cli_progress progress;
} export_state;

static uint64_t step_at(const export_state *x, uint64_t index)
{
    return x->first + index * x->every;
}

/* ---- Options ---- */

static int find_format(const char *wanted, rheo_export_format *format)
{
    const char *nearest = rheo_export_format_name(0), *name;
    char all[128] = "";
    for (uint32_t f = 0; (name = rheo_export_format_name(f)) != NULL; f++) {
        if (strcmp(name, wanted) == 0) {
            *format = (rheo_export_format)f;
            return CLI_DONE;
        }
        nearest = rheo_nearest_word(wanted, (const char *const[]){nearest, name}, 2);
        const size_t length = strlen(all);
        snprintf(all + length, sizeof all - length, "%s%s", f ? ", " : "", name);
    }
    char suggestion[CLI_SUGGESTION];
    return cli_usage(&cli_export, "unknown format \"%s\"%s The formats: %s", wanted,
                     *cli_did_you_mean(wanted, nearest, suggestion) ? suggestion : ".", all);
}

/* Reads NAME,NAME,... */
static int find_formats(export_state *x)
{
    for (const char *name = x->a->format;; name++) {
        char wanted[32];
        const size_t length = strcspn(name, ",");
        rheo_export_format format = 0;
        snprintf(wanted, sizeof wanted, "%.*s", (int)(length < 31 ? length : 31), name);
        const int status = find_format(wanted, &format);
        if (status != CLI_DONE)
            return status;
        for (uint32_t o = 0; o < x->output_count; o++)
            if (x->outputs[o].format == format)
                return cli_usage(&cli_export, "--format names %s twice", wanted);
        x->outputs[x->output_count++].format = format; /* none comes twice, so there is room */
        name += length;
        if (!*name)
            return CLI_DONE;
    }
}

static bool any_surface(const export_state *x)
{
    bool any = false;
    for (uint32_t o = 0; o < x->output_count; o++)
        any = any || rheo_export_has_surface(x->outputs[o].format);
    return any;
}

static int read_number(const char *option, const char *text, double minimum, double maximum, bool inside,
                       double *value)
{
    char *end = NULL;
    const double number = text ? strtod(text, &end) : *value;
    const bool read = !text || (*text && *end == 0 && strspn(text, "+-.0123456789eE") == strlen(text));
    if (!read || !(inside ? number > minimum && number < maximum : number >= minimum && number <= maximum))
        return cli_usage(&cli_export, "%s needs a number %s %g and %g; got \"%s\"", option,
                         inside ? "strictly between" : "between", minimum, maximum, text);
    *value = number;
    return CLI_DONE;
}

static int check_usage(export_state *x, int operands)
{
    const arguments *a = x->a;
    if (operands != 1)
        return cli_usage(&cli_export, "needs one recording; got %d", operands);
    if (a->folder && strcmp(a->folder, "-") == 0)
        return cli_usage(&cli_export, "-o writes a folder and not to standard output; got \"-\"");
    if (!a->folder || !*a->folder)
        return cli_usage(&cli_export, "needs -o DIR: the folder to write to");
    if (!a->format)
        return cli_usage(&cli_export, "needs --format: vtp, ply, obj, pov, csv, springs or solids");
    int status = find_formats(x);
    if (status != CLI_DONE)
        return status;
    if (a->step.given && (a->every.given || a->from.given || a->to.given))
        return cli_usage(&cli_export, "--step N is one step; it does not go with --every, --from and --to");
    if (a->every.given && a->every.value == 0)
        return cli_usage(&cli_export, "--every needs 1 or more; got 0");
    if ((a->isovalue || a->resolution) && !any_surface(x))
        return cli_usage(&cli_export, "--isovalue and --resolution apply to surfaces; %s exports particles",
                         a->format);
    x->options = (rheo_export_options){rheo_default_surface_options(), &x->extent, a->force};
    if ((status = read_number("--isovalue", a->isovalue, 0, 1, true, &x->options.surface.isovalue)) != CLI_DONE)
        return status;
    return read_number("--resolution", a->resolution, .5, 8, false, &x->options.surface.resolution);
}

static int check_step(const export_state *x, const char *option, const cli_number *step)
{
    return step->given ? cli_check_step(x->a->file, x->recording, option, step->value) : CLI_DONE;
}

static int choose_steps(export_state *x)
{
    const arguments *a = x->a;
    const rheo_recording_info info = rheo_recording_get_info(x->recording);
    int status = check_step(x, "--step", &a->step);
    if (status == CLI_DONE)
        status = check_step(x, "--from", &a->from);
    if (status == CLI_DONE)
        status = check_step(x, "--to", &a->to);
    if (status != CLI_DONE)
        return status;
    const bool several = a->every.given || a->from.given || a->to.given;
    x->last = a->step.given ? a->step.value : a->to.given ? a->to.value : info.last_step;
    x->first = a->from.given ? a->from.value : several ? info.first_step : x->last;
    x->every = a->every.given ? a->every.value : 1;
    if (x->first > x->last)
        return cli_fail(CLI_BAD, "--from %llu is greater than --to %llu", (unsigned long long)x->first,
                        (unsigned long long)x->last);
    x->count = (x->last - x->first) / x->every + 1;
    return CLI_DONE;
}

/* ---- Files ---- */

/* File names begin with the name of the recording, without its extension. */
static int choose_name(export_state *x)
{
    const char *base = rheo__json_file_name(x->a->file);
    const size_t length = strlen(base) - (rheo__json_ends_with(base, ".rlog") ? strlen(".rlog") : 0);
    if (length > 200 || strlen(x->a->folder) > 4095)
        return cli_fail(CLI_BAD, "the names %s and %s are too long to be those of files together", x->a->folder,
                        base);
    memcpy(x->name, base, length);
    x->name[length] = 0;
    return CLI_DONE;
}

/* Formats whose files have the ending of another format: their names say what they contain. */
static void set_contents(const export_state *x, char *contents, size_t size)
{
    const char *name = rheo_export_format_name(x->now->format);
    const bool other = strcmp(name, rheo_export_format_ending(x->now->format)) != 0;
    snprintf(contents, size, "%s%s", other ? "_" : "", other ? name : "");
}

/* Makes the file name of a step, with or without the folder. */
static void set_path(export_state *x, bool with_folder, uint64_t index)
{
    char contents[32];
    set_contents(x, contents, sizeof contents);
    snprintf(x->path, sizeof x->path, "%s%s%s%s_%06llu.%s", with_folder ? x->a->folder : "", with_folder ? "/" : "",
             x->name, contents, (unsigned long long)step_at(x, index), rheo_export_format_ending(x->now->format));
}

static void set_collection_path(export_state *x)
{
    char contents[32];
    set_contents(x, contents, sizeof contents);
    snprintf(x->path, sizeof x->path, "%s/%s%s.pvd", x->a->folder, x->name, contents);
}

static bool has_collection(const export_state *x)
{
    return strcmp(rheo_export_format_ending(x->now->format), "vtp") == 0;
}

static int make_folder(const char *folder)
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

/* Refuses existing files before any step is simulated. */
static int check_files(export_state *x)
{
    for (uint64_t i = 0; i < x->count + has_collection(x); i++) {
        struct stat status = {0};
        if (i < x->count)
            set_path(x, true, i);
        else
            set_collection_path(x);
        if (lstat(x->path, &status) != 0)
            continue;
        if (stat(x->path, &status) != 0 || !S_ISREG(status.st_mode))
            return cli_fail(CLI_BAD, "%s exists and leads to no regular file, so it cannot be replaced", x->path);
        if (!x->a->force)
            return cli_fail(CLI_BAD, "%s exists; give --force to replace it, or another folder", x->path);
    }
    return CLI_DONE;
}

/* Calls a function for each format; stops after one that does not return CLI_DONE. */
static int for_each_output(export_state *x, int (*function)(export_state *x))
{
    int status = CLI_DONE;
    for (uint32_t o = 0; o < x->output_count && status == CLI_DONE; o++) {
        x->now = &x->outputs[o];
        status = function(x);
    }
    return status;
}

static int write_collection(export_state *x)
{
    if (!has_collection(x))
        return CLI_DONE;
    char **file = calloc((size_t)x->count, sizeof *file);
    bool enough = file != NULL;
    for (uint64_t i = 0; enough && i < x->count; i++) {
        set_path(x, false, i);
        file[i] = malloc(strlen(x->path) + 1);
        enough = file[i] != NULL;
        if (enough)
            strcpy(file[i], x->path);
    }
    rheo_error error = {"no memory"};
    rheo_result result = RHEO_ERROR_MEMORY;
    if (enough) {
        set_collection_path(x);
        result = rheo_export_collection(x->path, (size_t)x->count, (const char *const *)file, x->times, x->a->force,
                                        &error);
    }
    for (uint64_t i = 0; file && i < x->count; i++)
        free(file[i]);
    free(file);
    return result == RHEO_OK ? CLI_DONE : cli_error(result, &error);
}

/* ---- Steps ---- */

/* Computes one extent for all pictures. It contains the extents of the first and the last step. */
static int find_extent(export_state *x, rheo_player *player)
{
    rheo_extent extent[2];
    for (int end = 1; end >= 0; end--) {
        rheo_error error = {""};
        const rheo_result result = rheo_player_seek(player, step_at(x, end ? x->count - 1 : 0), &error);
        if (result != RHEO_OK)
            return cli_file_error(x->a->file, result, &error);
        extent[end] = rheo_world_extent(rheo_player_world(player));
    }
    x->extent = rheo_extent_of_both(&extent[0], &extent[1]);
    return CLI_DONE;
}

/* Writes the file of one format. */
static int export_file(export_state *x, const rheo_world *world, uint64_t index)
{
    rheo_error error = {""};
    rheo_exported made;
    output *o = x->now;
    set_path(x, true, index);
    const rheo_result result = rheo_world_export(world, o->format, x->path, &x->options, &made, &error);
    if (result != RHEO_OK)
        return cli_error(result, &error);
    o->vertices += made.vertices;
    o->triangles += made.triangles;
    o->left_out += made.left_out;
    o->without_surface += rheo_export_has_surface(o->format) && made.triangles == 0;
    if (!x->a->json)
        printf("%s\n", x->path);
    return CLI_DONE;
}

static int export_step(export_state *x, rheo_player *player, uint64_t index)
{
    rheo_error error = {""};
    const rheo_result result = rheo_player_seek(player, step_at(x, index), &error);
    if (result != RHEO_OK)
        return cli_file_error(x->a->file, result, &error);
    const rheo_world *world = rheo_player_world(player);
    x->times[index] = rheo_world_time(world);
    int status = CLI_DONE;
    for (uint32_t o = 0; o < x->output_count && status == CLI_DONE; o++) {
        x->now = &x->outputs[o];
        status = export_file(x, world, index);
    }
    return status;
}

static int export_steps(export_state *x, rheo_player *player)
{
    bool has_extent = any_surface(x);
    for (uint32_t o = 0; o < x->output_count; o++)
        has_extent = has_extent || x->outputs[o].format == RHEO_EXPORT_SOLIDS;
    int status = has_extent ? find_extent(x, player) : CLI_DONE;
    for (uint64_t i = 0; i < x->count && status == CLI_DONE; i++) {
        if (cli_interrupted()) {
            cli_progress_end(&x->progress);
            return cli_fail(CLI_INTERRUPTED, "interrupted after %llu of %llu step%s", (unsigned long long)i,
                            (unsigned long long)x->count, cli_plural(x->count));
        }
        status = export_step(x, player, i);
        const double now = cli_now();
        if (status == CLI_DONE && cli_progress_due(&x->progress, now))
            cli_progress_say(&x->progress, now, "step %llu: %llu of %llu step%s", (unsigned long long)step_at(x, i),
                             (unsigned long long)(i + 1), (unsigned long long)x->count, cli_plural(x->count));
    }
    cli_progress_end(&x->progress);
    return status == CLI_DONE ? for_each_output(x, write_collection) : status;
}

/* Reports the files of one format. */
static int report(export_state *x)
{
    const output *o = x->now;
    if (o->without_surface)
        cli_warn("%llu of %llu file%s %s no surface: chi is below the isovalue %g everywhere (see --isovalue)",
                 (unsigned long long)o->without_surface, (unsigned long long)x->count, cli_plural(x->count),
                 o->without_surface == 1 ? "has" : "have", x->options.surface.isovalue);
    if (o->left_out)
        cli_warn("%llu time%s a particle was left out of a surface: too far from the origin for its cells",
                 (unsigned long long)o->left_out, cli_plural(o->left_out));
    if (!x->a->json) {
        if (has_collection(x)) {
            set_collection_path(x);
            puts(x->path);
        }
        return CLI_DONE;
    }
    rheo__json json = {.file = stdout};
    rheo__json_begin_object(&json, NULL);
    rheo__json_text(&json, "file", x->a->file);
    rheo__json_text(&json, "folder", x->a->folder);
    rheo__json_text(&json, "format", rheo_export_format_name(o->format));
    rheo__json_integer(&json, "files", x->count + has_collection(x));
    rheo__json_integer(&json, "steps", x->count);
    rheo__json_integer(&json, "first_step", x->first);
    rheo__json_integer(&json, "last_step", step_at(x, x->count - 1));
    if (has_collection(x))
        set_collection_path(x);
    rheo__json_text(&json, "collection", has_collection(x) ? x->path : NULL);
    rheo__json_integer(&json, "vertices", o->vertices);
    rheo__json_integer(&json, "triangles", o->triangles);
    rheo__json_integer(&json, "without_surface", o->without_surface);
    rheo__json_integer(&json, "left_out", o->left_out);
    rheo__json_end_object(&json);
    return CLI_DONE;
}

static int export_recording(export_state *x)
{
    int status = choose_steps(x);
    if (status == CLI_DONE)
        status = choose_name(x);
    if (status == CLI_DONE)
        status = make_folder(x->a->folder);
    if (status == CLI_DONE)
        status = for_each_output(x, check_files);
    if (status != CLI_DONE)
        return status;
    rheo_error error = {""};
    rheo_player *player = NULL;
    if (x->count > SIZE_MAX / sizeof *x->times || !(x->times = malloc((size_t)x->count * sizeof *x->times)))
        return cli_fail(CLI_SYSTEM, "no memory");
    cli_watch_signals();
    const rheo_result result = rheo_player_open(x->recording, NULL, &player, &error);
    status = result == RHEO_OK ? export_steps(x, player) : cli_file_error(x->a->file, result, &error);
    rheo_player_close(player);
    free(x->times);
    return status == CLI_DONE ? for_each_output(x, report) : status;
}

static int run(int argc, char **argv)
{
    arguments a = {0};
    const cli_option options[] = {
        {"--output", "-o", "DIR", CLI_TEXT, &a.folder},   {"--format", NULL, "NAME,NAME,...", CLI_TEXT, &a.format},
        {"--step", NULL, "N", CLI_NUMBER, &a.step},       {"--every", NULL, "N", CLI_NUMBER, &a.every},
        {"--from", NULL, "N", CLI_NUMBER, &a.from},       {"--to", NULL, "N", CLI_NUMBER, &a.to},
        {"--isovalue", NULL, "C", CLI_TEXT, &a.isovalue}, {"--resolution", NULL, "R", CLI_TEXT, &a.resolution},
        {"--simd", NULL, "NAME", CLI_TEXT, &a.simd},      {"--force", NULL, NULL, CLI_FLAG, &a.force},
        {"--json", NULL, NULL, CLI_FLAG, &a.json},        {0},
    };
    int status = cli_parse(&cli_export, options, &argc, argv);
    if (status != CLI_GO_ON)
        return status;
    export_state *x = calloc(1, sizeof *x);
    if (!x)
        return cli_fail(CLI_SYSTEM, "no memory");
    x->a = &a;
    x->progress = (cli_progress){.quiet = cli_quiet(), .terminal = isatty(STDERR_FILENO) == 1, .last = cli_now()};
    a.file = argc > 0 ? argv[0] : NULL;
    if ((status = check_usage(x, argc)) == CLI_DONE && (status = cli_use_simd(a.simd)) == CLI_DONE &&
        (status = cli_open_recording(a.file, &x->recording)) == CLI_DONE)
        status = export_recording(x);
    rheo_recording_close(x->recording);
    free(x);
    return status;
}

static const char help[] = {
#include "cli/help/export.txt.inc"
    0};

const cli_command cli_export = {"export", help, run};
