/* rheolog track: prints a particle, a spring, a ball or a point of a recording through time. */
#include "cli/track.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_FIELDS = 64 };

typedef struct arguments {
    const char *file, *spring, *probe, *field, *simd;
    cli_number particle, ball;
    bool history, stages, cost, json;
    cli_steps steps;
    rheo_recording *recording;
    cli_followed track;
    size_t chosen[MOST_FIELDS], fields; /* columns of --field; none: all */
} arguments;

/* ---- What is followed ---- */

static int read_ends(const char *text, cli_followed *t)
{
    char first[32];
    uint64_t a, b;
    const size_t length = strcspn(text, ":");
    snprintf(first, sizeof first, "%.*s", length < sizeof first ? (int)length : 0, text);
    if (!text[length] || !cli_number_from(first, &a) || !cli_number_from(text + length + 1, &b) || a == b ||
        a > UINT32_MAX || b > UINT32_MAX)
        return cli_usage(&cli_track, "--spring needs two different ids, as 3:12; got \"%s\"", text);
    t->id = (uint32_t)(a < b ? a : b);
    t->other = (uint32_t)(a < b ? b : a);
    return CLI_DONE;
}

static int read_point(const char *text, double point[3])
{
    char word[3][40];
    char rest;
    if (sscanf(text, "%39[^,],%39[^,],%39[^,]%c", word[0], word[1], word[2], &rest) != 3)
        return cli_usage(&cli_track, "--probe needs three coordinates, as 24,20,24; got \"%s\"", text);
    for (int axis = 0; axis < 3; axis++) {
        const int status = cli_read_number(&cli_track, "--probe", word[axis], -1e12, 1e12, false, &point[axis]);
        if (status != CLI_DONE)
            return status;
    }
    return CLI_DONE;
}

static int check_usage(arguments *a, int argc)
{
    cli_followed *t = &a->track;
    if (argc != 1)
        return cli_usage(&cli_track, "needs one recording; got %d", argc);
    if (a->particle.given + (a->spring != NULL) + a->ball.given + (a->probe != NULL) != 1)
        return cli_usage(&cli_track, "needs one of --particle ID, --spring A:B, --ball [N] and --probe X,Y,Z");
    if (a->particle.given && a->particle.value > UINT32_MAX)
        return cli_usage(&cli_track, "--particle: ids are at most 4294967295");
    if (a->ball.given && (a->ball.value < 1 || a->ball.value > RHEO_MAX_BALLS))
        return cli_usage(&cli_track, "--ball: balls are numbered from 1 to at most %d", RHEO_MAX_BALLS);
    if (a->history && (a->ball.given || a->probe))
        return cli_usage(&cli_track, "--history goes with --particle and --spring; others have none");
    t->kind = a->spring       ? CLI_TRACK_SPRING
              : a->ball.given ? CLI_TRACK_BALL
              : a->probe      ? CLI_TRACK_PROBE
                              : CLI_TRACK_PARTICLE;
    t->id = (uint32_t)(a->ball.given ? a->ball.value - 1 : a->particle.value);
    t->history = a->history;
    if (!a->steps.every.given)
        a->steps.every = (cli_number){true, 1};
    int status = cli_check_steps(&cli_track, &a->steps);
    if (status == CLI_DONE && a->spring)
        status = read_ends(a->spring, t);
    return status == CLI_DONE && a->probe ? read_point(a->probe, t->point) : status;
}

/* Chooses the columns of --field. */
static int choose_fields(arguments *a)
{
    const cli_followed *t = &a->track;
    for (const char *word = a->field; word; word = *word ? word + 1 : NULL) {
        const size_t length = strcspn(word, ",");
        char name[CLI_TRACK_NAME];
        snprintf(name, sizeof name, "%.*s", length < sizeof name ? (int)length : 0, word);
        size_t i = 0;
        while (i < t->count && strcmp(t->name[i], name) != 0)
            i++;
        if (i == t->count) {
            const char *names[256];
            size_t known = 0;
            for (; known < t->count && known < 256; known++)
                names[known] = t->name[known];
            char suggestion[CLI_SUGGESTION];
            return cli_usage(&cli_track, "there is no column \"%s\"%s", name,
                             cli_did_you_mean(name, rheo_nearest_word(name, names, known), suggestion));
        }
        if (a->fields == MOST_FIELDS)
            return cli_usage(&cli_track, "--field takes at most %d columns", MOST_FIELDS);
        a->chosen[a->fields++] = i;
        word += length;
        if (!*word)
            break;
    }
    return CLI_DONE;
}

static bool has_springs(const rheo_world *world)
{
    rheo_field_info field;
    for (uint32_t i = 0; i < rheo_world_field_count(world); i++)
        if (rheo_world_field(world, i, &field) == RHEO_OK && strcmp(field.name, "spring_ends") == 0)
            return true;
    return false;
}

/* The things must be there: the particle at some time, the ball always. */
static int check_things(const arguments *a, const rheo_world *world)
{
    const cli_followed *t = &a->track;
    if (t->kind == CLI_TRACK_BALL && rheo_world_body_count(world) == 0)
        return cli_fail(CLI_BAD, "%s has no ball", a->file);
    if (t->kind == CLI_TRACK_BALL && t->id >= rheo_world_body_count(world))
        return cli_fail(CLI_BAD, "%s has no ball %u; it has %u", a->file, (unsigned)t->id + 1,
                        (unsigned)rheo_world_body_count(world));
    if (t->kind == CLI_TRACK_SPRING && !has_springs(world))
        return cli_fail(CLI_BAD, "%s has no springs", a->file);
    uint64_t particles = rheo_recording_get_info(a->recording).particles;
    for (uint64_t i = 0; i < rheo_recording_command_count(a->recording); i++) {
        rheo_command c;
        if (rheo_recording_command(a->recording, i, &c, NULL) == RHEO_OK && c.kind == RHEO_COMMAND_ADD_PARTICLES)
            particles += c.count;
    }
    const rheo_world_def *def = rheo_recording_definition(a->recording);
    for (uint32_t k = 0; k < def->emitters.count; k++)
        particles += def->emitters.list[k].limit;
    const uint32_t id = t->other > t->id ? t->other : t->id;
    if (t->kind <= CLI_TRACK_SPRING && id >= particles)
        return cli_fail(CLI_BAD, "%s has no particle %u; its particles are 0 to %llu", a->file, (unsigned)id,
                        (unsigned long long)(particles - (particles > 0)));
    return CLI_DONE;
}

/* ---- Output ---- */

static size_t columns_of(const arguments *a)
{
    return a->fields ? a->fields : a->track.count;
}

static size_t column_of(const arguments *a, size_t i)
{
    return a->fields ? a->chosen[i] : i;
}

static void print_header(const arguments *a)
{
    if (a->json)
        return;
    fputs(a->stages ? "step,stage,time" : "step,time", stdout);
    for (size_t i = 0; i < columns_of(a); i++)
        printf(",%s", a->track.name[column_of(a, i)]);
    putchar('\n');
}

static void print_json(const arguments *a, uint64_t step, const char *stage, double time)
{
    rheo__json json = {.file = stdout};
    rheo__json_begin_object(&json, NULL);
    rheo__json_integer(&json, "step", step);
    if (a->stages)
        rheo__json_text(&json, "stage", *stage ? stage : NULL);
    rheo__json_number(&json, "time", time);
    for (size_t i = 0; i < columns_of(a); i++)
        rheo__json_number(&json, a->track.name[column_of(a, i)], a->track.value[column_of(a, i)]);
    rheo__json_end_object(&json);
}

/* Prints a line. The time is that of the last complete step. */
static int print(arguments *a, const rheo_world *world, uint64_t step, const char *stage)
{
    rheo_error error = {""};
    char text[32];
    const rheo_result result = cli_track_values(&a->track, world, &error);
    if (result != RHEO_OK)
        return cli_file_error(a->file, result, &error);
    if (a->json) {
        print_json(a, step, stage, rheo_world_time(world));
        return CLI_DONE;
    }
    rheo__number_text(rheo_world_time(world), text, sizeof text);
    printf("%llu,%s%s%s", (unsigned long long)step, a->stages ? stage : "", a->stages ? "," : "", text);
    for (size_t i = 0; i < columns_of(a); i++) {
        const double value = a->track.value[column_of(a, i)];
        *text = 0;
        if (!isnan(value))
            rheo__number_text(value, text, sizeof text);
        printf(",%s", text);
    }
    putchar('\n');
    return CLI_DONE;
}

static int print_step(void *data, rheo_player *player, uint64_t index)
{
    arguments *a = data;
    return print(a, rheo_player_world(player), cli_step_at(&a->steps, index), "");
}

/* Prints a line after every stage of a step. The player must be at the step before. */
static int print_stages(arguments *a, rheo_player *player, uint64_t step)
{
    const rheo_world *world = rheo_player_world(player);
    int status = CLI_DONE;
    uint32_t last = 0;
    do {
        rheo_error error = {""};
        char name[CLI_STAGE_NAME];
        uint32_t stage;
        const rheo_result result = rheo_player_stage(player, &stage, &error);
        if (result != RHEO_OK)
            return cli_file_error(a->file, result, &error);
        cli_stage_run_name(world, stage, &last, name);
        status = print(a, world, step, name);
    } while (status == CLI_DONE && rheo_world_stages_done(world) > 0);
    return status;
}

/* Goes into each of the steps; the first state of a recording has no stages, and is printed as it is. */
static int print_all_stages(arguments *a, rheo_player *player)
{
    const uint64_t first = rheo_recording_get_info(a->recording).first_step;
    int status = CLI_DONE;
    for (uint64_t i = 0; i < a->steps.count && status == CLI_DONE; i++) {
        const uint64_t step = cli_step_at(&a->steps, i);
        rheo_error error = {""};
        if (cli_interrupted())
            return cli_fail(CLI_INTERRUPTED, "%s: interrupted before step %llu", a->file, (unsigned long long)step);
        const rheo_result result = rheo_player_seek(player, step > first ? step - 1 : first, &error);
        if (result != RHEO_OK)
            return cli_file_error(a->file, result, &error);
        status = step > first ? print_stages(a, player, step) : print(a, rheo_player_world(player), step, "");
    }
    return status;
}

static int follow(arguments *a)
{
    rheo_error error = {""};
    rheo_player *player = NULL;
    cli_watch_signals();
    const rheo_result result = rheo_player_open(a->recording, NULL, &player, &error);
    int status = result == RHEO_OK ? cli_choose_steps(a->file, a->recording, &a->steps)
                                   : cli_file_error(a->file, result, &error);
    if (status == CLI_DONE)
        status = check_things(a, rheo_player_world(player));
    if (status == CLI_DONE && !cli_track_columns(&a->track, rheo_player_world(player)))
        status = cli_fail(CLI_SYSTEM, "no memory");
    if (status == CLI_DONE)
        status = choose_fields(a);
    if (status == CLI_DONE) {
        print_header(a);
        status = a->stages ? print_all_stages(a, player) : cli_write_steps(a->file, &a->steps, player, print_step, a);
    }
    cli_track_release(&a->track);
    rheo_player_close(player);
    return status;
}

static int run(int argc, char **argv)
{
    arguments a = {.file = NULL};
    const cli_option options[] = {
        {"--particle", NULL, "ID", CLI_NUMBER, &a.particle},
        {"--spring", NULL, "A:B", CLI_TEXT, &a.spring},
        {"--ball", NULL, "[N]", CLI_OPTIONAL, &a.ball},
        {"--probe", NULL, "X,Y,Z", CLI_TEXT, &a.probe},
        {"--field", NULL, "NAME,NAME,...", CLI_TEXT, &a.field},
        {"--history", NULL, NULL, CLI_FLAG, &a.history},
        {"--every", NULL, "N", CLI_NUMBER, &a.steps.every},
        {"--from", NULL, "N", CLI_NUMBER, &a.steps.from},
        {"--to", NULL, "N", CLI_NUMBER, &a.steps.to},
        {"--stages", NULL, NULL, CLI_FLAG, &a.stages},
        {"--cost", NULL, NULL, CLI_FLAG, &a.cost},
        {"--simd", NULL, "NAME", CLI_TEXT, &a.simd},
        {"--json", NULL, NULL, CLI_FLAG, &a.json},
        {0},
    };
    int status = cli_parse(&cli_track, options, &argc, argv);
    if (status != CLI_GO_ON)
        return status;
    a.file = argc > 0 ? argv[0] : NULL;
    if ((status = check_usage(&a, argc)) == CLI_DONE && (status = cli_use_simd(a.simd)) == CLI_DONE &&
        (status = cli_open_recording(a.file, &a.recording)) == CLI_DONE)
        status = follow(&a);
    if (a.cost)
        cli_say_cost((cli_cost){.seconds = 0});
    rheo_recording_close(a.recording);
    return status;
}

static const char help[] = {
#include "cli/help/track.txt.inc"
    0};

const cli_command cli_track = {"track", help, run};
