/* Shared by the files of `rheolog report`: a page under construction. */
#ifndef CLI_REPORT_H
#define CLI_REPORT_H

#include "cli/doctor_why.h"

enum { CLI_PAGE_QUANTITIES = 40, CLI_PAGE_FOCUSES = 24, CLI_PAGE_PARTICLES = 24, CLI_PAGE_STAGE_ROWS = 200 };

/* ---- Text in memory ---- */

typedef struct cli_page_text {
    char *at; /* size bytes and a 0; NULL before cli_page_end() */
    size_t size;
    FILE *file;
} cli_page_text;

/* False: no memory. */
bool cli_page_begin(cli_page_text *text);
bool cli_page_end(cli_page_text *text);
/* Writes text for HTML, also in attributes. Bytes that are not UTF-8 become U+FFFD, and control characters become blanks. */
void cli_page_put(FILE *file, const char *text);
/* Writes a number with these digits, a point in every locale, and "NaN", "inf" or "-inf". */
void cli_page_put_number(FILE *file, double value, int digits);
/* Opens a link to a step, a stage ("": its end) and a particle (-1: none); close it with </a>. */
void cli_page_put_link(FILE *file, uint64_t step, const char *stage, int64_t particle);
/* Writes a command line with the name of a file: "rheolog metrics", the name, and what follows. */
void cli_page_put_command(FILE *file, const char *begin, const char *name, const char *end);

/* ---- Arrays ---- */

/* A particle whose value is too far from those of the others to be encoded with them. */
typedef struct cli_page_far {
    uint32_t particle;
    double value[3];
} cli_page_far;

/* The values of all particles in a frame. */
typedef struct cli_page_array {
    bool known;
    uint32_t block;
    double min[3], max[3];
    uint32_t far_count;
    cli_page_far *far;
} cli_page_array;

/* Encoded bytes; equal ones are kept once. */
typedef struct cli_page_block {
    unsigned char *at;
    size_t size, offset; /* offset: in the file, once it is known which frames it has */
    uint64_t hash;
    bool used;
} cli_page_block;

typedef struct cli_page_blocks {
    cli_page_block *block;
    size_t count, room;
} cli_page_blocks;

/*
 * Encodes `count` values, or vectors of `components`, at `value`, which are `stride` doubles apart: exactly as float32, or as
 * uint16. False: no memory.
 */
bool cli_page_encode(cli_page_blocks *blocks, const double *value, size_t count, size_t stride, uint32_t components,
                     bool exact, cli_page_array *array);
void cli_page_blocks_release(cli_page_blocks *blocks);
/* Bytes of a text of so many in base64. */
uint64_t cli_page_base64_size(uint64_t bytes);
void cli_page_put_base64(FILE *file, const cli_page_blocks *blocks);

/* ---- Quantities ---- */

typedef enum cli_page_source {
    CLI_PAGE_MEMBER, /* of rheo_particle_state */
    CLI_PAGE_LENGTH, /* of a vector in it */
    CLI_PAGE_NEIGHBOURS,
    CLI_PAGE_SPRINGS,
    CLI_PAGE_MATERIAL,
    CLI_PAGE_DIVERGENCE, /* distance of the positions in both recordings */
} cli_page_source;

typedef struct cli_page_quantity {
    char name[40];
    const char *unit, *meaning;
    cli_page_source source;
    size_t offset;   /* in rheo_particle_state */
    int rank;        /* 0: in each frame; 1: where there is room; 2: components of vectors */
    bool used;       /* a frame has it */
    double range[2]; /* of the colours */
    /* Samples of the values in the frames, from which the range is found. */
    double *sample;
    size_t samples, room;
} cli_page_quantity;

/* ---- Frames ---- */

typedef struct cli_page_frame {
    uint64_t step;
    char stage[48]; /* "": end of the step */
    uint32_t run;   /* of the stage in the step, from 0; UINT32_MAX: end of the step */
    uint32_t particles;
    double time;
    uint32_t priority; /* 0: is kept; the largest are left out first */
    bool left_out;
    cli_page_array position, value[CLI_PAGE_QUANTITIES];
    uint32_t body_count;
    rheo_body *body;
} cli_page_frame;

/* Exact values of a particle, as JSON from the key `values` on. */
typedef struct cli_page_detail {
    uint64_t step;
    uint32_t run, particle;
    uint64_t priority;
    bool left_out;
    char *json;
    size_t size;
} cli_page_detail;

typedef struct cli_page_mark {
    uint64_t step;
    const char *kind;
    char stage[48];
    int64_t particle;
    char text[400];
} cli_page_mark;

/* ---- Stages ---- */

/* The largest change of a value of particles by a stage run; particle -1: none. */
typedef struct cli_page_change {
    double size;
    int64_t particle;
    size_t particles; /* that changed */
} cli_page_change;

typedef struct cli_page_run {
    char stage[48];
    cli_page_change position, velocity;
} cli_page_run;

/* What the stage runs of a step changed. */
typedef struct cli_page_profile {
    uint64_t step;
    cli_page_run *run;
    size_t runs, room;
    rheo_real *position, *velocity; /* before the next run */
    size_t count;
} cli_page_profile;

/* Takes the state before the first run, then that after each. False: no memory. */
bool cli_page_profile_begin(cli_page_profile *profile, const rheo_world *world);
bool cli_page_profile_add(cli_page_profile *profile, const rheo_world *world, const char *stage);
void cli_page_profile_release(cli_page_profile *profile);

/* ---- The page ---- */

typedef struct cli_page_recording {
    const char *path, *name; /* as given, and without folders */
    rheo_recording *recording;
    rheo_recording_info info;
    rheo_player *player;
    rheo_diagnosis diagnosis;
    /* Metrics of all steps, step by step. */
    uint32_t metrics;
    double *metric;
    uint64_t steps; /* rows of metrics */
} cli_page_recording;

typedef struct cli_page {
    cli_page_recording f, g; /* g.path: NULL without a second recording */
    uint64_t max_bytes;
    rheo_verification difference; /* of both */
    cli_doctor_chain chain;

    /* What the page looks at. */
    uint64_t focus[CLI_PAGE_FOCUSES]; /* the first is the one whose stages are shown */
    uint32_t focuses;
    const char *begin_stage;               /* of the first; NULL or "": its end */
    const char *focus_reason;              /* why it is the first: "in which ..." */
    uint32_t particle[CLI_PAGE_PARTICLES]; /* named by the story, in its order */
    uint32_t particles;
    cli_page_mark *mark;
    size_t marks, mark_room;

    cli_page_profile profile;

    /* How it is encoded. */
    bool exact;
    int ranks;     /* quantities up to this rank are in frames near a focus */
    int far_ranks; /* in other frames */
    uint32_t quantities;
    cli_page_quantity quantity[CLI_PAGE_QUANTITIES];

    /* What it holds. */
    cli_page_blocks blocks;
    cli_page_frame *frame;
    size_t frames, frame_room;
    cli_page_detail *detail;
    size_t details, detail_room;
    char (*stage)[48]; /* names of the stage runs */
    size_t stages;
    rheo_extent extent;
    uint64_t divergence_unknown; /* first step whose divergence this build cannot make again; UINT64_MAX: none */

    /* Parts of the page, in HTML. */
    cli_page_text summary, budget, story, divergence, metrics_part, stages_part, commands, meta, data;
    uint64_t bytes; /* of the file */
} cli_page;

/* Functions that return int return an exit code, after a message if it is not CLI_DONE. */
int cli_page_no_memory(void);

/* ---- report_focus.c: what to look at ---- */

/* Opens the recording at r->path, and reads all that is stored of it but states. */
int cli_page_read(cli_page_recording *r);
void cli_page_recording_release(cli_page_recording *r);
/* A metric of a step; NaN if the recording does not have it. */
double cli_page_metric(const cli_page_recording *r, uint64_t step, const char *name);
/* Chooses the steps and particles that the page looks at, and its marks. */
int cli_page_find_focus(cli_page *page);

/* ---- report_frames.c: which states ---- */

/* Chooses how states are encoded, and takes those within steps. fixed_bytes: of the file, beside its states. */
int cli_page_take_stages(cli_page *page, uint64_t fixed_bytes);
/* Takes those at the ends of steps. fixed_bytes: now with the part that cli_page_write_stages() wrote. */
int cli_page_take_steps(cli_page *page, uint64_t fixed_bytes);

/* ---- report_frame.c: one state ---- */

void cli_page_quantities_of(cli_page *page, const rheo_world *world);
/* Adds a frame with the quantities up to a rank. other: NULL, or the world of the second recording. */
int cli_page_add_frame(cli_page *page, const rheo_world *world, const rheo_world *other, uint64_t step,
                       const char *stage, uint32_t run, int ranks, uint32_t priority);
void cli_page_find_ranges(cli_page *page);

/* ---- report_details.c: exact values of particles in a state ---- */

/* Of the particles that the page looks at, or of all. */
int cli_page_add_details(cli_page *page, const rheo_world *world, uint64_t step, uint32_t run, uint64_t priority,
                         bool all);
/* Bytes of the details of a particle, about. */
uint64_t cli_page_detail_size(const rheo_world *world);

/* ---- The parts of the page, each in a file of its own ---- */

int cli_page_write_story(cli_page *page); /* and the summary */
int cli_page_write_divergence(cli_page *page);
int cli_page_write_metrics(cli_page *page);
int cli_page_write_stages(cli_page *page);
int cli_page_write_commands(cli_page *page);
/* Written again whenever a frame is left out. */
int cli_page_write_meta(cli_page *page);
int cli_page_write_budget(cli_page *page);

/* What the page holds. */
typedef struct cli_page_counts {
    size_t steps, stages, details; /* states at ends of steps and within steps; particles in states */
} cli_page_counts;

void cli_page_count(const cli_page *page, cli_page_counts *counts);

/* ---- report_page.c ---- */

/* Bytes of the page without its parts. */
uint64_t cli_page_template_size(void);
/* For cli_write_file(). */
void cli_page_write(FILE *file, const void *page);

#endif
