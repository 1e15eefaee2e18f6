/* The commands of `rheolog debug`: their table, those that move, and help. */
#include "cli/debug.h"

#include <string.h>

#include "cli/inspect.h"
#include "cli/provenance.h"

/* ---- Words ---- */

static const char *skip_blanks(const char *text)
{
    return text + strspn(text, " \t");
}

bool cli_debug_word(const char **text, char *word, size_t size)
{
    const size_t length = strcspn(*text, " \t");
    *word = 0;
    if (length == 0 || length >= size)
        return false;
    memcpy(word, *text, length);
    word[length] = 0;
    *text = skip_blanks(*text + length);
    return true;
}

static int take_nothing(const char *command, const char *text)
{
    return *text ? cli_fail(CLI_BAD, "%s takes no arguments; got \"%s\"", command, text) : CLI_DONE;
}

static int read_count(const char *command, const char *text, uint64_t *count)
{
    *count = 1;
    return !*text || cli_number_from(text, count)
               ? CLI_DONE
               : cli_fail(CLI_BAD, "%s needs a number of steps; got \"%s\"", command, text);
}

/* ---- Moves ---- */

static void say_failed(const cli_session *s)
{
    rheo_failure failure;
    char why[512];
    if (!s->fork.tip && rheo_recording_failure(s->recording, &failure)) {
        rheo_failure_message(&failure, why, sizeof why);
        printf("the run ended here: %s\n", why);
    }
}

static int step(cli_session *s, const char *text)
{
    const uint64_t here = rheo_world_step_count(cli_debug_world(s)), last = cli_debug_last(s);
    uint64_t count;
    int status = read_count("step", text, &count);
    if (status != CLI_DONE || count == 0)
        return status;
    if (count > UINT64_MAX - here)
        return cli_fail(CLI_BAD, "there is no step %s steps from here", text);
    if (here + count <= last)
        return cli_debug_seek(s, here + count);
    if (s->fork.tip)
        return cli_debug_run_on(s, here + count - last);
    if (here == last)
        return cli_fail(CLI_BAD, "step %llu is the last%s", (unsigned long long)last,
                        rheo_recording_failure(s->recording, &(rheo_failure){0})
                            ? "; stage goes on into the step that failed"
                            : "");
    status = cli_debug_seek(s, last);
    if (status == CLI_DONE) {
        printf("step %llu is the last\n", (unsigned long long)last);
        say_failed(s);
    }
    return status;
}

static int back(cli_session *s, const char *text)
{
    char stage[32], word[32];
    const char *rest = text;
    uint64_t count;
    if (cli_debug_word(&rest, word, sizeof word) && strncmp("until", word, strlen(word)) == 0)
        return cli_debug_back_until(s, rest);
    const uint64_t here = cli_debug_place(s, stage), first = cli_debug_first(s);
    const int status = read_count("back", text, &count);
    if (status != CLI_DONE || count == 0)
        return status;
    if (here == first)
        return cli_fail(CLI_BAD, "step %llu is the first", (unsigned long long)first);
    if (here - first < count)
        printf("step %llu is the first\n", (unsigned long long)first);
    return cli_debug_seek(s, here - first < count ? first : here - count);
}

static int stage(cli_session *s, const char *text)
{
    const int status = take_nothing("stage", text);
    return status == CLI_DONE ? cli_debug_seek_stage(s, rheo_world_step_count(cli_debug_world(s)) + 1, NULL) : status;
}

static int go(cli_session *s, const char *text)
{
    char word[32];
    uint64_t to = 0;
    if (!cli_debug_word(&text, word, sizeof word))
        return cli_fail(CLI_BAD, "goto needs a step, first or last");
    if (strcmp(word, "first") == 0)
        to = cli_debug_first(s);
    else if (strcmp(word, "last") == 0)
        to = cli_debug_last(s);
    else if (!cli_number_from(word, &to))
        return cli_fail(CLI_BAD, "goto needs a step, first or last; got \"%s\"", word);
    if (!*text)
        return cli_debug_seek(s, to);
    const cli_view v = {.file = s->fork.tip ? "the fork" : s->file, .stage = text};
    const int status = cli_inspect_check_stage(&v, cli_debug_world(s));
    return status == CLI_DONE ? cli_debug_seek_stage(s, to, text) : status;
}

/* ---- Others ---- */

static int info(cli_session *s, const char *text)
{
    rheo_recording *recording;
    int status = take_nothing("info", text);
    if (status == CLI_DONE && (status = cli_debug_recording(s, &recording)) == CLI_DONE)
        cli_info_print(s->fork.tip ? "the fork" : s->file, recording, false);
    return status;
}

static int list_log(cli_session *s, const char *text)
{
    rheo_recording *recording;
    int status = take_nothing("log", text);
    if (status == CLI_DONE && (status = cli_debug_recording(s, &recording)) == CLI_DONE)
        status = cli_log_print(s->fork.tip ? "the fork" : s->file, recording, false);
    return status;
}

static int quit(cli_session *s, const char *text)
{
    const int status = take_nothing("quit", text);
    s->quit = status == CLI_DONE;
    return status;
}

static int help(cli_session *s, const char *text);

static const cli_debug_command COMMANDS[] = {
    {"step", "[N]", "go N steps forward, 1 without N",
     "In the middle of a step, finishes it first. A fork is run on.", step},
    {"back", "[N] | until CONDITION", "go N steps back, or to the last place before",
     "back until CONDITION goes to the last step before this one at which it holds.", back},
    {"stage", "", "run the next stage of the next step",
     "After the last step, it also runs the stages of a step that failed.", stage},
    {"goto", "S [STAGE] | first | last", "go to step S, or after a stage of it",
     "STAGE is the name of a stage, in a substep with @ and its number: goto 18 forces@2.", go},
    {"when", "CONDITION", "list the steps at which a condition holds",
     "The place stays. `rheolog help when` says what a condition is: ball: y < 8, particle 17: speed > 5 and so on.",
     cli_debug_when},
    {"until", "CONDITION", "go forward to the first step at which it holds",
     "If there is none, the place stays. A fork is run on, as far as the recording goes.", cli_debug_until},
    {"print", "[ITEM | METRIC]", "print the state, an item or a metric",
     "ITEM is particle ID, spring A:B or ball [N]. In the middle of a step, metrics are those of the step before.",
     cli_debug_print},
    {"top", "[N]", "list the N densest, fastest, ... particles", "Without N, 5 of each list.", cli_debug_top},
    {"track", "ITEM FIELD [N]", "print a field in the next N steps, or the last with -N",
     "Without N, 10 steps, this one included. ITEM is particle ID, spring A:B or ball [N]; a vector is all its components.",
     cli_debug_track},
    {"why", "particle ID [FIELD] [N]", "say who changed a particle, and N causes",
     "In the step that led here, or in the stage. FIELD is position, velocity, ...; `rheolog help why` says more.",
     cli_debug_why},
    {"set", "PARAMETER VALUE", "begin a fork: a new run from here, with a change",
     "The recording stays as it is. At the end of a fork, the fork goes on with the change; before its end, another fork "
     "takes its place. Commands that the recording has after this step are not given.",
     cli_debug_set},
    {"original", "", "leave the fork, back to where it began", "The fork is gone unless it was saved.",
     cli_debug_original},
    {"diff", "", "compare the fork with the recording at this step",
     "Lists the fields with their largest differences.", cli_debug_diff},
    {"save", "FILE", "write this state, or the whole fork, as a recording", "FILE must not exist.", cli_debug_save},
    {"info", "", "print the contents of the recording", "As `rheolog info`; in a fork, those of the fork.", info},
    {"log", "", "list how it was made, and its commands", "As `rheolog log`; in a fork, those of the fork.",
     list_log},
    {"help", "[COMMAND]", "list the commands, or describe one", "A command may be shortened as long as it is clear.",
     help},
    {"quit", "", "end", "So does Ctrl-D.", quit},
};

enum { COMMAND_COUNT = sizeof COMMANDS / sizeof COMMANDS[0] };

const cli_debug_command *cli_debug_command_at(size_t index)
{
    return index < COMMAND_COUNT ? &COMMANDS[index] : NULL;
}

/* Finds a command by its name or an unambiguous beginning of it. NULL after a message. */
static const cli_debug_command *find(const char *word)
{
    const cli_debug_command *found = NULL;
    const char *names[COMMAND_COUNT];
    char all[256] = "", suggestion[CLI_SUGGESTION];
    size_t matches = 0;
    for (size_t i = 0; i < COMMAND_COUNT; i++) {
        names[i] = COMMANDS[i].name;
        if (strcmp(word, names[i]) == 0)
            return &COMMANDS[i];
        if (strncmp(word, names[i], strlen(word)) != 0)
            continue;
        const size_t length = strlen(all);
        snprintf(all + length, sizeof all - length, "%s%s", matches++ ? ", " : "", names[i]);
        found = &COMMANDS[i];
    }
    if (matches == 1)
        return found;
    if (matches)
        cli_fail(CLI_BAD, "\"%s\" may be %s", word, all);
    else
        cli_fail(CLI_BAD, "there is no command \"%s\"%s (help lists them)", word,
                 cli_did_you_mean(word, rheo_nearest_word(word, names, COMMAND_COUNT), suggestion));
    return NULL;
}

static int help(cli_session *s, const char *text)
{
    (void)s;
    if (*text) {
        const cli_debug_command *c = find(text);
        if (c)
            cli_print(stdout, 0, "%s%s%s: %s\n%s\n", c->name, *c->arguments ? " " : "", c->arguments, c->purpose,
                      c->more);
        return c ? CLI_DONE : CLI_BAD;
    }
    for (size_t i = 0; i < COMMAND_COUNT; i++) {
        char usage[64];
        snprintf(usage, sizeof usage, "%s %s", COMMANDS[i].name, COMMANDS[i].arguments);
        printf("%-29s %s\n", usage, COMMANDS[i].purpose);
    }
    return CLI_DONE;
}

int cli_debug_run(cli_session *s, const char *line)
{
    char word[32];
    char text[CLI_DEBUG_LINE];
    snprintf(text, sizeof text, "%s", skip_blanks(line));
    for (size_t length = strlen(text); length && strchr(" \t\r", text[length - 1]); length--)
        text[length - 1] = 0;
    const char *rest = text;
    if (!cli_debug_word(&rest, word, sizeof word))
        return cli_fail(CLI_BAD, "there is no command \"%.40s\" (help lists them)", text);
    const cli_debug_command *command = find(word);
    return command ? command->run(s, rest) : CLI_BAD;
}
