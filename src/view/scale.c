/* Values of particles as colours: reading them, the colour scale, and its caption. */
#include <stdlib.h>
#include <string.h>

#include "core/text.h"
#include "view/output.h"
#include "view/picture.h"
#include "view/vectors.h"

/* ---- Values ---- */

static bool is_finite(double x)
{
    return x - x == 0;
}

/* Numbers of particles as they are read: some components each. */
typedef struct numbers {
    const char *unit;
    uint32_t count, components;
    double *number;
} numbers;

static const rheo_quantity *find_quantity(const rheo_world *world, const char *name)
{
    const rheo_quantity *quantity;
    for (uint32_t i = 0; (quantity = rheo_world_quantity(world, i)) != NULL; i++)
        if (strcmp(quantity->name, name) == 0)
            return quantity;
    return NULL;
}

/* A field with one number for each particle. */
static bool find_field(const rheo_world *world, const char *name, uint32_t *index, rheo_field_info *info)
{
    for (*index = 0; rheo_world_field(world, *index, info) == RHEO_OK; ++*index)
        if (strcmp(info->name, name) == 0 && info->location == RHEO_LOCATION_PARTICLE && !info->ring &&
            info->rows == 1 && info->components == 1)
            return true;
    return false;
}

static rheo_result read_quantity(const rheo_world *world, const rheo_quantity *quantity, numbers *n,
                                 rheo_error *error)
{
    rheo_particle_state *states = calloc((size_t)n->count + 1, sizeof *states);
    rheo_result result =
        states ? rheo_world_particles(world, states, error)
               : rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for the states of %u particles", n->count);
    const size_t bytes = n->components * sizeof(double);
    for (size_t i = 0; result == RHEO_OK && i < n->count; i++)
        memcpy(n->number + i * n->components, (const char *)&states[i] + quantity->offset, bytes);
    free(states);
    return result;
}

static rheo_result read_field(const rheo_world *world, uint32_t index, const rheo_field_info *info, numbers *n,
                              rheo_error *error)
{
    void *from = malloc((size_t)info->bytes + 1);
    if (!from)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for the %s of %u particles", info->name, n->count);
    const rheo_result result = rheo_world_field_read(world, index, from, (size_t)info->bytes);
    for (size_t i = 0; result == RHEO_OK && i < n->count; i++)
        n->number[i] = info->element == RHEO_ELEMENT_F32   ? (double)((const float *)from)[i]
                       : info->element == RHEO_ELEMENT_F64 ? ((const double *)from)[i]
                       : info->element == RHEO_ELEMENT_U32 ? (double)((const uint32_t *)from)[i]
                                                           : (double)((const uint64_t *)from)[i];
    free(from);
    return result;
}

/* Positions, velocities and speeds need no sums over neighbours, so they are not read with the other quantities. */
static bool read_motion(const rheo_world *world, const char *name, numbers *n)
{
    const bool is_position = strcmp(name, "position") == 0, is_speed = strcmp(name, "speed") == 0;
    if (!is_position && !is_speed && strcmp(name, "velocity") != 0)
        return false;
    const rheo_real *from = is_position ? rheo_world_positions(world) : rheo_world_velocities(world);
    for (size_t i = 0; i < n->count; i++, from += 3) {
        const double vector[3] = {(double)from[0], (double)from[1], (double)from[2]};
        if (is_speed)
            n->number[i] = rheo__view_length(vector);
        else
            memcpy(n->number + 3 * i, vector, sizeof vector);
    }
    return true;
}

static rheo_result refuse(const rheo_world *world, const char *name, rheo_error *error)
{
    const rheo_quantity *quantity;
    char all[400] = "none";
    for (uint32_t i = 0; (quantity = rheo_world_quantity(world, i)) != NULL; i++)
        rheo__text_add(all, sizeof all, ", %s", quantity->name);
    if (rheo_world_definition(world)->materials.count)
        rheo__text_add(all, sizeof all, ", material");
    return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                      "particles of the %s model have no \"%.60s\" that could be painted; there are: %s",
                      rheo_model_name(rheo_world_definition(world)->model), name, all);
}

static rheo_result read_numbers(const rheo_world *world, const char *name, numbers *n, rheo_error *error)
{
    uint32_t index;
    rheo_field_info info;
    const rheo_quantity *quantity = find_quantity(world, name);
    const bool is_field = find_field(world, name, &index, &info);
    if (!quantity && !is_field)
        return refuse(world, name, error);
    *n = (numbers){.unit = quantity ? quantity->unit : "1",
                   .count = rheo_world_particle_count(world),
                   .components = quantity ? quantity->components : 1};
    n->number = malloc(((size_t)n->count + 1) * n->components * sizeof *n->number);
    if (!n->number)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for the %s of %u particles", name, n->count);
    rheo_result result = RHEO_OK;
    if (is_field)
        result = read_field(world, index, &info, n, error);
    else if (!read_motion(world, name, n))
        result = read_quantity(world, quantity, n, error);
    if (result != RHEO_OK)
        free(n->number);
    return result;
}

/* Subtracts the numbers of another world. */
static rheo_result subtract(numbers *n, const rheo_world *other, const char *name, rheo_error *error)
{
    numbers its;
    RHEO__TRY(read_numbers(other, name, &its, error));
    rheo_result result = RHEO_OK;
    if (its.count != n->count || its.components != n->components)
        result =
            rheo__fail(error, RHEO_ERROR_ARGUMENT,
                       "worlds that are compared need the same particles; they have %u and %u", n->count, its.count);
    for (size_t i = 0; result == RHEO_OK && i < (size_t)n->count * n->components; i++)
        n->number[i] -= its.number[i];
    free(its.number);
    return result;
}

/* Writes the name with blanks, as |name| if it is a length. */
static void set_caption(rheo__painted *values, const char *name, const numbers *n, bool is_difference)
{
    const bool is_length = n->components > 1 || is_difference;
    rheo__text_print(values->name, sizeof values->name, "%s%s%.50s%s", is_length ? "|" : "",
                     is_difference ? "difference of " : "", name, is_length ? "|" : "");
    rheo__text_print(values->unit, sizeof values->unit, "%.30s", strcmp(n->unit, "1") == 0 ? "" : n->unit);
    for (char *c = values->name; *c; c++)
        *c = *c == '_' ? ' ' : *c;
}

static rheo_result set_values(rheo__painted *values, const numbers *n, bool is_difference, rheo_error *error)
{
    values->value = malloc(((size_t)n->count + 1) * sizeof *values->value);
    if (!values->value)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for the colours of %u particles", n->count);
    for (size_t i = 0; i < n->count; i++) {
        const double *number = n->number + i * n->components;
        double value = *number;
        if (n->components == 3)
            value = rheo__view_length(number);
        else if (is_difference)
            value = value < 0 ? -value : value;
        values->value[i] = (rheo_real)value;
    }
    return RHEO_OK;
}

rheo_result rheo__painted_read(const rheo_world *world, const rheo_picture_options *options, rheo__painted *values,
                               rheo_error *error)
{
    uint32_t index;
    rheo_field_info info;
    numbers n;
    const char *name = options->colour;
    *values = (rheo__painted){.value = NULL};
    if (!name)
        name = options->other                                    ? "position"
               : find_field(world, "temperature", &index, &info) ? "temperature"
                                                                 : "speed";
    if (strcmp(name, "none") == 0)
        return RHEO_OK;
    RHEO__TRY(read_numbers(world, name, &n, error));
    rheo_result result = options->other ? subtract(&n, options->other, name, error) : RHEO_OK;
    if (strcmp(name, "material") == 0 && !options->other)
        values->materials = rheo_world_definition(world);
    if (result == RHEO_OK) {
        set_caption(values, name, &n, options->other != NULL);
        result = set_values(values, &n, options->other != NULL, error);
    }
    free(n.number);
    return result;
}

void rheo__painted_release(rheo__painted *values)
{
    free(values->value);
    values->value = NULL;
}

static int by_size(const void *a, const void *b)
{
    const rheo_real x = *(const rheo_real *)a, y = *(const rheo_real *)b;
    return (x > y) - (x < y);
}

/* The values without the smallest and the largest hundredth; if these are the only ones that differ, all values. */
rheo_result rheo__painted_range(const rheo__painted *values, uint32_t count, double range[2], rheo_error *error)
{
    rheo_real *sorted = malloc(((size_t)count + 1) * sizeof *sorted);
    size_t finite = 0;
    range[0] = 0;
    range[1] = 1;
    if (values->materials) { /* all of them, so that each keeps its colour */
        range[1] = values->materials->materials.count;
        free(sorted);
        return RHEO_OK;
    }
    if (!sorted)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for the range of %u values", count);
    for (uint32_t i = 0; values->value && i < count; i++)
        if (is_finite((double)values->value[i]))
            sorted[finite++] = values->value[i];
    if (finite) {
        qsort(sorted, finite, sizeof *sorted, by_size);
        size_t cut = finite / 100;
        cut = sorted[cut] < sorted[finite - 1 - cut] ? cut : 0;
        range[0] = (double)sorted[cut];
        range[1] = (double)sorted[finite - 1 - cut];
    }
    free(sorted);
    return RHEO_OK;
}

rheo_result rheo_world_colour_range(const rheo_world *world, const rheo_picture_options *options, double range[2],
                                    rheo_error *error)
{
    rheo__painted values;
    RHEO__TRY(rheo__painted_read(world, options, &values, error));
    const rheo_result result = rheo__painted_range(&values, rheo_world_particle_count(world), range, error);
    rheo__painted_release(&values);
    return result;
}

/* ---- The colour scale ---- */

/* The colour at a place between 0 and 1 of a scale with so many stops. */
static void between_stops(const double (*stop)[3], int stops, double place, double colour[3])
{
    double index = place * (stops - 1);
    index = index > 0 ? index < stops - 1 ? index : stops - 1 : 0;
    const int below = index < stops - 1 ? (int)index : stops - 2;
    for (int a = 0; a < 3; a++)
        colour[a] = stop[below][a] + (index - below) * (stop[below + 1][a] - stop[below][a]);
}

/*
 * From dark violet over blue and green to yellow. The lightness grows evenly, so that the order of colours is seen by
 * people who confuse red and green, and in grey print.
 */
void rheo__scale_colour(double place, double colour[3])
{
    enum { STOPS = 7 };
    static const double stop[STOPS][3] = {{.31, .18, .53}, {.28, .33, .66}, {.19, .47, .69}, {.14, .60, .63},
                                          {.29, .72, .50}, {.61, .82, .32}, {.98, .91, .30}};
    between_stops(stop, STOPS, place, colour);
}

/* From blue over a pale middle to red, so that both sides of a front differ. */
static void heat_colour(double place, double colour[3])
{
    enum { STOPS = 5 };
    static const double stop[STOPS][3] = {
        {.12, .25, .66}, {.35, .65, .85}, {.93, .88, .75}, {.95, .55, .25}, {.75, .10, .10}};
    between_stops(stop, STOPS, place, colour);
}

void rheo__colour_of(const rheo__colours *colours, double value, double rgb[3])
{
    const double width = colours->range[1] - colours->range[0];
    if (colours->is_heat)
        heat_colour(width > 0 ? (value - colours->range[0]) / width : 0, rgb);
    else
        rheo__scale_colour(width > 0 ? (value - colours->range[0]) / width : .5, rgb);
}

/* ---- Captions ---- */

/* The smallest of 1, 2 and 5 times a power of ten that is not below a width. */
static double round_step(double width)
{
    static const int FACTORS[] = {1, 2, 5};
    double unit = 1;
    while (unit * 10 <= width)
        unit *= 10;
    while (unit > width)
        unit /= 10;
    for (int i = 0; i < 3; i++)
        if (FACTORS[i] * unit >= width)
            return FACTORS[i] * unit;
    return 10 * unit;
}

/* Writes the labels with the fewest digits, at least 3, that show that they differ. */
static void write_labels(const double *value, uint32_t count, rheo__label *label)
{
    bool differ = false;
    for (int digits = 3; digits <= 12 && !differ; digits++) {
        differ = true;
        for (uint32_t i = 0; i < count; i++) {
            rheo__text_brief(value[i], digits, false, label[i].text);
            differ = differ && (i == 0 || strcmp(label[i].text, label[i - 1].text) != 0);
        }
    }
}

uint32_t rheo__scale_labels(const double range[2], rheo__label label[RHEO__LABELS])
{
    enum { MOST_STEPS = 8 };
    const double width = range[1] - range[0], least = 1e-15 * (range[1] > -range[0] ? range[1] : -range[0]);
    double value[RHEO__LABELS] = {range[0]};
    uint32_t count = 0;
    if (!(width > 1e-250) || width < MOST_STEPS * least) { /* as good as one value */
        label[0].place = .5;
        write_labels(value, 1, label);
        return 1;
    }
    const double step = round_step(width / MOST_STEPS), margin = 1e-6 * step;
    for (int64_t k = (int64_t)(range[0] / step) - 1; count < RHEO__LABELS && (double)k * step <= range[1] + margin;
         k++)
        if ((double)k * step >= range[0] - margin) {
            value[count] = (double)k * step;
            label[count].place = (value[count] - range[0]) / width;
            count++;
        }
    write_labels(value, count, label);
    return count;
}

uint32_t rheo__material_labels(const rheo_world_def *def, const double range[2], rheo__label label[RHEO__LABELS])
{
    const double width = range[1] - range[0];
    uint32_t count = 0;
    for (uint32_t number = 0; number <= def->materials.count && count < RHEO__LABELS; number++)
        if (number >= range[0] && number <= range[1]) {
            label[count].place = width > 0 ? (number - range[0]) / width : .5;
            rheo__text_print(label[count].text, sizeof label->text, "%.31s",
                             rheo_world_def_material_name(def, number));
            count++;
        }
    return count;
}

static uint32_t pixel_at(double place, uint32_t end)
{
    return place > 0 ? place < end ? (uint32_t)place : end : 0;
}

static double letters_of(const rheo__sheet *sheet)
{
    const double height = sheet->height / 48.;
    return height > 6 ? height : 6;
}

void rheo__sheet_scale(const rheo__sheet *sheet, const rheo__painted *values, const double range[2])
{
    rheo__label label[RHEO__LABELS];
    char title[100];
    const uint32_t labels =
        values->materials ? rheo__material_labels(values->materials, range, label) : rheo__scale_labels(range, label);
    const double letters = letters_of(sheet), bottom = .84 * sheet->height, length = .62 * sheet->height;
    const uint32_t parts = values->materials ? labels : 0; /* of the bar, one for each material */
    double room = 5.1 * letters;
    for (uint32_t i = 0; i < labels; i++) {
        const double needed = rheo__text_length(letters, label[i].text);
        room = needed > room ? needed : room;
    }
    const double left = sheet->width - room - 3.1 * letters, right = left + 1.5 * letters;
    for (uint32_t row = pixel_at(bottom - length, sheet->height); row < pixel_at(bottom, sheet->height); row++) {
        double colour[3], place = (bottom - row - .5) / length;
        if (parts)
            place = label[pixel_at(place * parts, parts - 1)].place;
        rheo__scale_colour(place, colour);
        for (uint32_t column = pixel_at(left, sheet->width); column < pixel_at(right, sheet->width); column++)
            for (int a = 0; a < 3; a++)
                sheet->rgb[3 * ((size_t)row * sheet->width + column) + (size_t)a] =
                    (unsigned char)(255 * colour[a] + .5);
    }
    for (uint32_t i = 0; i < labels; i++)
        rheo__sheet_text(sheet, right + .6 * letters,
                         bottom - length * (parts ? (i + .5) / parts : label[i].place) + .5 * letters, letters,
                         label[i].text);
    rheo__text_print(title, sizeof title, "%s%s%s", values->name, *values->unit ? ", " : "", values->unit);
    const double end = sheet->width - letters, begin = end - rheo__text_length(letters, title);
    rheo__sheet_text(sheet, begin < left ? begin : left, bottom - length - 1.8 * letters, letters, title);
}

void rheo__sheet_time(const rheo__sheet *sheet, const rheo_world *world)
{
    char text[100], time[32];
    const double letters = letters_of(sheet);
    rheo__text_brief(rheo_world_time(world), 4, false, time);
    rheo__text_print(text, sizeof text, "step %llu, t = %s", (unsigned long long)rheo_world_step_count(world), time);
    rheo__sheet_text(sheet, 1.5 * letters, sheet->height - 1.5 * letters, letters, text);
}
