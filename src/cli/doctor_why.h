/* The chain of causes that ends a diagnosis. */
#ifndef CLI_DOCTOR_WHY_H
#define CLI_DOCTOR_WHY_H

#include "cli/why.h"

enum { CLI_DOCTOR_DEPTH = 6 };

typedef struct cli_doctor_chain {
    bool known;        /* the diagnosis names a particle, in a step that can be made again */
    uint64_t step, id; /* the step in which it shows, and the particle */
    const char *field; /* that which failed, else the position */
    bool told;         /* there are links */
    uint32_t count;
    rheo_link link[CLI_DOCTOR_DEPTH];
    rheo_chain chain;
} cli_doctor_chain;

/* Finds the particle of a diagnosis. */
void cli_doctor_chain_begin(const rheo_recording *recording, const rheo_diagnosis *diagnosis, cli_doctor_chain *c);
/* Follows it, unless that takes too long or this build does not make the recorded steps. */
void cli_doctor_chain_follow(rheo_recording *recording, cli_doctor_chain *c);
void cli_doctor_chain_text(const char *file, const cli_doctor_chain *c);
/* Writes `chain`, null or a list, and why it ends. */
void cli_doctor_chain_json(rheo__json *json, const cli_doctor_chain *c);

#endif
