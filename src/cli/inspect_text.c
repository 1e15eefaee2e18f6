/* Prints the values of `rheolog inspect` as text. */
#include "cli/inspect.h"

#include <math.h>
#include <string.h>

#include "json/file_name.h"

enum { FEW_ROWS = 8 }; /* largest number of rows in the text of a particle's history */

/* Converts a name to words: "rest length" for rest_length. */
static const char *label_of(const char *name, char label[64])
{
    snprintf(label, 64, "%s", name);
    for (char *c = label; *c; c++)
        if (*c == '_')
            *c = ' ';
    return label;
}

/* Prints a line of a list: name, value with unit ("1": no unit), meaning. */
static void text_value(const char *name, const double *value, uint32_t components, const char *unit,
                       const char *meaning)
{
    char label[64], text[96] = "";
    for (uint32_t i = 0; i < components; i++)
        snprintf(text + strlen(text), sizeof text - strlen(text), "%s%.6g", i ? ", " : "", value[i]);
    if (strcmp(unit, "1") != 0)
        snprintf(text + strlen(text), sizeof text - strlen(text), " %s", unit);
    printf("%-15s %-38s %s\n", label_of(name, label), text, meaning);
}

static void text_vector(const char *label, const double value[3], const char *unit)
{
    printf("%-14s%.6g, %.6g, %.6g %s\n", label, value[0], value[1], value[2], unit);
}

void cli_inspect_text_ball(const cli_view *v)
{
    rheo_body body;
    for (uint32_t i = 0; rheo_world_body(v->world, i, &body) == RHEO_OK; i++) {
        char name[16];
        if (v->ball && v->ball != i + 1)
            continue;
        snprintf(name, sizeof name, i ? "ball %u" : "ball", (unsigned)(i + 1) % 1000);
        text_vector(name, body.position, "L");
        text_vector("  velocity", body.velocity, "L/T");
        text_vector("  spin", body.spin, "1/T");
    }
}

const char *const cli_plate_name[] = {[RHEO_PLATE_LOWER] = "lower", [RHEO_PLATE_UPPER] = "upper"};

static void text_emitters(const cli_view *v)
{
    rheo_emitter_state e;
    for (uint32_t k = 0; rheo_world_emitter(v->world, k, &e); k++)
        printf("emitter %s   %llu particles emitted, %llu without room left out\n",
               rheo_world_definition(v->world)->emitters.list[k].name, (unsigned long long)e.emitted,
               (unsigned long long)e.blocked);
}

static void text_plates(const cli_view *v)
{
    rheo_plate plate;
    for (uint32_t i = 0; rheo_world_plate(v->world, i, &plate); i++) {
        printf("%s plate   %u particles\n", cli_plate_name[i], plate.particles);
        if (i == RHEO_PLATE_UPPER) {
            text_vector("  displaced", plate.displacement, "L");
            text_vector("  velocity", plate.velocity, "L/T");
        }
        if (plate.force[0] == plate.force[0]) /* known */
            text_vector("  force", plate.force, "M L/T^2");
    }
}

/* ---- Metrics ---- */

/* Ids of the particle or spring that has the value of a metric; -1: none. */
static void ids_of(const cli_view *v, const char *name, double id[2])
{
    static const char *const OTHERS[][3] = {
        {"stiffness_number", "stiffness_a", "stiffness_b"},
        {"max_density_error", "max_density_id", ""},
    };
    char own[64];
    snprintf(own, sizeof own, "%s_id", name);
    id[0] = cli_view_metric(v, own);
    id[1] = NAN;
    for (size_t i = 0; i < sizeof OTHERS / sizeof *OTHERS; i++)
        if (strcmp(OTHERS[i][0], name) == 0) {
            id[0] = cli_view_metric(v, OTHERS[i][1]);
            id[1] = cli_view_metric(v, OTHERS[i][2]);
        }
}

/* Ids are printed with their metrics, balls have their own lines, and the time is in the heading. */
static bool is_listed(const char *name)
{
    return !rheo__json_ends_with(name, "_id") && !rheo__json_ends_with(name, "_a") &&
           !rheo__json_ends_with(name, "_b") && strncmp(name, "ball", 4) != 0 && strcmp(name, "step") != 0 &&
           strcmp(name, "time") != 0;
}

void cli_inspect_text_metric(const cli_view *v, const rheo_metric_info *info)
{
    const double value = cli_view_metric(v, info->name);
    double id[2];
    ids_of(v, info->name, id);
    const bool unit = strcmp(info->unit, "1") != 0;
    printf("  %-26s%-*.6g", info->name, unit || id[0] >= 0 ? 12 : 0, value);
    if (unit)
        printf(" %s%s", info->unit, id[0] >= 0 ? "," : "");
    if (id[0] >= 0 && id[1] >= 0)
        printf(" spring %.0f:%.0f", id[0], id[1]);
    else if (id[0] >= 0)
        printf(" particle %.0f", id[0]);
    putchar('\n');
}

static void text_metrics(const cli_view *v)
{
    const rheo_metric_info *info;
    printf("\nmetrics of step %llu\n", (unsigned long long)v->complete);
    for (uint32_t i = 0; (info = rheo_world_metric_info(v->world, i)) != NULL; i++)
        if (!isnan(cli_view_metric(v, info->name)) && is_listed(info->name))
            cli_inspect_text_metric(v, info);
}

static void text_rankings(const cli_view *v)
{
    for (uint32_t i = 0; i < v->rankings; i++) {
        const cli_ranking *r = &v->ranking[i];
        const bool unit = strcmp(r->ranking->unit, "1") != 0;
        printf("\n%s: %s%s%s (%s)\n", r->ranking->name, r->ranking->value, unit ? ", " : "",
               unit ? r->ranking->unit : "", r->ranking->meaning);
        for (size_t n = 0; n < r->count; n++) {
            char name[32];
            snprintf(name, sizeof name, r->ranking->top == RHEO_TOP_STIFFEST ? "%u:%u" : "%u",
                     (unsigned)r->entry[n].id, (unsigned)r->entry[n].other_id);
            printf("  %-18s%.6g\n", name, r->entry[n].value);
        }
        if (r->count == 0)
            puts("  none");
    }
}

/* ---- Particle and spring ---- */

static void text_history(const cli_view *v, const cli_lag *row, uint32_t shown, const char *what)
{
    printf("\nhistory: %u row%s", (unsigned)v->rows, cli_plural(v->rows));
    if (shown < v->rows)
        printf(", the newest %u", (unsigned)shown);
    putchar('\n');
    if (v->rows == 0)
        return;
    printf("  %5s %8s %11s %11s   %s\n", "lag", "step", "time", "weight", what);
    for (uint32_t m = 0; m < shown; m++)
        printf("  %5u %8llu %11.6g %11.6g   %13.6g %13.6g %13.6g\n", (unsigned)m, (unsigned long long)row[m].step,
               row[m].time, row[m].weight, row[m].value[0], row[m].value[1], row[m].value[2]);
}

/* Prints the modes: D^q = C0 (newest velocity + sum over the modes of weight x sum). */
static void text_modes(const cli_view *v, const rheo_mode_state *mode, const char *what)
{
    if (v->modes == 0)
        return;
    const unsigned lag = rheo_world_history_lag(v->world);
    if (lag)
        printf("\nmodes: %u, decaying sums over the velocities beyond lag %u\n", (unsigned)v->modes, lag);
    else
        printf("\nmodes: %u, decaying sums over all but the newest velocity\n", (unsigned)v->modes);
    printf("  %11s %11s   sum of the %s\n", "decay", "weight", what);
    for (uint32_t k = 0; k < v->modes; k++)
        printf("  %11.6g %11.6g   %13.6g %13.6g %13.6g\n", mode[k].decay, mode[k].weight, mode[k].sum[0],
               mode[k].sum[1], mode[k].sum[2]);
}

static void text_neighbours(const cli_view *v)
{
    const char *weight = rheo_world_weight_name(v->world);
    printf("\nneighbours: %zu\n", v->neighbours);
    if (v->neighbours)
        printf("  %8s %12s %12s\n", "id", "distance", weight ? weight : "weight");
    for (size_t i = 0; i < v->neighbours; i++)
        printf("  %8u %12.6g %12.6g\n", (unsigned)v->neighbour[i], v->distance[i],
               rheo_world_weight(v->world, v->distance[i]));
}

static void text_springs(const cli_view *v)
{
    char label[64];
    printf("\nsprings: %zu\n", v->springs);
    if (v->springs) {
        printf("  %8s", "to");
        for (int k = 0; k < CLI_SPRING_VALUES; k++)
            printf(" %12s", label_of(CLI_SPRING_QUANTITIES[k].name, label));
        putchar('\n');
    }
    for (size_t i = 0; i < v->springs; i++) {
        printf("  %8u", (unsigned)v->spring_of_particle[i].partner);
        for (int k = 0; k < CLI_SPRING_VALUES; k++)
            printf(" %12.6g", v->spring_of_particle[i].value[k]);
        putchar('\n');
    }
}

static void text_particle(const cli_view *v)
{
    const rheo_quantity *q;
    const rheo_world_def *def = rheo_world_definition(v->world);
    printf("\nparticle %llu\n", (unsigned long long)v->particle);
    if (def->materials.count)
        printf("%-15s %u, %s\n", "material", v->state.material, rheo_world_def_material_name(def, v->state.material));
    for (uint32_t i = 0; (q = rheo_world_quantity(v->world, i)) != NULL; i++)
        text_value(q->name, cli_quantity_value(v, q), q->components, q->unit, q->meaning);
    text_neighbours(v);
    if (!v->model_has_springs)
        return;
    text_springs(v);
    text_history(v, v->velocity, v->rows < FEW_ROWS ? v->rows : FEW_ROWS, "velocity, L/T");
    text_modes(v, v->particle_mode, "velocity, L/T");
}

static void text_spring(const cli_view *v)
{
    char what[64];
    printf("\nspring %u:%u\n", (unsigned)v->ends[0], (unsigned)v->ends[1]);
    for (int i = 0; i < CLI_SPRING_VALUES; i++)
        text_value(CLI_SPRING_QUANTITIES[i].name, &v->spring[i], 1, CLI_SPRING_QUANTITIES[i].unit,
                   CLI_SPRING_QUANTITIES[i].meaning);
    snprintf(what, sizeof what, "velocity of %u - that of %u, L/T", (unsigned)v->ends[0], (unsigned)v->ends[1]);
    text_history(v, v->difference, v->rows, what);
    text_modes(v, v->spring_mode, what);
}

void cli_inspect_text_things(const cli_view *v)
{
    if (v->has_rankings)
        text_rankings(v);
    if (v->has_particle)
        text_particle(v);
    if (v->has_spring)
        text_spring(v);
}

void cli_inspect_text(const cli_view *v)
{
    printf("%s\n", v->file);
    printf("%-14s%s\n", "scene", v->info.scene[0] ? v->info.scene : "without a name");
    printf("%-14s%llu", "step", (unsigned long long)v->step);
    if (v->done)
        printf(", after stage %s, %u of its %u stage%s", v->done, (unsigned)v->runs, (unsigned)v->all,
               cli_plural(v->all));
    printf("\n%-14s%.6g T%s\n", "time", rheo_world_time(v->world), v->done ? " at the beginning of the step" : "");
    printf("%-14s%016llx\n", "hash", (unsigned long long)rheo_world_hash(v->world));
    printf("%-14s%u\n", "particles", (unsigned)rheo_world_particle_count(v->world));
    if (v->model_has_springs)
        printf("%-14s%zu\n", "springs", rheo_world_spring_count(v->world));
    cli_inspect_text_ball(v);
    text_plates(v);
    text_emitters(v);
    text_metrics(v);
    cli_inspect_text_things(v);
}
