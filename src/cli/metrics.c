/* rheolog metrics: prints the recorded metrics of recordings as CSV, or lists them. Nothing is simulated. */
#define _POSIX_C_SOURCE 200809L
#include "cli/cli.h"

#include <stdlib.h>
#include <string.h>

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

/* Collects the metrics of all recordings. Those that cannot be read are reported when they are to be printed. */
static int all_columns(columns *c, int files, char **file)
{
    int status = CLI_DONE;
    for (int i = 0; i < files && status == CLI_DONE; i++) {
        rheo_recording *recording;
        if (!cli_exists(file[i]) || rheo_recording_open(file[i], &recording, NULL) != RHEO_OK)
            continue;
        for (uint32_t m = 0; m < rheo_recording_metric_count(recording) && status == CLI_DONE; m++) {
            const char *name = rheo_recording_metric_name(recording, m);
            status = add_column(c, name, strlen(name));
        }
        rheo_recording_close(recording);
    }
    return status;
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
            return cli_usage(&cli_metrics, "there is no metric \"%s\"; did you mean \"%s\"?", word,
                             rheo_nearest_word(word, (const char *const *)all->name, all->count));
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

/* Quotes text that has a comma, a quote or a line break. */
static void put_text(const char *text)
{
    if (!text[strcspn(text, ",\"\r\n")]) {
        fputs(text, stdout);
        return;
    }
    putchar('"');
    for (; *text; text++) {
        if (*text == '"')
            putchar('"');
        putchar(*text);
    }
    putchar('"');
}

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
        put_text(file);
    for (size_t i = 0; i < c->count; i++) {
        char text[32] = "";
        if (index[i] < count)
            rheo__number_text(values[index[i]], text, sizeof text);
        printf("%s%s", i || file ? "," : "", text);
    }
    putchar('\n');
}

/* `file` is NULL if the rows do not name it. */
static int print_rows(rheo_recording *recording, const columns *c, const char *file)
{
    const rheo_recording_info info = rheo_recording_get_info(recording);
    const uint32_t count = rheo_recording_metric_count(recording);
    uint32_t index[MOST_COLUMNS];
    for (size_t i = 0; i < c->count; i++)
        index[i] = rheo_recording_metric_by_name(recording, c->name[i]);
    double *values = malloc((count + 1) * sizeof *values);
    if (!values)
        return cli_fail(CLI_SYSTEM, "no memory");
    int status = info.complete ? CLI_DONE : CLI_BAD;
    for (uint64_t step = info.first_step; step <= info.last_step; step++) {
        rheo_error error = {""};
        const rheo_result result = rheo_recording_metrics(recording, step, values, &error);
        if (result != RHEO_OK) {
            status = cli_error(result, &error);
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
        if (status == CLI_DONE)
            status = print_rows(recording, c, files > 1 ? file[i] : NULL);
        rheo_recording_close(recording);
        worst = status > worst ? status : worst;
    }
    release(&all);
    release(&some);
    return worst;
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
    return result == RHEO_OK ? CLI_DONE : cli_error(result, &error);
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
    bool listed = false;
    const char *chosen = NULL;
    const cli_option options[] = {
        {"--columns", NULL, "NAME,NAME,...", CLI_TEXT, &chosen},
        {"--list", NULL, NULL, CLI_FLAG, &listed},
        {0},
    };
    const int status = cli_parse(&cli_metrics, options, &argc, argv);
    if (status != CLI_GO_ON)
        return status;
    if (listed && chosen)
        return cli_usage(&cli_metrics, "--list lists all metrics; it does not go with --columns");
    if (listed)
        return list(argc, argv);
    if (argc == 0)
        return cli_usage(&cli_metrics, "needs at least one recording");
    return print_files(argc, argv, chosen);
}

static const char help[] = {
#include "cli/help/metrics.txt.inc"
    0};

const cli_command cli_metrics = {"metrics", help, run};
