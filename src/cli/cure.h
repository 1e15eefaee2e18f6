/* Command lines that try a cure of the doctor. */
#ifndef CLI_CURE_H
#define CLI_CURE_H

#include "cli/cli.h"

enum { CLI_COMMAND_LINE = 8192 };

typedef struct cli_doctor_case {
    const char *file;
    rheo_recording *recording;
    const rheo_diagnosis *diagnosis;
} cli_doctor_case;

/* Steps that a cure is run on for. */
enum { CLI_CURE_STEPS = 100 };

/* Makes the recorded scene; release it. False: it is not stored, or this build cannot read it. */
bool cli_recorded_scene(const rheo_recording *recording, rheo_scene *scene);

/* False: the scene cannot be made again with this advice, which is therefore none. */
bool cli_cure_possible(const cli_doctor_case *c, const rheo_advice *advice);

/*
 * Writes the shell command that tries a cure: it continues the recording, or makes the scene again. False: there is
 * none, because the scene must be changed by hand or is not stored in the recording.
 */
bool cli_cure(const cli_doctor_case *c, const rheo_advice *advice, char *text, size_t size);

#endif
