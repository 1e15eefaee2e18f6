/* rheolog render: draws steps of a recording as pictures. */
#include <stdlib.h>
#include <string.h>

#include "cli/png.h"
#include "cli/steps.h"
#include "json/file_name.h"

typedef struct arguments {
    const char *file, *output, *colour, *range, *size, *isovalue, *resolution, *other, *simd;
    const char *look, *target, *zoom;
    bool parallel, surface, bare, force, json;
} arguments;

typedef struct render_state {
    const arguments *a;
    rheo_recording *recording, *other;
    rheo_player *other_player; /* of the recording that is compared; else NULL */
    cli_steps steps;
    char name[CLI_FILE_NAME]; /* prefix of the file names in a folder */
    char path[CLI_FILE_PATH];
    rheo_picture_options options;
    rheo_surface_options surface;
    rheo_camera camera;
    double target[3];
    rheo_extent extent;
    uint64_t written; /* files */
    double range[2];
    unsigned char *rgb;
} render_state;

/* ---- Options ---- */

/* Reads WxH. */
static int read_size(render_state *x)
{
    const char *size = x->a->size, *between = strchr(size, 'x');
    char width[16] = "";
    uint64_t wide, high;
    if (between && between - size < (int)sizeof width)
        memcpy(width, size, (size_t)(between - size));
    if (!between || !cli_number_from(width, &wide) || !cli_number_from(between + 1, &high) ||
        wide < RHEO_PICTURE_MIN || wide > RHEO_PICTURE_MAX || high < RHEO_PICTURE_MIN || high > RHEO_PICTURE_MAX)
        return cli_usage(&cli_render, "--size needs WxH, each from %d to %d pixels, as 1280x720; got \"%s\"",
                         RHEO_PICTURE_MIN, RHEO_PICTURE_MAX, size);
    x->options.width = (uint32_t)wide;
    x->options.height = (uint32_t)high;
    return CLI_DONE;
}

/* Reads the options of the camera. */
static int read_camera(render_state *x)
{
    const arguments *a = x->a;
    rheo_camera *c = &x->camera;
    int status = CLI_DONE;
    if (a->look)
        status = cli_read_numbers(&cli_render, "--look", a->look, 3, 1e15, c->direction);
    if (status == CLI_DONE && c->direction[0] == 0 && c->direction[1] == 0 && c->direction[2] == 0)
        return cli_usage(&cli_render, "--look needs a direction, such as 0,-1,0 from above; got \"%s\"", a->look);
    if (status == CLI_DONE && a->target)
        status = cli_read_numbers(&cli_render, "--target", a->target, 3, 1e30, x->target);
    if (status == CLI_DONE)
        status = cli_read_number(&cli_render, "--zoom", a->zoom, .01, 1000, false, &c->zoom);
    c->target = a->target ? x->target : NULL;
    c->parallel = a->parallel;
    x->options.camera = c;
    return status;
}

static bool is_png(const char *path)
{
    return rheo__json_ends_with(path, ".png");
}

static int check_output(const render_state *x)
{
    const arguments *a = x->a;
    const bool several = cli_steps_are_several(&x->steps);
    if (!a->output || !*a->output)
        return cli_usage(&cli_render,
                         "needs -o: FILE.png for one step, a folder for several (--steps, --every, --from, --to)");
    if (strcmp(a->output, "-") == 0)
        return cli_usage(&cli_render, "-o writes a file or a folder and not to standard output; got \"-\"");
    if (!several && !is_png(a->output))
        return cli_usage(&cli_render, "-o needs a name that ends with .png; got \"%s\"", a->output);
    if (several && is_png(a->output))
        return cli_usage(&cli_render, "-o needs a folder for several steps; got \"%s\"", a->output);
    return CLI_DONE;
}

static int check_usage(render_state *x, int operands)
{
    const arguments *a = x->a;
    if (operands != 1)
        return cli_usage(&cli_render, "needs one recording; got %d", operands);
    int status = cli_check_steps(&cli_render, &x->steps);
    if (status == CLI_DONE)
        status = check_output(x);
    if (status == CLI_DONE && a->size)
        status = read_size(x);
    if (status == CLI_DONE && a->range)
        status = cli_read_range(&cli_render, a->range, x->range);
    if (status == CLI_DONE)
        status = read_camera(x);
    if (status != CLI_DONE)
        return status;
    if (a->range && a->colour && strcmp(a->colour, "none") == 0)
        return cli_usage(&cli_render, "--range applies to colours; --color none has none");
    if (a->other && a->colour && strcmp(a->colour, "none") == 0)
        return cli_usage(&cli_render, "--compare paints a difference; it does not go with --color none");
    if ((a->isovalue || a->resolution) && !a->surface)
        return cli_usage(&cli_render, "--isovalue and --resolution apply to --surface");
    status = cli_read_number(&cli_render, "--isovalue", a->isovalue, 0, 1, true, &x->surface.isovalue);
    if (status == CLI_DONE)
        status = cli_read_number(&cli_render, "--resolution", a->resolution, .5, 8, false, &x->surface.resolution);
    return status;
}

/* ---- Files ---- */

static void set_path(render_state *x, uint64_t index)
{
    if (cli_steps_are_several(&x->steps))
        snprintf(x->path, sizeof x->path, "%s/%s_%06llu.png", x->a->output, x->name,
                 (unsigned long long)cli_step_at(&x->steps, index));
    else
        snprintf(x->path, sizeof x->path, "%s", x->a->output);
}

/* Refuses what cannot be written, before any step is simulated. */
static int check_files(render_state *x)
{
    if (!cli_steps_are_several(&x->steps)) {
        const int refused = cli_check_folder(x->a->output); /* so the name is not too long for x->path */
        return refused == CLI_DONE ? cli_refuse_existing(x->a->output, x->a->force) : refused;
    }
    int status = cli_choose_name(x->a->file, x->a->output, x->name);
    if (status == CLI_DONE)
        status = cli_make_folder(x->a->output);
    for (uint64_t i = 0; i < x->steps.count && status == CLI_DONE; i++) {
        set_path(x, i);
        status = cli_refuse_existing(x->path, x->a->force);
    }
    return status;
}

/* ---- Pictures ---- */

/* Moves both players to a step. */
static int seek_both(void *data, rheo_player *player, uint64_t index)
{
    render_state *x = data;
    int status = cli_seek(x->a->file, &x->steps, player, index);
    if (status == CLI_DONE && x->other_player)
        status = cli_seek(x->a->other, &x->steps, x->other_player, index);
    if (status == CLI_DONE && x->other_player)
        x->options.other = rheo_player_world(x->other_player); /* another one after every move */
    return status;
}

static int draw_step(void *data, rheo_player *player, uint64_t index)
{
    render_state *x = data;
    rheo_error error = {""};
    int status = seek_both(x, player, index);
    if (status != CLI_DONE)
        return status;
    const rheo_result result = rheo_world_render(rheo_player_world(player), &x->options, x->rgb, &error);
    if (result != RHEO_OK)
        return cli_error(result, &error);
    set_path(x, index);
    status = cli_write_png(x->path, x->rgb, x->options.width, x->options.height, x->a->force);
    x->written += status == CLI_DONE;
    if (status == CLI_DONE && !x->a->json)
        printf("%s\n", x->path);
    return status;
}

static int draw_steps(render_state *x, rheo_player *player)
{
    int status = cli_find_extent(x->a->file, &x->steps, player, &x->extent);
    if (status == CLI_DONE && !x->a->range)
        status = cli_find_range(&x->steps, player, seek_both, x, &x->options, x->range);
    return status == CLI_DONE ? cli_write_steps(x->a->file, &x->steps, player, draw_step, x) : status;
}

static void report(const render_state *x, int status)
{
    rheo__json json = {.file = stdout};
    rheo__json_begin_object(&json, NULL);
    rheo__json_text(&json, "file", x->a->file);
    rheo__json_text(&json, "output", x->a->output);
    rheo__json_text(&json, "outcome", status == CLI_DIFFERS ? "differs" : cli_status_name(status));
    rheo__json_text(&json, "reason", status == CLI_DONE ? NULL : cli_said());
    rheo__json_integer(&json, "files", x->written);
    if (status == CLI_DONE) {
        rheo__json_integer(&json, "first_step", x->steps.first);
        rheo__json_integer(&json, "last_step", cli_step_at(&x->steps, x->steps.count - 1));
        rheo__json_integer(&json, "width", x->options.width);
        rheo__json_integer(&json, "height", x->options.height);
        rheo__json_number(&json, "range_min", x->range[0]);
        rheo__json_number(&json, "range_max", x->range[1]);
    }
    rheo__json_end_object(&json);
}

/* Opens the recording that is compared, which needs the same steps. */
static int open_other(render_state *x)
{
    rheo_error error = {""};
    if (!x->a->other)
        return CLI_DONE;
    int status = cli_open_recording(x->a->other, &x->other);
    if (status == CLI_DONE)
        status = cli_check_step(x->a->other, x->other, "step", x->steps.first);
    if (status == CLI_DONE)
        status = cli_check_step(x->a->other, x->other, "step", x->steps.last);
    if (status != CLI_DONE)
        return status;
    const rheo_result result = rheo_player_open(x->other, NULL, &x->other_player, &error);
    return result == RHEO_OK ? CLI_DONE : cli_file_error(x->a->other, result, &error);
}

static int render_recording(render_state *x)
{
    int status = cli_choose_steps(x->a->file, x->recording, &x->steps);
    if (status == CLI_DONE)
        status = open_other(x);
    if (status == CLI_DONE)
        status = check_files(x);
    if (status != CLI_DONE)
        return status;
    x->options.colour = x->a->colour;
    x->options.range = x->range; /* rheo_world_colour_range() ignores it */
    x->options.extent = &x->extent;
    x->options.surface = x->a->surface ? &x->surface : NULL;
    x->options.without_captions = x->a->bare;
    x->rgb = malloc((size_t)3 * x->options.width * x->options.height);
    if (!x->rgb)
        return cli_fail(CLI_SYSTEM, "no memory");
    rheo_error error = {""};
    rheo_player *player = NULL;
    cli_watch_signals();
    const rheo_result result = rheo_player_open(x->recording, NULL, &player, &error);
    status = result == RHEO_OK ? draw_steps(x, player) : cli_file_error(x->a->file, result, &error);
    rheo_player_close(player);
    return status;
}

static int run(int argc, char **argv)
{
    arguments a = {0};
    render_state x = {.a = &a,
                      .options = rheo_default_picture_options(),
                      .surface = rheo_default_surface_options(),
                      .camera = rheo_default_camera()};
    cli_steps *s = &x.steps;
    const cli_option options[] = {
        {"--output", "-o", "FILE", CLI_TEXT, &a.output},
        {"--step", NULL, "N", CLI_NUMBER, &s->step},
        {"--steps", NULL, "N,N,...", CLI_TEXT, &s->list},
        {"--every", NULL, "N", CLI_NUMBER, &s->every},
        {"--from", NULL, "N", CLI_NUMBER, &s->from},
        {"--to", NULL, "N", CLI_NUMBER, &s->to},
        {"--stage", NULL, "NAME", CLI_TEXT, &s->stage},
        {"--color", NULL, "NAME", CLI_TEXT, &a.colour},
        {"--compare", NULL, "G.rlog", CLI_TEXT, &a.other},
        {"--range", NULL, "MIN,MAX", CLI_TEXT, &a.range},
        {"--surface", NULL, NULL, CLI_FLAG, &a.surface},
        {"--isovalue", NULL, "C", CLI_TEXT, &a.isovalue},
        {"--resolution", NULL, "R", CLI_TEXT, &a.resolution},
        {"--look", NULL, "X,Y,Z", CLI_TEXT, &a.look},
        {"--target", NULL, "X,Y,Z", CLI_TEXT, &a.target},
        {"--zoom", NULL, "Z", CLI_TEXT, &a.zoom},
        {"--parallel", NULL, NULL, CLI_FLAG, &a.parallel},
        {"--size", NULL, "WxH", CLI_TEXT, &a.size},
        {"--bare", NULL, NULL, CLI_FLAG, &a.bare},
        {"--simd", NULL, "NAME", CLI_TEXT, &a.simd},
        {"--force", NULL, NULL, CLI_FLAG, &a.force},
        {"--json", NULL, NULL, CLI_FLAG, &a.json},
        {0},
    };
    int status = cli_parse(&cli_render, options, &argc, argv);
    if (status != CLI_GO_ON)
        return status;
    a.file = argc > 0 ? argv[0] : NULL;
    if ((status = check_usage(&x, argc)) == CLI_DONE && (status = cli_check_png()) == CLI_DONE &&
        (status = cli_use_simd(a.simd)) == CLI_DONE &&
        (status = cli_open_recording(a.file, &x.recording)) == CLI_DONE)
        status = render_recording(&x);
    if (a.json)
        report(&x, status);
    rheo_player_close(x.other_player);
    rheo_recording_close(x.other);
    rheo_recording_close(x.recording);
    free(x.rgb);
    return status;
}

static const char help[] = {
#include "cli/help/render.txt.inc"
    0};

const cli_command cli_render = {"render", help, run};
