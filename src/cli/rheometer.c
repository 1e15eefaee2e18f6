/*
 * rheolog rheometer: says what fluid a scene has. A block of it is sheared between plates, or one spring of it is driven, and the
 * curves that rheologists plot are measured. rheometer_NAME.c are the instruments, rheometer_analysis.c what is made of signals,
 * rheometry.c the closed forms.
 */
#include "cli/rheometer.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli/run.h"
#include "cli/steps.h"
#include "json/file_name.h"

enum { MOST_SEEDS = 99 };
static const double MOST_VALUE = 1e9; /* of a list */

typedef struct arguments {
    bool pair, small, fit, json;
    const char *rates, *amplitudes, *omegas, *stresses, *folder;
    cli_number seeds;
    cli_list set;
} arguments;

/* ---- Arguments ---- */

/* Adds a value in rising order, unless it is there: protocols go through their values upwards. */
static void add_value(cli_values *values, double value)
{
    size_t at = values->count;
    while (at > 0 && values->value[at - 1] > value)
        at--;
    if (at > 0 && values->value[at - 1] == value)
        return;
    memmove(values->value + at + 1, values->value + at, (values->count++ - at) * sizeof *values->value);
    values->value[at] = value;
}

/* Reads numbers above 0 with commas between them, in any order. */
static int read_values(const char *option, const char *text, cli_values *values)
{
    while (text) {
        const char *end;
        const double value = rheo_text_number(text, &end);
        if (end == text || (*end && *end != ',') || !(value > 0 && value <= MOST_VALUE))
            return cli_usage(&cli_rheometer, "%s needs numbers above 0 and at most 1e9, such as 0.1,1,10; got \"%s\"",
                             option, text);
        if (values->count == CLI_RHEOMETER_VALUES)
            return cli_usage(&cli_rheometer, "%s takes at most %d values", option, CLI_RHEOMETER_VALUES);
        add_value(values, value);
        text = *end ? end + 1 : NULL;
    }
    return CLI_DONE;
}

static int read_all_values(const arguments *a, cli_measurement *r)
{
    int status = read_values("--rate", a->rates, &r->rates);
    if (status == CLI_DONE)
        status = read_values("--gamma", a->amplitudes, &r->amplitudes);
    if (status == CLI_DONE)
        status = read_values("--omega", a->omegas, &r->omegas);
    return status == CLI_DONE ? read_values("--stress", a->stresses, &r->stresses) : status;
}

/* Reads the parameters of a scene or of a recording, which must stay open while they are used. */
static int read_scene(const char *name, const cli_list *set, cli_measurement *r, rheo_recording **recording)
{
    int status = CLI_DONE;
    r->scene_name = name;
    if (rheo__json_ends_with(name, ".rlog")) {
        status = cli_check_recording(name);
        if (status == CLI_DONE)
            status = cli_open_recording(name, recording);
        if (status != CLI_DONE)
            return status;
        const rheo_world_def *def = rheo_recording_definition(*recording);
        r->scene = rheo_default_model_scene(def->model);
        r->scene.world = *def;
    } else if ((status = cli_find_scene(&cli_rheometer, name, &r->scene)) != CLI_DONE) {
        return status;
    }
    return cli_change_scene(&cli_rheometer, &r->scene, set);
}

static const cli_instrument *instrument_of(const arguments *a, const cli_measurement *r)
{
    if (r->scene.world.model == RHEO_MODEL_MELTING)
        return &cli_law_instrument;
    return a->pair ? &cli_pair_instrument : &cli_block_instrument;
}

static int check_protocols(const cli_instrument *instrument, int count, char **names)
{
    const char *known[CLI_RHEOMETER_TABLES];
    char all[160] = "", suggestion[CLI_SUGGESTION];
    size_t protocols = 0;
    for (const cli_protocol *p = instrument->protocol; p->name; p++) {
        known[protocols++] = p->name;
        snprintf(all + strlen(all), sizeof all - strlen(all), "%s%s", *all ? ", " : "", p->name);
    }
    for (int k = 0; k < count; k++) {
        size_t i = 0;
        while (i < protocols && strcmp(names[k], known[i]) != 0)
            i++;
        if (i == protocols)
            return cli_usage(&cli_rheometer, "the %s has no protocol \"%s\"%s it has %s", instrument->name, names[k],
                             *cli_did_you_mean(names[k], rheo_nearest_word(names[k], known, protocols), suggestion)
                                 ? suggestion
                                 : ";",
                             all);
    }
    return CLI_DONE;
}

static int check_arguments(const arguments *a, const cli_measurement *r)
{
    if (a->seeds.value < 1 || a->seeds.value > MOST_SEEDS)
        return cli_usage(&cli_rheometer, "--seeds is 1 to %d; got %llu", MOST_SEEDS,
                         (unsigned long long)a->seeds.value);
    if (a->pair && r->scene.world.model == RHEO_MODEL_MELTING)
        return cli_usage(&cli_rheometer, "--pair drives a spring; the melting model has none");
    return CLI_DONE;
}

static bool wanted(const cli_protocol *protocol, int count, char **names)
{
    for (int i = 0; i < count; i++)
        if (strcmp(names[i], protocol->name) == 0)
            return true;
    return count == 0;
}

/* Refuses options that no protocol takes. */
static int check_effects(const arguments *a, const cli_instrument *instrument, int count, char **names)
{
    const struct {
        bool given;
        const char *name;
    } given[] = {{a->rates, "--rate"},      {a->amplitudes, "--gamma"}, {a->omegas, "--omega"},
                 {a->stresses, "--stress"}, {a->fit, "--fit"},          {a->seeds.value > 1, "--seeds"}};
    for (size_t i = 0; i < sizeof given / sizeof *given; i++)
        if (given[i].given) {
            bool used = false;
            char users[160] = "";
            for (const cli_protocol *p = instrument->protocol; p->name; p++)
                if (strstr(p->takes, given[i].name)) {
                    used = used || wanted(p, count, names);
                    snprintf(users + strlen(users), sizeof users - strlen(users), "%s%s", *users ? ", " : "",
                             p->name);
                }
            if (!*users)
                return cli_usage(&cli_rheometer, "%s has no effect on the %s", given[i].name, instrument->name);
            if (!used)
                return cli_usage(&cli_rheometer, "%s has no effect on %s; name a protocol that uses it: %s",
                                 given[i].name, count > 1 ? "these protocols" : names[0], users);
        }
    return CLI_DONE;
}

int cli_check_slowest(const cli_measurement *r, const char *option, const cli_values *values, double time)
{
    if (!values->count) /* they are in rising order */
        return CLI_DONE;
    const double step = r->scene.world.step, steps = time / (values->value[0] * step);
    char got[32], needs[32], least[32];
    if (steps <= CLI_RHEOMETER_STEPS)
        return CLI_DONE;
    return cli_fail(
        CLI_BAD, "%s %s takes up to %s steps, and at most %d are allowed; with this step it must be at least %s 1/T",
        option, rheo_number_brief(values->value[0], 4, got), rheo_number_brief(steps, 3, needs), CLI_RHEOMETER_STEPS,
        rheo_number_brief(1.005 * time / (CLI_RHEOMETER_STEPS * step), 3, least)); /* rounded up */
}

/* ---- Measuring ---- */

int cli_rheometer_go_on(const cli_measurement *r, const char *protocol)
{
    return cli_interrupted() ? cli_fail(CLI_INTERRUPTED, "interrupted in %s of %s", protocol, r->scene_name)
                             : CLI_DONE;
}

static int measure_seed(cli_measurement *r, const cli_instrument *instrument, int count, char **names)
{
    int status = CLI_DONE;
    for (const cli_protocol *p = instrument->protocol; p->name && status == CLI_DONE; p++)
        if (wanted(p, count, names)) {
            const uint32_t finished = r->tables;
            status = cli_interrupted()
                         ? cli_fail(CLI_INTERRUPTED, "interrupted before %s of %s", p->name, r->scene_name)
                         : p->run(r);
            while (status != CLI_DONE && r->tables > finished) /* half a table is none */
                cli_table_release(&r->table[--r->tables]);
        }
    for (uint32_t i = 0; i < r->tables && status != CLI_SYSTEM; i++)
        if (r->table[i].failed)
            status = cli_fail(CLI_SYSTEM, "no memory for the rows of %s", r->table[i].name);
    return status;
}

static void release_tables(cli_measurement *r)
{
    for (uint32_t i = 0; i < r->tables; i++)
        cli_table_release(&r->table[i]);
    r->tables = 0;
}

/*
 * An interrupt, or a state that goes bad, leaves the tables that are finished. The first seeds have them, since each seed goes
 * through the same protocols.
 */
static int measure(cli_measurement *r, const cli_instrument *instrument, int count, char **names)
{
    cli_measurement *all = calloc(r->seeds, sizeof *all);
    uint64_t seeds[MOST_SEEDS];
    cli_protocol_table *tables[MOST_SEEDS];
    int status = all ? CLI_DONE : cli_fail(CLI_SYSTEM, "no memory for the results of %u seeds", (unsigned)r->seeds);
    for (uint32_t k = 0; k < r->seeds && status == CLI_DONE; k++) {
        all[k] = *r;
        all[k].scene.seed = seeds[k] = r->scene.seed + k;
        status = measure_seed(&all[k], instrument, count, names);
    }
    for (uint32_t i = 0; all && status != CLI_SYSTEM && i < all[0].tables; i++) {
        uint32_t finished = 0;
        for (; finished < r->seeds && i < all[finished].tables; finished++)
            tables[finished] = &all[finished].table[i];
        if (r->seeds > 1)
            cli_table_join(tables, seeds, finished);
        if (finished < r->seeds)
            cli_table_note(tables[0], "Not complete: %u of %u seeds are finished.", (unsigned)finished,
                           (unsigned)r->seeds);
        if (tables[0]->failed)
            status = cli_fail(CLI_SYSTEM, "no memory for the rows of %s", tables[0]->name);
        r->table[r->tables++] = *tables[0];
        tables[0]->value = NULL; /* it is in r now */
    }
    for (uint32_t k = 0; k < r->seeds && all; k++)
        release_tables(&all[k]);
    free(all);
    return status;
}

/* Makes the folder, and refuses one in which the files cannot be written. Without names, all protocols are measured. */
static int check_files(cli_measurement *r, const cli_instrument *instrument, const char *folder, int count,
                       char **names)
{
    int status = cli_make_folder(folder);
    r->prefix = instrument->prefix;
    for (const cli_protocol *p = instrument->protocol; p->name && status == CLI_DONE; p++) {
        bool wanted = count == 0;
        for (int k = 0; k < count; k++)
            wanted = wanted || strcmp(names[k], p->name) == 0;
        if (wanted)
            status = cli_rheometer_check_files(r, p->name, folder);
    }
    return status;
}

static int run_all(const arguments *a, cli_measurement *r, int argc, char **argv)
{
    const cli_instrument *instrument = instrument_of(a, r);
    int status = check_arguments(a, r);
    if (status == CLI_DONE)
        status = check_protocols(instrument, argc - 1, argv + 1);
    if (status == CLI_DONE)
        status = check_effects(a, instrument, argc - 1, argv + 1);
    if (status == CLI_DONE)
        status = instrument->check(r);
    if (status == CLI_DONE && a->folder)
        status = check_files(r, instrument, a->folder, argc - 1, argv + 1);
    if (status != CLI_DONE) {
        if (a->json)
            cli_rheometer_json(r, instrument, status);
        return status;
    }
    cli_watch_signals();
    cli_progress progress = cli_progress_begin(cli_now());
    r->progress = &progress;
    r->seeds = (uint32_t)a->seeds.value;
    status = measure(r, instrument, argc - 1, argv + 1);
    cli_progress_end(&progress);
    if (status != CLI_DONE && status != CLI_INTERRUPTED && !r->tables && !a->json)
        return status;
    const int written = a->folder ? cli_rheometer_write(r, a->folder) : CLI_DONE;
    if (written != CLI_DONE)
        return written;
    if (status != CLI_SYSTEM)
        instrument->sum_up(r);
    (a->json ? cli_rheometer_json : cli_rheometer_print)(r, instrument, status);
    return status;
}

static int run(int argc, char **argv)
{
    arguments a = {.seeds = {false, 1}};
    const cli_option options[] = {
        {"--pair", NULL, NULL, CLI_FLAG, &a.pair},
        {"--small", NULL, NULL, CLI_FLAG, &a.small},
        {"--fit", NULL, NULL, CLI_FLAG, &a.fit},
        {"--rate", NULL, "R,R,...", CLI_TEXT, &a.rates},
        {"--gamma", NULL, "G,G,...", CLI_TEXT, &a.amplitudes},
        {"--omega", NULL, "W,W,...", CLI_TEXT, &a.omegas},
        {"--stress", NULL, "S,S,...", CLI_TEXT, &a.stresses},
        {"--seeds", NULL, "N", CLI_NUMBER, &a.seeds},
        {"--set", NULL, "KEY=VALUE", CLI_LIST, &a.set},
        {"--output", "-o", "FOLDER", CLI_TEXT, &a.folder},
        {"--json", NULL, NULL, CLI_FLAG, &a.json},
        {0},
    };
    int status = cli_parse(&cli_rheometer, options, &argc, argv);
    if (status != CLI_GO_ON)
        return status;
    if (argc < 1)
        return cli_usage(&cli_rheometer, "needs a scene or a recording");
    cli_measurement *r = calloc(1, sizeof *r);
    rheo_recording *recording = NULL;
    if (!r)
        return cli_fail(CLI_SYSTEM, "no memory for the rheometer");
    r->small = a.small;
    r->fit = a.fit;
    status = read_all_values(&a, r);
    if (status == CLI_DONE)
        status = read_scene(argv[0], &a.set, r, &recording);
    if (status == CLI_DONE)
        status = run_all(&a, r, argc, argv);
    release_tables(r);
    rheo_scene_release(&r->scene);
    rheo_recording_close(recording);
    free(r);
    return status;
}

static const char help[] = {
#include "cli/help/rheometer.txt.inc"
    0};

const cli_command cli_rheometer = {"rheometer", help, run};
