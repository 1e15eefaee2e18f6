/* rheolog export: writes steps of a recording as files for ParaView, renderers and tables. */
#include "cli/steps.h"

#include <stdlib.h>
#include <string.h>

typedef struct arguments {
    const char *file, *folder, *format, *isovalue, *resolution, *colour, *range, *up, *simd;
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
    cli_steps steps;
    char name[CLI_FILE_NAME]; /* prefix of all file names */
    char path[CLI_FILE_PATH];
    rheo_extent extent;
    double range[2];
    double *times;
} export_state;

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
        return cli_usage(&cli_export, "needs --format: vtp, ply, obj, pov, csv, springs, solids or surface");
    int status = find_formats(x);
    if (status != CLI_DONE)
        return status;
    if ((status = cli_check_steps(&cli_export, &x->steps)) != CLI_DONE)
        return status;
    if ((a->isovalue || a->resolution) && !any_surface(x))
        return cli_usage(&cli_export, "--isovalue and --resolution apply to surfaces; %s exports none", a->format);
    if ((a->colour || a->range) && !any_surface(x))
        return cli_usage(&cli_export, "--color and --range apply to surfaces; %s exports none", a->format);
    if (a->range && (!a->colour || strcmp(a->colour, "none") == 0))
        return cli_usage(&cli_export, "--range needs --color NAME: the quantity whose values it names");
    if (a->range && (status = cli_read_range(&cli_export, a->range, x->range)) != CLI_DONE)
        return status;
    if (a->up && strcmp(a->up, "y") != 0 && strcmp(a->up, "z") != 0)
        return cli_usage(&cli_export, "--up needs y or z; got \"%s\"", a->up);
    x->options = (rheo_export_options){.surface = rheo_default_surface_options(),
                                       .extent = &x->extent,
                                       .force = a->force,
                                       .colour = a->colour,
                                       .range = a->colour ? x->range : NULL,
                                       .z_up = a->up && *a->up == 'z'};
    if ((status = cli_read_number(&cli_export, "--isovalue", a->isovalue, 0, 1, true,
                                  &x->options.surface.isovalue)) != CLI_DONE)
        return status;
    return cli_read_number(&cli_export, "--resolution", a->resolution, .5, 8, false, &x->options.surface.resolution);
}

/* ---- Files ---- */

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
    char contents[32], stage[48] = "";
    set_contents(x, contents, sizeof contents);
    if (x->steps.stage)
        snprintf(stage, sizeof stage, "_%.40s", x->steps.stage);
    snprintf(x->path, sizeof x->path, "%s%s%s%s_%06llu%s.%s", with_folder ? x->a->folder : "", with_folder ? "/" : "",
             x->name, contents, (unsigned long long)cli_step_at(&x->steps, index), stage,
             rheo_export_format_ending(x->now->format));
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

/* Refuses existing files before any step is simulated. */
static int check_files(export_state *x)
{
    int status = CLI_DONE;
    for (uint64_t i = 0; i < x->steps.count + has_collection(x) && status == CLI_DONE; i++) {
        if (i < x->steps.count)
            set_path(x, true, i);
        else
            set_collection_path(x);
        status = cli_refuse_existing(x->path, x->a->force);
    }
    return status;
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
    char **file = calloc((size_t)x->steps.count, sizeof *file);
    bool enough = file != NULL;
    for (uint64_t i = 0; enough && i < x->steps.count; i++) {
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
        result = rheo_export_collection(x->path, (size_t)x->steps.count, (const char *const *)file, x->times,
                                        x->a->force, &error);
    }
    for (uint64_t i = 0; file && i < x->steps.count; i++)
        free(file[i]);
    free(file);
    return result == RHEO_OK ? CLI_DONE : cli_error(result, &error);
}

/* ---- Steps ---- */

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

static int export_step(void *data, rheo_player *player, uint64_t index)
{
    export_state *x = data;
    const rheo_world *world = rheo_player_world(player);
    x->times[index] = rheo_world_time(world);
    int status = CLI_DONE;
    for (uint32_t o = 0; o < x->output_count && status == CLI_DONE; o++) {
        x->now = &x->outputs[o];
        status = export_file(x, world, index);
    }
    return status;
}

static int go_to_step(void *data, rheo_player *player, uint64_t index)
{
    const export_state *x = data;
    return cli_seek(x->a->file, &x->steps, player, index);
}

static int export_steps(export_state *x, rheo_player *player)
{
    bool has_extent = any_surface(x);
    for (uint32_t o = 0; o < x->output_count; o++)
        has_extent = has_extent || x->outputs[o].format == RHEO_EXPORT_SOLIDS;
    int status = has_extent ? cli_find_extent(x->a->file, &x->steps, player, &x->extent) : CLI_DONE;
    if (status == CLI_DONE && x->a->colour && !x->a->range)
        status = cli_find_range(&x->steps, player, go_to_step, x, &(rheo_picture_options){.colour = x->a->colour},
                                x->range);
    if (status == CLI_DONE)
        status = cli_write_steps(x->a->file, &x->steps, player, export_step, x);
    return status == CLI_DONE ? for_each_output(x, write_collection) : status;
}

/* Reports the files of one format. */
static int report(export_state *x)
{
    const output *o = x->now;
    if (o->without_surface)
        cli_warn("%llu of %llu file%s %s no surface: chi is below the isovalue %g everywhere (see --isovalue)",
                 (unsigned long long)o->without_surface, (unsigned long long)x->steps.count,
                 cli_plural(x->steps.count), o->without_surface == 1 ? "has" : "have", x->options.surface.isovalue);
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
    rheo__json_text(&json, "outcome", cli_status_name(CLI_DONE));
    rheo__json_text(&json, "reason", NULL);
    rheo__json_text(&json, "format", rheo_export_format_name(o->format));
    rheo__json_integer(&json, "files", x->steps.count + has_collection(x));
    rheo__json_integer(&json, "steps", x->steps.count);
    rheo__json_integer(&json, "first_step", x->steps.first);
    rheo__json_integer(&json, "last_step", cli_step_at(&x->steps, x->steps.count - 1));
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

/* Why nothing, or not all, was written. */
static void report_failure(const arguments *a, int status)
{
    rheo__json json = {.file = stdout};
    rheo__json_begin_object(&json, NULL);
    rheo__json_text(&json, "file", a->file);
    rheo__json_text(&json, "folder", a->folder);
    rheo__json_text(&json, "outcome", status == CLI_DIFFERS ? "differs" : cli_status_name(status));
    rheo__json_text(&json, "reason", cli_said());
    rheo__json_end_object(&json);
}

static int export_recording(export_state *x)
{
    int status = cli_choose_steps(x->a->file, x->recording, &x->steps);
    if (status == CLI_DONE)
        status = cli_choose_name(x->a->file, x->a->folder, x->name);
    if (status == CLI_DONE)
        status = cli_make_folder(x->a->folder);
    if (status == CLI_DONE)
        status = for_each_output(x, check_files);
    if (status != CLI_DONE)
        return status;
    rheo_error error = {""};
    rheo_player *player = NULL;
    if (x->steps.count > SIZE_MAX / sizeof *x->times ||
        !(x->times = malloc((size_t)x->steps.count * sizeof *x->times)))
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
    export_state *x = calloc(1, sizeof *x);
    if (!x)
        return cli_fail(CLI_SYSTEM, "no memory");
    x->a = &a;
    cli_steps *s = &x->steps;
    const cli_option options[] = {
        {"--output", "-o", "DIR", CLI_TEXT, &a.folder},
        {"--format", NULL, "NAME,NAME,...", CLI_TEXT, &a.format},
        {"--steps", NULL, "N,N,...", CLI_TEXT, &s->list},
        {"--step", NULL, "N", CLI_NUMBER, &s->step},
        {"--every", NULL, "N", CLI_NUMBER, &s->every},
        {"--from", NULL, "N", CLI_NUMBER, &s->from},
        {"--to", NULL, "N", CLI_NUMBER, &s->to},
        {"--stage", NULL, "NAME", CLI_TEXT, &s->stage},
        {"--up", NULL, "AXIS", CLI_TEXT, &a.up},
        {"--color", NULL, "NAME", CLI_TEXT, &a.colour},
        {"--range", NULL, "MIN,MAX", CLI_TEXT, &a.range},
        {"--isovalue", NULL, "C", CLI_TEXT, &a.isovalue},
        {"--resolution", NULL, "R", CLI_TEXT, &a.resolution},
        {"--simd", NULL, "NAME", CLI_TEXT, &a.simd},
        {"--force", NULL, NULL, CLI_FLAG, &a.force},
        {"--json", NULL, NULL, CLI_FLAG, &a.json},
        {0},
    };
    int status = cli_parse(&cli_export, options, &argc, argv);
    a.file = argc > 0 ? argv[0] : NULL;
    if (status == CLI_GO_ON) {
        if ((status = check_usage(x, argc)) == CLI_DONE && (status = cli_use_simd(a.simd)) == CLI_DONE &&
            (status = cli_open_recording(a.file, &x->recording)) == CLI_DONE)
            status = export_recording(x);
        if (a.json && status != CLI_DONE)
            report_failure(&a, status);
    }
    rheo_recording_close(x->recording);
    free(x);
    return status;
}

static const char help[] = {
#include "cli/help/export.txt.inc"
    0};

const cli_command cli_export = {"export", help, run};
