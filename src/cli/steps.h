/* Shared by commands that write a file for each of several steps: `export` and `render`. */
#ifndef CLI_STEPS_H
#define CLI_STEPS_H

#include "cli/cli.h"

enum { CLI_MOST_STEPS = 64 };

/* The options --step, --steps, --every, --from, --to and --stage, and the steps that they choose. */
typedef struct cli_steps {
    cli_number step, every, from, to;
    const char *list;            /* of --steps */
    const char *stage;           /* the state right after this stage of --step; NULL: at the end of steps */
    uint64_t at[CLI_MOST_STEPS]; /* count, if there is a list */
    uint64_t first, last, apart, count;
} cli_steps;

/* Whether steps are chosen by more than --step. */
bool cli_steps_are_several(const cli_steps *steps);
/* Reads the list of --steps, and refuses options that do not go together. */
int cli_check_steps(const cli_command *command, cli_steps *steps);
/* Chooses the steps of a recording; without options its last. Refuses steps that it does not hold. */
int cli_choose_steps(const char *path, const rheo_recording *recording, cli_steps *steps);
uint64_t cli_step_at(const cli_steps *steps, uint64_t index);
/* Moves a player to one of the steps, or right after the stage of it. The path is for messages. */
int cli_seek(const char *path, const cli_steps *steps, rheo_player *player, uint64_t index);

/* Reads the number of an option, between two numbers; `inside`: strictly. Text NULL keeps the value. */
int cli_read_number(const cli_command *command, const char *option, const char *text, double minimum, double maximum,
                    bool inside, double *value);

/* Reads numbers with commas between them, as many as `value` has room for. */
int cli_read_numbers(const cli_command *command, const char *option, const char *text, uint32_t count, double limit,
                     double *value);
/* Reads MIN,MAX of --range. */
int cli_read_range(const cli_command *command, const char *text, double range[2]);

enum { CLI_FILE_NAME = 256, CLI_FILE_PATH = 4096 + 300 };
/* File names begin with the name of the recording, without its extension. */
int cli_choose_name(const char *recording, const char *folder, char name[CLI_FILE_NAME]);
/* Makes a folder for files, unless there is one. */
int cli_make_folder(const char *folder);
/* Refuses an existing file, before any step is simulated. */
int cli_refuse_existing(const char *path, bool force);

/* Results are NAME.csv, and NAME.svg for a plot of them, in the folder of -o. The path of one of them; CLI_BAD if it is too long. */
int cli_results_path(const char *folder, const char *name, const char *ending, char path[CLI_FILE_PATH]);
/* Whether they can be written, which is asked before they are computed. Those that exist are replaced. */
int cli_check_results(const char *folder, const char *name, bool plot);

/* Computes one extent for all pictures: it contains those of the first and the last step. */
int cli_find_extent(const char *path, const cli_steps *steps, rheo_player *player, rheo_extent *extent);

/*
 * The name of the stage run that rheo_player_stage() has just made, also of the last one of its step. *last: runs of the last
 * stage in the step, 0 before its first run.
 */
enum { CLI_STAGE_NAME = 48 };
void cli_stage_run_name(const rheo_world *world, uint32_t stage, uint32_t *last, char name[CLI_STAGE_NAME]);

/* Writes the files of a step, at which the player is. Returns CLI_DONE to go on. */
typedef int cli_write_step(void *data, rheo_player *player, uint64_t index);
/* Chooses one range of colours for all pictures: it contains those of the first, a middle and the last step. `go` goes there. */
int cli_find_range(const cli_steps *steps, rheo_player *player, cli_write_step *go, void *data,
                   const rheo_picture_options *options, double range[2]);
/* Goes to each of the steps and writes it. Shows the progress, and ends when it is interrupted. */
int cli_write_steps(const char *path, const cli_steps *steps, rheo_player *player, cli_write_step *write, void *data);

#endif
