/* The commands of `rheolog debug` that look: print, top, track, and the searches. */
#include "cli/debug.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli/found.h"
#include "cli/inspect.h"
#include "cli/track.h"
#include "cli/why.h"

/* ---- print, top ---- */

/* Fills a view with the present place. */
static int view_here(cli_session *s, cli_view *v)
{
    const int status = cli_debug_recording(s, &v->recording);
    if (status != CLI_DONE)
        return status;
    v->file = s->file;
    v->info = rheo_recording_get_info(v->recording);
    cli_inspect_at(v, cli_debug_world(s));
    v->step = v->complete + (v->done != NULL);
    return CLI_DONE;
}

static int show(cli_session *s, cli_view *v, void (*print)(const cli_view *v))
{
    int status = view_here(s, v);
    if (status == CLI_DONE)
        status = cli_inspect_gather(v);
    if (status == CLI_DONE)
        print(v);
    cli_inspect_release(v);
    return status;
}

/* The index of a metric that the recording has, in *info. A suggestion otherwise. */
static int find_metric(const cli_session *s, const char *name, const rheo_metric_info **info)
{
    const char *names[256], *nearest = "";
    char suggestion[CLI_SUGGESTION];
    uint32_t count = 0;
    for (; count < 256 && (*info = rheo_world_metric_info(cli_debug_world(s), count)) != NULL; count++) {
        names[count] = (*info)->name;
        if (strcmp(names[count], name) == 0)
            return CLI_DONE;
    }
    nearest = count ? rheo_nearest_word(name, names, count) : "";
    return cli_fail(CLI_BAD, "there is no metric \"%s\"%s (print takes particle ID, spring A:B, ball or a metric)",
                    name, cli_did_you_mean(name, nearest, suggestion));
}

static int print_metric(cli_session *s, const char *name)
{
    const rheo_metric_info *info = NULL;
    cli_view v = {0};
    int status = find_metric(s, name, &info);
    if (status == CLI_DONE)
        status = view_here(s, &v);
    if (status == CLI_DONE)
        status = cli_inspect_gather(&v);
    if (status == CLI_DONE && v.done)
        printf("at the end of step %llu:\n", (unsigned long long)v.complete);
    if (status == CLI_DONE)
        cli_inspect_text_metric(&v, info);
    cli_inspect_release(&v);
    return status;
}

/* Reads the number of a ball, if there is one. */
static int read_ball(const cli_session *s, const char *text, uint64_t *ball)
{
    const uint32_t count = rheo_world_body_count(cli_debug_world(s));
    if (!count)
        return cli_fail(CLI_BAD, "%s has no ball", s->file);
    if (*text && !cli_number_from(text, ball))
        return cli_fail(CLI_BAD, "ball needs a number, as in: ball 2; got \"%s\"", text);
    if (*text && (!*ball || *ball > count))
        return cli_fail(CLI_BAD, "%s has no ball %llu; it has %u", s->file, (unsigned long long)*ball,
                        (unsigned)count);
    return CLI_DONE;
}

int cli_debug_print(cli_session *s, const char *text)
{
    char what[64] = "";
    cli_view v = {0};
    if (!*text)
        return show(s, &v, cli_inspect_text);
    if (!cli_debug_word(&text, what, sizeof what))
        return cli_fail(CLI_BAD, "print takes particle ID, spring A:B, ball or a metric");
    if (strcmp(what, "particle") == 0) {
        v.has_particle = true;
        return cli_number_from(text, &v.particle)
                   ? show(s, &v, cli_inspect_text_things)
                   : cli_fail(CLI_BAD, "print particle needs an id, a whole number; got \"%s\"", text);
    }
    if (strcmp(what, "spring") == 0) {
        v.has_spring = true;
        return cli_ends_from(text, v.end)
                   ? show(s, &v, cli_inspect_text_things)
                   : cli_fail(CLI_BAD, "print spring needs two different ids, as 3:12; got \"%s\"", text);
    }
    if (strcmp(what, "ball") == 0) {
        v.ball = 0; /* all of them */
        const int status = read_ball(s, text, &v.ball);
        return status == CLI_DONE ? show(s, &v, cli_inspect_text_ball) : status;
    }
    if (*text)
        return cli_fail(CLI_BAD, "print takes one thing; got \"%s\" as well", text);
    return print_metric(s, what);
}

int cli_debug_top(cli_session *s, const char *text)
{
    uint64_t top = 5;
    if (*text && (!cli_number_from(text, &top) || top > 1000000))
        return cli_fail(CLI_BAD, "top needs a whole number, at most 1000000; got \"%s\"", text);
    return show(s, &(cli_view){.has_rankings = true, .top = (size_t)top}, cli_inspect_text_things);
}

/* ---- track ---- */

/* Reads what is tracked. */
static int read_item(const cli_session *s, const char **text, cli_followed *t)
{
    static const char usage[] = "track needs an item and a field, as in: track particle 17 speed";
    const rheo_world *world = cli_debug_world(s);
    char word[64] = "", id[64] = "";
    uint64_t end[2] = {0, 0};
    cli_debug_word(text, word, sizeof word);
    if (strcmp(word, "ball") == 0) {
        uint64_t ball = 1;
        const bool number = **text >= '0' && **text <= '9' && cli_debug_word(text, id, sizeof id);
        const int status = read_ball(s, number ? id : "", &ball);
        t->kind = CLI_TRACK_BALL;
        t->id = (uint32_t)ball - 1;
        return status;
    }
    const bool spring = strcmp(word, "spring") == 0;
    if ((!spring && strcmp(word, "particle") != 0) || !cli_debug_word(text, id, sizeof id))
        return cli_fail(CLI_BAD, "%s", usage);
    if (spring ? !cli_ends_from(id, end) : !cli_number_from(id, &end[0]))
        return cli_fail(CLI_BAD,
                        spring ? "spring needs two different ids, as 3:12; got \"%s\""
                               : "particle needs an id, a whole number; got \"%s\"",
                        id);
    for (int i = 0; i < 2; i++)
        if (end[i] >= rheo_world_particle_count(world))
            return cli_fail(CLI_BAD, "there is no particle %llu; ids go from 0 to %llu", (unsigned long long)end[i],
                            (unsigned long long)rheo_world_particle_count(world) - 1);
    if (spring && !cli_has_metric(world, "springs"))
        return cli_fail(CLI_BAD, "%s has no springs", s->file);
    t->kind = spring ? CLI_TRACK_SPRING : CLI_TRACK_PARTICLE;
    t->id = (uint32_t)(spring && end[1] < end[0] ? end[1] : end[0]);
    t->other = (uint32_t)(spring && end[1] < end[0] ? end[0] : end[1]);
    return CLI_DONE;
}

/* Whether a column is the field, or a component of it. */
static bool is_of(const char *column, const char *field)
{
    const size_t length = strlen(field);
    return strncmp(column, field, length) == 0 && (!column[length] || column[length] == '.');
}

static int check_field(const cli_followed *t, const char *field)
{
    const char *names[256];
    char suggestion[CLI_SUGGESTION], all[1024] = "";
    size_t known = 0;
    for (; known < t->count && known < 256; known++) {
        if (is_of(t->name[known], field))
            return CLI_DONE;
        names[known] = t->name[known];
        const size_t length = strlen(all);
        snprintf(all + length, sizeof all - length, "%s%s", known ? ", " : "", names[known]);
    }
    if (!*field)
        return cli_fail(CLI_BAD, "track needs a field, one of: %s", all);
    return cli_fail(CLI_BAD, "there is no field \"%s\"%s Fields: %s", field,
                    *cli_did_you_mean(field, rheo_nearest_word(field, names, known), suggestion) ? suggestion : ".",
                    all);
}

static void print_row(const cli_followed *t, const char *field, uint64_t step, bool header)
{
    if (header)
        printf("%8s", "step");
    else
        printf("%8llu", (unsigned long long)step);
    for (size_t i = 0; i < t->count; i++) {
        char value[32] = "-";
        if (!is_of(t->name[i], field))
            continue;
        if (!header && !isnan(t->value[i]))
            rheo_number_brief(t->value[i], 6, value);
        printf("  %14s", header ? t->name[i] : value);
    }
    putchar('\n');
}

/* Opens a player of its own, so that the session stays where it is. */
static int open_player(cli_session *s, rheo_player **player)
{
    rheo_recording *recording;
    rheo_error error = {""};
    *player = NULL;
    const int status = cli_debug_recording(s, &recording);
    if (status != CLI_DONE)
        return status;
    const rheo_result result = rheo_player_open(recording, NULL, player, &error);
    return result == RHEO_OK ? CLI_DONE : cli_file_error(s->file, result, &error);
}

static int print_rows(cli_session *s, cli_followed *t, const char *field, uint64_t from, uint64_t to)
{
    rheo_player *player;
    rheo_error error = {""};
    rheo_result result = RHEO_OK;
    const int status = open_player(s, &player);
    if (status != CLI_DONE)
        return status;
    print_row(t, field, 0, true);
    for (uint64_t step = from; step <= to && result == RHEO_OK; step++) {
        result = rheo_player_seek(player, step, &error);
        if (result == RHEO_OK)
            result = cli_track_values(t, rheo_player_world(player), &error);
        if (result == RHEO_OK)
            print_row(t, field, step, false);
    }
    rheo_player_close(player);
    return result == RHEO_OK ? CLI_DONE : cli_file_error(s->file, result, &error);
}

int cli_debug_track(cli_session *s, const char *text)
{
    cli_followed t = {.name = NULL};
    char field[64] = "", number[32] = "";
    uint64_t count = 10;
    int status = read_item(s, &text, &t);
    if (status != CLI_DONE)
        return status;
    cli_debug_word(&text, field, sizeof field);
    cli_debug_word(&text, number, sizeof number);
    const bool back = *number == '-';
    if (*text || (*number && (!cli_number_from(number + back, &count) || count == 0)))
        return cli_fail(CLI_BAD, "track needs the number of steps, as 5 or -5, at the end; got \"%s%s%s\"", number,
                        *text ? " " : "", text);
    const uint64_t here = rheo_world_step_count(cli_debug_world(s)), first = cli_debug_first(s),
                   last = cli_debug_last(s);
    const uint64_t from = !back ? here : here - first < count - 1 ? first : here - (count - 1);
    const uint64_t to = back ? here : last - here < count - 1 ? last : here + (count - 1);
    status = cli_track_columns(&t, cli_debug_world(s)) ? check_field(&t, field) : cli_fail(CLI_SYSTEM, "no memory");
    if (status == CLI_DONE)
        status = print_rows(s, &t, field, from, to);
    cli_track_release(&t);
    return status;
}

/* ---- why ---- */

/* Reads "particle ID [FIELD] [N]". */
static int read_why(const char *text, cli_why_request *r, char field[64])
{
    char word[64] = "", id[64] = "", number[32] = "";
    uint64_t depth = 1;
    cli_debug_word(&text, word, sizeof word);
    cli_debug_word(&text, id, sizeof id);
    if (strcmp(word, "particle") != 0 || !cli_number_from(id, &r->id))
        return cli_fail(CLI_BAD, "why needs a particle, as in: why particle 17, or: why particle 17 velocity 4");
    if (*text && (*text < '0' || *text > '9'))
        cli_debug_word(&text, field, 64);
    cli_debug_word(&text, number, sizeof number);
    if (*text || (*number && (!cli_number_from(number, &depth) || depth < 1 || depth > 1000)))
        return cli_fail(CLI_BAD, "why needs the number of causes, from 1 to 1000, at the end; got \"%s%s%s\"", number,
                        *text ? " " : "", text);
    r->depth = (uint32_t)depth;
    r->field = *field ? field : "position";
    return CLI_DONE;
}

/* Between steps, explains the step that led here; in the middle of a step, the last stage. */
int cli_debug_why(cli_session *s, const char *text)
{
    char stage[32], field[64] = "";
    cli_why_request r = {.file = s->file, .step = cli_debug_place(s, stage), .top = CLI_WHY_TOP};
    rheo_player *player;
    rheo_error error = {""};
    uint64_t changes;
    int status = read_why(text, &r, field);
    if (status != CLI_DONE)
        return status;
    if (r.step == cli_debug_first(s))
        return cli_fail(CLI_BAD, "step %llu is the first: no step led to it", (unsigned long long)r.step);
    r.stage = *stage ? stage : NULL;
    if ((status = open_player(s, &player)) != CLI_DONE)
        return status;
    const rheo_result result = cli_why_print(&r, player, &changes, &error);
    rheo_player_close(player);
    if (result == RHEO_ERROR_STOPPED)
        return cli_fail(CLI_INTERRUPTED, "interrupted");
    return result == RHEO_OK ? CLI_DONE : cli_file_error(s->file, result, &error);
}

/* ---- Searches ---- */

int cli_debug_searched(const cli_session *s, rheo_result result, const rheo_error *error)
{
    if (result == RHEO_ERROR_STOPPED || (result == RHEO_OK && cli_interrupted()))
        return cli_fail(CLI_INTERRUPTED, "interrupted; this is still step %llu",
                        (unsigned long long)rheo_world_step_count(cli_debug_world(s)));
    return result == RHEO_OK ? CLI_DONE : cli_file_error(s->file, result, error);
}

static int none_found(const rheo_search *found, const char *where)
{
    return found->looked ? cli_fail(CLI_BAD, "does not hold in steps %llu to %llu%s",
                                    (unsigned long long)found->first, (unsigned long long)found->last, where)
                         : cli_fail(CLI_BAD, "does not hold%s", where);
}

static bool print_found(void *data, const rheo_found *found)
{
    char text[CLI_FOUND];
    (void)data;
    puts(cli_found_text(found, text));
    return !ferror(stdout) && !cli_interrupted();
}

static int check_condition(const char *command, const char *text)
{
    return *text ? CLI_DONE : cli_fail(CLI_BAD, "%s needs a condition, as in: %s ball: y < 8", command, command);
}

int cli_debug_when(cli_session *s, const char *text)
{
    const rheo_find_options options = {.which = RHEO_FIND_ALL, .receiver = print_found};
    rheo_recording *recording;
    rheo_search found;
    rheo_error error = {""};
    int status = check_condition("when", text);
    if (status == CLI_DONE && (status = cli_debug_recording(s, &recording)) == CLI_DONE)
        status = cli_debug_searched(s, rheo_recording_find(recording, text, &options, &found, &error), &error);
    return status == CLI_DONE && !found.hits ? none_found(&found, "") : status;
}

/* Goes to a place, and prints it. */
static int go_to(cli_session *s, const char *condition, const rheo_find_options *options, rheo_search *found)
{
    const int status = cli_debug_find(s, condition, options, found);
    if (status == CLI_DONE && found->hits)
        print_found(NULL, &found->found);
    return status;
}

/* Runs the fork on to the first step at which a condition holds, as far as the recording goes. */
static int run_until(cli_session *s, const char *condition, bool *holds)
{
    rheo_found found;
    rheo_error error = {""};
    *holds = false;
    while (!*holds && cli_debug_last(s) < s->info.last_step) {
        int status = cli_debug_run_on(s, 1);
        if (status == CLI_DONE)
            status = cli_debug_searched(s, rheo_world_holds(s->fork.tip, condition, holds, &found, &error), &error);
        if (status != CLI_DONE)
            return status;
    }
    if (*holds)
        print_found(NULL, &found);
    return CLI_DONE;
}

int cli_debug_until(cli_session *s, const char *text)
{
    const uint64_t here = rheo_world_step_count(cli_debug_world(s));
    const rheo_find_options options = {.which = RHEO_FIND_FIRST, .has_after = true, .after = here};
    rheo_search found = {.hits = 0};
    bool holds = false;
    int status = check_condition("until", text);
    if (status == CLI_DONE && !s->fork.tip && here == cli_debug_last(s))
        return cli_fail(CLI_BAD, "step %llu is the last", (unsigned long long)here);
    if (status == CLI_DONE && here < cli_debug_last(s))
        status = go_to(s, text, &options, &found);
    if (status != CLI_DONE || found.hits || !s->fork.tip)
        return status != CLI_DONE || found.hits ? status : none_found(&found, "");
    found = (rheo_search){.looked = true, .first = here + 1, .last = s->info.last_step};
    status = run_until(s, text, &holds);
    if (status != CLI_DONE || holds)
        return status;
    status = cli_debug_seek(s, here);
    return status == CLI_DONE ? none_found(&found, ", as far as the recording goes") : status;
}

int cli_debug_back_until(cli_session *s, const char *text)
{
    char stage[32];
    const rheo_find_options options = {
        .which = RHEO_FIND_LAST, .has_before = true, .before = cli_debug_place(s, stage)};
    rheo_search found;
    int status = check_condition("back until", text);
    if (status == CLI_DONE && options.before == cli_debug_first(s))
        return cli_fail(CLI_BAD, "step %llu is the first", (unsigned long long)options.before);
    if (status == CLI_DONE && (status = go_to(s, text, &options, &found)) == CLI_DONE && !found.hits)
        return none_found(&found, "");
    return status;
}
