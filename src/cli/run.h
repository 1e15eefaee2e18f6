/* Shared by the files of `rheolog run`. */
#ifndef CLI_RUN_H
#define CLI_RUN_H

#include "cli/cli.h"

/* A run: its initial state, and its results so far. */
typedef struct cli_run_state {
    rheo_recording *recording; /* recording of --from, or NULL */
    rheo_world *world;
    rheo_recorder *recorder; /* recorder of -o, or NULL */
    char name[128];
    uint64_t wanted, done;       /* number of steps of this run */
    uint64_t recorded;           /* number of steps that the file had before, with --continue */
    double creation, seconds;    /* wall time of the creation and of the loop, s */
    double updates;              /* particles x steps */
    double substep_updates;      /* particles x substeps */
    double substeps, iterations; /* sums over all steps; 0 if the model has none */
    char *made_by, *scene_text;  /* to store in the recording */
    rheo_health *health;
    bool unhealthy;             /* since the step of `finding` */
    rheo_finding finding;       /* the first severe measure out of range */
    double bytes;               /* of the file */
    uint64_t max_bytes;         /* its limit; 0: none */
    uint64_t spacing, left_out; /* steps between its keyframes, and keyframes that the limit has left out */
    bool begins_again;          /* --continue with a file that has no whole keyframe */
    bool reported;              /* the JSON object is printed */
    const char *outcome;
    rheo_error reason; /* why the run ended early; "" if it did not */
    const cli_list *set;
    cli_progress progress;
} cli_run_state;

/* ---- Scenes (run_scene.c) ---- */

bool cli_is_builtin(const char *name);
/* Whether SCENE is the name of a file, not of a built-in scene. */
bool cli_is_scene_file(const char *name);
/* Finds a built-in scene, or reads a scene file. Returns an exit code, after a message. */
int cli_find_scene(const cli_command *command, const char *name, rheo_scene *scene);
/* Applies every --set. */
int cli_change_scene(const cli_command *command, rheo_scene *scene, const cli_list *set);
/* Prints why a scene is refused. Names its file unless --set has changed the scene. Returns the exit code. */
int cli_scene_error(const char *name, bool changed, rheo_result result, const rheo_error *error);
/*
 * Estimates whether the scene and these steps fit into the memory of this machine (machine_memory.c). If not, says what
 * to lower and returns an exit code.
 */
int cli_check_memory(const char *name, const rheo_scene *scene, uint64_t steps);
/* Checks the scene and prints it as JSON. */
int cli_write_scene(const char *name, bool changed, const rheo_scene *scene);

/* ---- How a recording was made (made_by.c) ---- */

/* What `rheolog run` was asked for, as far as it changes the recording. */
typedef struct cli_run_request {
    const char *scene, *from; /* one of them is NULL */
    const cli_list *set;
    uint64_t keyframes; /* 0: not given */
    uint64_t max_bytes; /* 0: not given */
    bool full;
} cli_run_request;

/* The command line, and the scene as JSON. Release the texts with free(). NULL: no memory. `name` is SCENE. */
char *cli_made_by(const cli_run_request *request);
char *cli_scene_text(const rheo_scene *scene, const char *name);

/* ---- Health (run_health.c) ---- */

/* Begins to examine the steps. Warns if the first state is ill. `output` is the file that is continued, if one is. */
int cli_run_watch(cli_run_state *run, const char *output);
/* Examines the last step. False: the run is unhealthy. */
bool cli_run_examine(cli_run_state *run);
/* Writes "unhealthy since step 7 (speed_jump is 3.6, more than 1, particle 17)". */
void cli_run_unhealthy(const cli_run_state *run, char *text, size_t size);

/* ---- Results (run_report.c) ---- */

void cli_run_json(const cli_run_state *run, const char *output);
/* Prints why a run made no steps, which was said last. `scene`: SCENE, or NULL. */
void cli_run_refused_json(const char *scene, const char *output, int status);
void cli_run_text(const cli_run_state *run, const char *output);

#endif
