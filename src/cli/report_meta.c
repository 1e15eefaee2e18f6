/* What the scripts of a page read: report-meta as JSON. */
#define _POSIX_C_SOURCE 200809L /* open_memstream() */
#include "cli/report.h"

#include <stdlib.h>
#include <string.h>

enum { VERSION = 1 };

/* ---- Which frames there are ---- */

static void use_array(cli_page *page, const cli_page_array *array)
{
    if (array->known)
        page->blocks.block[array->block].used = true;
}

/* Gives each array that a frame uses its place in the data. */
static void place_blocks(cli_page *page)
{
    size_t offset = 0;
    for (size_t i = 0; i < page->blocks.count; i++)
        page->blocks.block[i].used = false;
    for (size_t i = 0; i < page->frames; i++) {
        if (page->frame[i].left_out)
            continue;
        use_array(page, &page->frame[i].position);
        for (uint32_t q = 0; q < page->quantities; q++)
            use_array(page, &page->frame[i].value[q]);
    }
    for (size_t i = 0; i < page->blocks.count; i++) {
        page->blocks.block[i].offset = offset;
        offset += page->blocks.block[i].used ? page->blocks.block[i].size : 0;
    }
}

static int add_stage(cli_page *page, const char *name)
{
    for (size_t i = 0; i < page->stages; i++)
        if (strcmp(page->stage[i], name) == 0)
            return CLI_DONE;
    char(*stage)[48] = realloc(page->stage, (page->stages + 1) * sizeof *stage);
    if (!stage)
        return cli_page_no_memory();
    page->stage = stage;
    snprintf(stage[page->stages++], sizeof *stage, "%s", name);
    return CLI_DONE;
}

/* The frames of the step with most runs come first; others add what it lacks. */
static int find_stages(cli_page *page)
{
    uint64_t longest = UINT64_MAX;
    uint32_t runs = 0;
    page->stages = 0;
    for (size_t i = 0; i < page->frames; i++)
        if (!page->frame[i].left_out && page->frame[i].stage[0] && page->frame[i].run >= runs) {
            runs = page->frame[i].run;
            longest = page->frame[i].step;
        }
    int status = CLI_DONE;
    for (int pass = 0; pass < 2; pass++)
        for (size_t i = 0; i < page->frames && status == CLI_DONE; i++)
            if (!page->frame[i].left_out && page->frame[i].stage[0] && (pass || page->frame[i].step == longest))
                status = add_stage(page, page->frame[i].stage);
    return status;
}

/* Whether any frame has values of it. */
static bool is_used(const cli_page *page, uint32_t quantity)
{
    for (size_t i = 0; i < page->frames; i++)
        if (!page->frame[i].left_out && page->frame[i].value[quantity].known)
            return true;
    return false;
}

static void find_used(cli_page *page)
{
    for (uint32_t q = 0; q < page->quantities; q++)
        page->quantity[q].used = is_used(page, q);
}

/* ---- JSON ---- */

/* A number with this many digits, as JSON. */
static void write_brief(rheo__json *json, const char *key, double value, int digits)
{
    char text[32];
    const char *end;
    rheo__json_number(json, key,
                      value - value == 0 ? rheo_text_number(rheo_number_brief(value, digits, text), &end) : value);
}

static void write_far(rheo__json *json, const cli_page_array *array, uint32_t components)
{
    if (array->far_count == 0)
        return;
    rheo__json_begin_list(json, "far");
    for (uint32_t i = 0; i < array->far_count; i++) {
        double row[4] = {array->far[i].particle};
        memcpy(row + 1, array->far[i].value, components * sizeof *row);
        rheo__json_vector(json, NULL, row, components + 1);
    }
    rheo__json_end_list(json);
}

static void write_array(rheo__json *json, const cli_page *page, const char *key, const cli_page_array *array,
                        bool position)
{
    if (!array->known) {
        rheo__json_null(json, key);
        return;
    }
    rheo__json_begin_object(json, key);
    rheo__json_integer(json, "offset", page->blocks.block[array->block].offset);
    if (position) {
        const double box[6] = {array->min[0], array->min[1], array->min[2],
                               array->max[0], array->max[1], array->max[2]};
        rheo__json_vector(json, "box", box, 6);
    } else {
        rheo__json_number(json, "min", array->min[0]);
        rheo__json_number(json, "max", array->max[0]);
    }
    write_far(json, array, position ? 3 : 1);
    rheo__json_end_object(json);
}

static void write_frame(rheo__json *json, const cli_page *page, const cli_page_frame *f)
{
    rheo__json_begin_object(json, NULL);
    rheo__json_integer(json, "step", f->step);
    rheo__json_text(json, "stage", f->stage[0] ? f->stage : NULL);
    rheo__json_number(json, "time", f->time);
    rheo__json_integer(json, "particles", f->particles);
    rheo__json_null(json, "ids");
    write_array(json, page, "position", &f->position, true);
    rheo__json_begin_list(json, "values");
    for (uint32_t q = 0; q < page->quantities; q++)
        if (page->quantity[q].used)
            write_array(json, page, NULL, &f->value[q], false);
    rheo__json_end_list(json);
    rheo__json_begin_list(json, "balls");
    for (uint32_t i = 0; i < f->body_count; i++) {
        const rheo_body *b = &f->body[i];
        rheo__json_begin_object(json, NULL);
        rheo__json_vector(json, "position", b->position, 3);
        rheo__json_vector(json, "rotation", b->orientation, 4);
        rheo__json_number(json, "radius", b->radius);
        rheo__json_end_object(json);
    }
    rheo__json_end_list(json);
    rheo__json_begin_list(json, "obstacles");
    rheo__json_end_list(json);
    rheo__json_end_object(json);
}

/* "max_speed" as "max speed" */
static void write_label(rheo__json *json, const char *name)
{
    char label[48];
    snprintf(label, sizeof label, "%s", name);
    for (char *c = label; *c; c++)
        *c = *c == '_' ? ' ' : *c;
    rheo__json_text(json, "label", label);
}

static void write_quantities(rheo__json *json, const cli_page *page)
{
    rheo__json_begin_list(json, "quantities");
    for (uint32_t i = 0; i < page->quantities; i++) {
        const cli_page_quantity *q = &page->quantity[i];
        if (!q->used)
            continue;
        rheo__json_begin_object(json, NULL);
        rheo__json_text(json, "name", q->name);
        write_label(json, q->name);
        rheo__json_text(json, "unit", q->unit);
        write_brief(json, "min", q->range[0], 6);
        write_brief(json, "max", q->range[1], 6);
        rheo__json_text(json, "meaning", q->meaning);
        rheo__json_bool(json, "count", q->source >= CLI_PAGE_NEIGHBOURS && q->source <= CLI_PAGE_MATERIAL);
        rheo__json_end_object(json);
    }
    rheo__json_end_list(json);
}

static void write_scene(rheo__json *json, const cli_page *page)
{
    const rheo_world *world = rheo_player_world(page->f.player);
    const rheo_world_def *def = rheo_world_definition(world);
    const rheo_extent *e = &page->extent;
    const double box[6] = {e->min[0], e->min[1], e->min[2], e->max[0], e->max[1], e->max[2]};
    rheo_vibrator vibrator;
    rheo__json_number(json, "dt", rheo_recording_definition(page->f.recording)->step);
    rheo__json_begin_object(json, "units");
    rheo__json_text(json, "length", "L");
    rheo__json_text(json, "time", "T");
    rheo__json_text(json, "mass", "M");
    rheo__json_text(json, "temperature", "K");
    rheo__json_end_object(json);
    rheo__json_number(json, "spacing", def->fluid.spacing);
    rheo__json_number(json, "radius", def->fluid.spacing / 2);
    rheo__json_vector(json, "box", box, 6);
    rheo__json_integer(json, "steps", page->f.info.last_step);
    rheo__json_bool(json, "exact", page->exact);
    write_quantities(json, page);
    rheo__json_begin_list(json, "materials");
    for (uint32_t i = 0; def->materials.count && i <= def->materials.count; i++)
        rheo__json_text(json, NULL, rheo_world_def_material_name(def, i));
    rheo__json_end_list(json);
    rheo__json_begin_list(json, "stages");
    for (size_t i = 0; i < page->stages; i++)
        rheo__json_text(json, NULL, page->stage[i]);
    rheo__json_end_list(json);
    rheo__json_begin_list(json, "walls");
    for (uint32_t i = 0; i < def->walls.count; i++) {
        rheo__json_begin_object(json, NULL);
        rheo__json_vector(json, "point", def->walls.plane[i].point, 3);
        rheo__json_vector(json, "normal", def->walls.plane[i].normal, 3);
        rheo__json_end_object(json);
    }
    rheo__json_end_list(json);
    rheo__json_begin_list(json, "vibrators");
    for (uint32_t i = 0; rheo_world_vibrator(world, i, &vibrator) == RHEO_OK; i++)
        rheo__json_vector(json, NULL, (const double[]){vibrator.x, vibrator.z}, 2);
    rheo__json_end_list(json);
}

/* What the page looks at first. */
static void write_begin(rheo__json *json, const cli_page *page)
{
    rheo__json_begin_object(json, "begin");
    rheo__json_integer(json, "step", page->focus[0]);
    rheo__json_text(json, "stage", page->begin_stage && *page->begin_stage ? page->begin_stage : NULL);
    rheo__json_index(json, "particle", page->particles ? (int64_t)page->particle[0] : -1);
    rheo__json_end_object(json);
}

static void write_marks(rheo__json *json, const cli_page *page)
{
    rheo__json_begin_list(json, "marks");
    for (size_t i = 0; i < page->marks; i++) {
        const cli_page_mark *m = &page->mark[i];
        rheo__json_begin_object(json, NULL);
        rheo__json_integer(json, "step", m->step);
        rheo__json_text(json, "stage", m->stage[0] ? m->stage : NULL);
        rheo__json_index(json, "particle", m->particle);
        rheo__json_text(json, "kind", m->kind);
        rheo__json_text(json, "text", m->text);
        rheo__json_end_object(json);
    }
    rheo__json_end_list(json);
}

static void write_details(FILE *file, const cli_page *page)
{
    bool follows = false;
    fputs(", \"details\": [", file);
    size_t index = 0;
    for (size_t i = 0; i < page->frames; i++) {
        if (page->frame[i].left_out)
            continue;
        for (size_t k = 0; k < page->details; k++) {
            const cli_page_detail *d = &page->detail[k];
            if (d->left_out || d->step != page->frame[i].step || d->run != page->frame[i].run)
                continue;
            fprintf(file, "%s{\"frame\": %zu, \"particle\": %u, ", follows ? ",\n" : "", index,
                    (unsigned)d->particle);
            fwrite(d->json + 1, 1, d->size - 2, file); /* without the brace and the line break */
            follows = true;
        }
        index++;
    }
    fputs("]", file);
}

/* In a script, the text must not have "<". JSON has it in strings only. */
static bool without_angles(const cli_page_text *from, cli_page_text *to)
{
    if (!cli_page_begin(to))
        return false;
    for (size_t i = 0; i < from->size; i++)
        if (from->at[i] == '<')
            fputs("\\u003c", to->file);
        else
            fputc(from->at[i], to->file);
    return cli_page_end(to);
}

int cli_page_write_meta(cli_page *page)
{
    cli_page_text text = {0};
    place_blocks(page);
    find_used(page);
    int status = find_stages(page);
    if (status != CLI_DONE)
        return status;
    free(page->meta.at);
    page->meta = (cli_page_text){0};
    if (!cli_page_begin(&text))
        return cli_page_no_memory();
    rheo__json json = {.file = text.file, .lines = 0};
    rheo__json_begin_object(&json, NULL);
    rheo__json_integer(&json, "version", VERSION);
    rheo__json_text(&json, "name", page->f.name);
    rheo__json_text(&json, "other", page->g.path ? page->g.name : NULL);
    rheo__json_text(&json, "model", rheo_model_name(rheo_recording_definition(page->f.recording)->model));
    write_scene(&json, page);
    write_begin(&json, page);
    rheo__json_begin_list(&json, "frames");
    for (size_t i = 0; i < page->frames; i++)
        if (!page->frame[i].left_out)
            write_frame(&json, page, &page->frame[i]);
    rheo__json_end_list(&json);
    write_marks(&json, page);
    write_details(text.file, page);
    rheo__json_end_object(&json);
    const bool good = cli_page_end(&text) && without_angles(&text, &page->meta);
    free(text.at);
    return good ? CLI_DONE : cli_page_no_memory();
}
