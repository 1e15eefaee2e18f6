/*
 * rheolog metrics: prints the recorded metrics of recordings as CSV, also while one is being written, or lists them.
 * Nothing is simulated.
 */
#define _POSIX_C_SOURCE 200809L
#include "cli/cli.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

/* ---- Columns ---- */

enum { MOST_COLUMNS = 256 };

typedef struct columns {
    char *name[MOST_COLUMNS];
    size_t count;
} columns;

static int add_column(columns *c, const char *name, size_t length)
{
    for (size_t i = 0; i < c->count; i++)
        if (strlen(c->name[i]) == length && strncmp(c->name[i], name, length) == 0)
            return CLI_DONE;
    if (c->count == MOST_COLUMNS)
        return cli_fail(CLI_BAD, "there are more than %d columns", MOST_COLUMNS);
    c->name[c->count] = strndup(name, length);
    if (!c->name[c->count])
        return cli_fail(CLI_SYSTEM, "no memory");
    c->count++;
    return CLI_DONE;
}

static int add_columns(columns *c, const rheo_recording *recording)
{
    int status = CLI_DONE;
    for (uint32_t m = 0; m < rheo_recording_metric_count(recording) && status == CLI_DONE; m++) {
        const char *name = rheo_recording_metric_name(recording, m);
        status = add_column(c, name, strlen(name));
    }
    return status;
}

/* Collects the metrics of all recordings. Those that cannot be read are reported when they are to be printed. */
static int all_columns(columns *c, int files, char **file)
{
    int status = CLI_DONE;
    for (int i = 0; i < files && status == CLI_DONE; i++) {
        rheo_recording *recording;
        if (!cli_exists(file[i]) || rheo_recording_open(file[i], &recording, NULL) != RHEO_OK)
            continue;
        status = add_columns(c, recording);
        rheo_recording_close(recording);
    }
    return status;
}

static int unknown_metric(const columns *all, const char *word)
{
    char suggestion[CLI_SUGGESTION];
    const char *nearest = rheo_nearest_word(word, (const char *const *)all->name, all->count);
    return cli_usage(&cli_metrics, "there is no metric \"%s\"%s", word,
                     *cli_did_you_mean(word, nearest, suggestion) ? suggestion : "; --list lists them");
}

/* Takes the columns of --columns from those that there are. */
static int chosen_columns(const columns *all, const char *list, columns *c)
{
    int status = CLI_DONE;
    for (const char *name = list; status == CLI_DONE; name++) {
        const size_t length = strcspn(name, ",");
        bool known = false;
        char word[64];
        snprintf(word, sizeof word, "%.*s", (int)(length < 63 ? length : 63), name);
        for (size_t i = 0; i < all->count && !known; i++)
            known = strcmp(all->name[i], word) == 0;
        if (!known && all->count)
            return unknown_metric(all, word);
        status = add_column(c, name, length);
        name += length;
        if (!*name)
            break;
    }
    return status;
}

static void release(columns *c)
{
    for (size_t i = 0; i < c->count; i++)
        free(c->name[i]);
}

/* ---- CSV ---- */

static void print_header(const columns *c, bool with_file)
{
    if (with_file)
        fputs(c->count ? "file," : "file", stdout);
    for (size_t i = 0; i < c->count; i++)
        printf("%s%s", i ? "," : "", c->name[i]);
    putchar('\n');
}

/* Prints a row. A metric that the recording does not have is empty. */
static void print_row(const columns *c, const char *file, const uint32_t *index, const double *values, uint32_t count)
{
    if (file)
        cli_put_csv(stdout, file);
    for (size_t i = 0; i < c->count; i++) {
        char text[32] = "";
        if (index[i] < count)
            rheo__number_text(values[index[i]], text, sizeof text);
        printf("%s%s", i || file ? "," : "", text);
    }
    putchar('\n');
}

/* Prints the rows from step `first` on, or until a signal comes. `file` is NULL if the rows do not name it. */
static int print_rows(const char *path, rheo_recording *recording, const columns *c, const char *file, uint64_t first)
{
    const rheo_recording_info info = rheo_recording_get_info(recording);
    const uint32_t count = rheo_recording_metric_count(recording);
    uint32_t index[MOST_COLUMNS];
    for (size_t i = 0; i < c->count; i++)
        index[i] = rheo_recording_metric_by_name(recording, c->name[i]);
    double *values = malloc((count + 1) * sizeof *values);
    if (!values)
        return cli_fail(CLI_SYSTEM, "no memory");
    int status = CLI_DONE;
    for (uint64_t step = first; step <= info.last_step && !cli_interrupted(); step++) {
        rheo_error error = {""};
        const rheo_result result = rheo_recording_metrics(recording, step, values, &error);
        if (result != RHEO_OK) {
            status = cli_file_error(path, result, &error);
            break;
        }
        print_row(c, file, index, values, count);
    }
    free(values);
    return status;
}

static int print_files(int files, char **file, const char *chosen)
{
    columns all = {.count = 0}, some = {.count = 0};
    int worst = all_columns(&all, files, file);
    if (worst == CLI_DONE && chosen)
        worst = chosen_columns(&all, chosen, &some);
    const columns *c = chosen ? &some : &all;
    if (worst == CLI_DONE && all.count)
        print_header(c, files > 1);
    for (int i = 0; i < files && (worst == CLI_DONE || i > 0); i++) {
        rheo_recording *recording = NULL;
        int status = cli_open_recording(file[i], &recording);
        if (status == CLI_DONE) {
            const rheo_recording_info info = rheo_recording_get_info(recording);
            status = print_rows(file[i], recording, c, files > 1 ? file[i] : NULL, info.first_step);
            if (status == CLI_DONE && !info.complete)
                status = CLI_BAD;
        }
        rheo_recording_close(recording);
        worst = status > worst ? status : worst;
    }
    release(&all);
    release(&some);
    return worst;
}

/* ---- A recording that is being written ---- */

typedef struct following {
    const char *file, *chosen;
    columns all, some;
    bool begun;    /* the header is printed */
    uint64_t next; /* step of the next row */
} following;

/* Waits at least nine times as long as the last look took, because a look reads the heads of all chunks again. */
static void pause_after(double begin)
{
    enum { LEAST_MS = 250 };
    const double took = cli_now() - begin, seconds = took * 9 > LEAST_MS / 1e3 ? took * 9 : LEAST_MS / 1e3;
    const time_t whole = (time_t)seconds;
    nanosleep(&(struct timespec){whole, (long)((seconds - (double)whole) * 1e9)}, NULL);
}

static int print_new_rows(following *f, rheo_recording *recording)
{
    const rheo_recording_info info = rheo_recording_get_info(recording);
    int status = CLI_DONE;
    if (!f->begun) {
        if ((status = add_columns(&f->all, recording)) == CLI_DONE && f->chosen)
            status = chosen_columns(&f->all, f->chosen, &f->some);
        if (status != CLI_DONE)
            return status;
        print_header(f->chosen ? &f->some : &f->all, false);
        f->next = info.first_step;
        f->begun = true;
    }
    if (info.first_step > f->next || info.last_step + 1 < f->next)
        return cli_fail(CLI_BAD, "%s was replaced by another recording while its rows were printed", f->file);
    status = print_rows(f->file, recording, f->chosen ? &f->some : &f->all, NULL, f->next);
    f->next = info.last_step + 1;
    fflush(stdout);
    if (status == CLI_DONE && !info.complete && !info.being_written && !cli_interrupted()) {
        cli_warn_incomplete(f->file, recording);
        status = CLI_BAD;
    }
    return status;
}

/* Prints rows until no program writes the file any more. A file that does not exist yet is waited for. */
static int follow(following *f)
{
    enum { TRIES = 8 }; /* of the first look: the writer of a new file may be within the first keyframe */
    bool over = false, told = false;
    int status = CLI_DONE;
    for (int failed = 0; !over && status == CLI_DONE && !cli_interrupted();) {
        const double begin = cli_now();
        rheo_recording *recording = NULL;
        rheo_error error = {""};
        if (!f->begun && !cli_exists(f->file)) {
            if (!told)
                cli_warn("waiting for %s, which does not exist yet", f->file);
            told = true;
        } else if ((status = cli_check_recording(f->file)) == CLI_DONE) {
            const rheo_result result = rheo_recording_open(f->file, &recording, &error);
            if (result == RHEO_OK) {
                status = print_new_rows(f, recording);
                over = !rheo_recording_get_info(recording).being_written || ferror(stdout);
            } else if (f->begun ||
                       (result != RHEO_ERROR_ARGUMENT && ++failed == TRIES)) { /* that is: being written */
                status = cli_error(result, &error);
            }
            rheo_recording_close(recording);
        }
        if (!over && status == CLI_DONE && !cli_interrupted())
            pause_after(begin);
    }
    return status == CLI_DONE && cli_interrupted() ? CLI_INTERRUPTED : status;
}

static int follow_file(const char *file, const char *chosen)
{
    following f = {.file = file, .chosen = chosen};
    cli_watch_signals();
    const int status = follow(&f);
    release(&f.all);
    release(&f.some);
    return status;
}

/* ---- The list of metrics ---- */

static void list_world(const rheo_world *world)
{
    for (uint32_t i = 0; i < rheo_world_metric_count(world); i++) {
        const rheo_metric_info *info = rheo_world_metric_info(world, i);
        cli_print(stdout, 4, "%s  %s\n    %s\n", info->name, info->unit, info->meaning);
    }
}

/* Lists the metrics of a model, as of a world with one particle, and with a ball if the model has one. */
static int list_model(rheo_model model)
{
    static const rheo_real position[3];
    rheo_world_def def = rheo_default_model_def(model);
    rheo_world *world;
    rheo_error error = {""};
    def.particles.count = 1;
    def.particles.position = position;
    rheo_world_def with_ball = def;
    if (rheo_world_def_set(&with_ball, "ball.radius", "1", NULL) == RHEO_OK &&
        rheo_world_def_set(&with_ball, "ball.position", "[0, 9, 0]", NULL) == RHEO_OK)
        def = with_ball;
    const rheo_result result = rheo_world_create(&def, &world, &error);
    if (result != RHEO_OK)
        return cli_error(result, &error);
    printf("%smodel %s\n", model ? "\n" : "", rheo_model_name(model));
    list_world(world);
    rheo_world_destroy(world);
    return CLI_DONE;
}

static int list_recording(const char *file)
{
    rheo_recording *recording = NULL;
    rheo_world *world;
    rheo_error error = {""};
    const int status = cli_open_recording(file, &recording);
    if (status != CLI_DONE)
        return status;
    /* The first keyframe needs no simulation. */
    const rheo_result result =
        rheo_recording_world(recording, rheo_recording_get_info(recording).first_step, NULL, &world, &error);
    if (result == RHEO_OK)
        list_world(world);
    rheo_world_destroy(world);
    rheo_recording_close(recording);
    return result == RHEO_OK ? CLI_DONE : cli_file_error(file, result, &error);
}

static int list(int files, char **file)
{
    int status = CLI_DONE;
    if (files > 1)
        return cli_usage(&cli_metrics, "--list takes at most one recording; got %d", files);
    if (files == 1)
        return list_recording(file[0]);
    for (rheo_model model = 0; model < rheo_model_count() && status == CLI_DONE; model++)
        status = list_model(model);
    return status;
}

static int run(int argc, char **argv)
{
    bool listed = false, followed = false;
    const char *chosen = NULL;
    const cli_option options[] = {
        {"--columns", NULL, "NAME,NAME,...", CLI_TEXT, &chosen},
        {"--follow", NULL, NULL, CLI_FLAG, &followed},
        {"--list", NULL, NULL, CLI_FLAG, &listed},
        {0},
    };
    const int status = cli_parse(&cli_metrics, options, &argc, argv);
    if (status != CLI_GO_ON)
        return status;
    if (listed && (chosen || followed))
        return cli_usage(&cli_metrics, "--list lists all metrics; it does not go with %s",
                         chosen ? "--columns" : "--follow");
    if (listed)
        return list(argc, argv);
    if (argc == 0)
        return cli_usage(&cli_metrics, "needs at least one recording");
    if (followed && argc > 1)
        return cli_usage(&cli_metrics, "--follow takes one recording; got %d", argc);
    return followed ? follow_file(argv[0], chosen) : print_files(argc, argv, chosen);
}

static const char help[] = {
#include "cli/help/metrics.txt.inc"
    0};

const cli_command cli_metrics = {"metrics", help, run};
