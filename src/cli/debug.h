/* Shared by the files of `rheolog debug`: the session, which is at a place in a recording or in a fork of it. */
#ifndef CLI_DEBUG_H
#define CLI_DEBUG_H

#include "cli/cli.h"

/* A new run from a state of the recording, recorded in memory. Its last state is a world that can go on. */
typedef struct cli_fork {
    rheo_world *tip; /* NULL: there is no fork */
    rheo_recorder *recorder;
    uint64_t start; /* step of the recording from which it goes on */
    bool at_tip;    /* the session is at the tip; else it is where the player is */
    /* A copy of what has been recorded, with its player; NULL until they are needed, and after more steps. */
    void *bytes;
    rheo_recording *recording;
    rheo_player *player;
} cli_fork;

typedef struct cli_session {
    const char *file;
    char name[64]; /* of the file, for the prompt */
    rheo_recording *recording;
    rheo_recording_info info;
    rheo_player *player;
    cli_fork fork;
    char last[1024]; /* the last command, which an empty line repeats */
    bool quit, cost; /* cost: tell what each command took */
} cli_session;

/* ---- The place (debug_fork.c) ---- */

const rheo_world *cli_debug_world(const cli_session *s);
/* Step and stage as `inspect` names them: in the middle of a step, the step that is being made. "": between steps. */
uint64_t cli_debug_place(const cli_session *s, char stage[32]);
/* Last step of the recording, or of the fork as far as it was run. */
uint64_t cli_debug_last(const cli_session *s);
uint64_t cli_debug_first(const cli_session *s);
/* The recording, or what the fork has recorded so far. Returns an exit code, as the functions below. */
int cli_debug_recording(cli_session *s, rheo_recording **recording);
/* Moves to the first or last step at which a condition holds. Stays if found->hits is 0. A fork is not run on. */
int cli_debug_find(cli_session *s, const char *condition, const rheo_find_options *options, rheo_search *found);
/* The exit code of a search; a message if it failed or was interrupted. */
int cli_debug_searched(const cli_session *s, rheo_result result, const rheo_error *error);
/* Moves to a step. A fork is not run on. */
int cli_debug_seek(cli_session *s, uint64_t step);
/* Moves after a stage; NULL: the next one. A fork is run on by one step if it must be. */
int cli_debug_seek_stage(cli_session *s, uint64_t step, const char *stage);
/* Runs the fork on from its tip. */
int cli_debug_run_on(cli_session *s, uint64_t steps);

/* ---- Commands ---- */

typedef struct cli_debug_command {
    const char *name, *arguments, *purpose, *more;
    int (*run)(cli_session *s, const char *text); /* text: the arguments, without blanks around them */
} cli_debug_command;

/* The commands by index; NULL past the last. */
const cli_debug_command *cli_debug_command_at(size_t index);
/* Runs a line. Returns an exit code; a message was printed unless it is CLI_DONE. */
int cli_debug_run(cli_session *s, const char *line);
/* Copies the next word and moves past it and the blanks behind it. False: there is none, or it is too long. */
bool cli_debug_word(const char **text, char *word, size_t size);

int cli_debug_when(cli_session *s, const char *text);
int cli_debug_until(cli_session *s, const char *text);
int cli_debug_back_until(cli_session *s, const char *text);
int cli_debug_print(cli_session *s, const char *text);
int cli_debug_top(cli_session *s, const char *text);
int cli_debug_why(cli_session *s, const char *text);
int cli_debug_track(cli_session *s, const char *text);
int cli_debug_set(cli_session *s, const char *text);
int cli_debug_original(cli_session *s, const char *text);
int cli_debug_save(cli_session *s, const char *text);
int cli_debug_diff(cli_session *s, const char *text);
void cli_debug_fork_release(cli_fork *fork);

/* ---- Input (debug_input.c) ---- */

enum { CLI_DEBUG_LINE = 1024 };

typedef struct cli_input cli_input;

/* Opens standard input: with a line editor, history and completion on a terminal if the program has libedit. NULL: no memory. */
cli_input *cli_input_open(cli_session *s);
void cli_input_close(cli_input *input);
/* Whether it is a terminal, which shows what is typed. */
bool cli_input_is_terminal(const cli_input *input);
/* Reads a line without its end. False: no more. *interrupted: Ctrl-C ended the line, and there is none. */
bool cli_input_read(cli_input *input, const char *prompt, char line[CLI_DEBUG_LINE], bool *interrupted);

/*
 * Lists the words that can stand at the end of `line`, and begin with the last word of it: calls `receive` with each. Returns
 * the length of that last word.
 */
size_t cli_debug_complete(const cli_session *s, const char *line, void (*receive)(void *data, const char *word),
                          void *data);

#endif
