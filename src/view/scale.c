/* Values of particles as colours: reading them, the colour scale, and its caption. */
#include <stdlib.h>
#include <string.h>

#include "core/text.h"
#include "view/output.h"
#include "view/picture.h"

/* ---- Values ---- */

static bool is_finite(double x)
{
    return x - x == 0;
}

/* Writes the name with blanks, or |name| of a vector. */
static void set_caption(rheo__painted *values, const char *name, const char *unit, bool is_vector)
{
    rheo__text_print(values->name, sizeof values->name, "%s%.60s%s", is_vector ? "|" : "", name,
                     is_vector ? "|" : "");
    rheo__text_print(values->unit, sizeof values->unit, "%.30s", strcmp(unit, "1") == 0 ? "" : unit);
    for (char *c = values->name; *c; c++)
        *c = *c == '_' ? ' ' : *c;
}

static rheo_real length_of(const double *vector, uint32_t components)
{
    double sum = 0;
    if (components == 1)
        return (rheo_real)*vector;
    for (uint32_t k = 0; k < components; k++)
        sum += vector[k] * vector[k];
    return (rheo_real)__builtin_sqrt(sum);
}

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

static rheo_result read_quantity(const rheo_world *world, const rheo_quantity *quantity, rheo_real *value,
                                 rheo_error *error)
{
    const uint32_t count = rheo_world_particle_count(world);
    rheo_particle_state *states = calloc((size_t)count + 1, sizeof *states);
    rheo_result result =
        states ? rheo_world_particles(world, states, error)
               : rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for the states of %u particles", count);
    for (uint32_t i = 0; result == RHEO_OK && i < count; i++)
        value[i] = length_of((const double *)(const void *)((const char *)&states[i] + quantity->offset),
                             quantity->components);
    free(states);
    return result;
}

static void set_from_field(const rheo_field_info *info, const void *from, rheo_real *value)
{
    for (size_t i = 0; i < info->items; i++)
        value[i] = info->element == RHEO_ELEMENT_F32   ? (rheo_real)((const float *)from)[i]
                   : info->element == RHEO_ELEMENT_F64 ? (rheo_real)((const double *)from)[i]
                   : info->element == RHEO_ELEMENT_U32 ? (rheo_real)((const uint32_t *)from)[i]
                                                       : (rheo_real)((const uint64_t *)from)[i];
}

static rheo_result read_field(const rheo_world *world, uint32_t index, const rheo_field_info *info, rheo_real *value,
                              rheo_error *error)
{
    void *bytes = malloc((size_t)info->bytes + 1);
    if (!bytes)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for the %s of %llu particles", info->name,
                          (unsigned long long)info->items);
    const rheo_result result = rheo_world_field_read(world, index, bytes, (size_t)info->bytes);
    if (result == RHEO_OK)
        set_from_field(info, bytes, value);
    free(bytes);
    return result;
}

/* The speed needs no sums over neighbours, so it is not read with the other quantities. */
static void read_speed(const rheo_world *world, rheo_real *value)
{
    const rheo_real *velocity = rheo_world_velocities(world);
    for (uint32_t i = 0; i < rheo_world_particle_count(world); i++, velocity += 3)
        value[i] = length_of((const double[3]){(double)velocity[0], (double)velocity[1], (double)velocity[2]}, 3);
}

static rheo_result refuse(const rheo_world *world, const char *name, rheo_error *error)
{
    const rheo_quantity *quantity;
    char all[400] = "none";
    for (uint32_t i = 0; (quantity = rheo_world_quantity(world, i)) != NULL; i++)
        rheo__text_add(all, sizeof all, ", %s", quantity->name);
    return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                      "particles of the %s model have no \"%.60s\" that could be painted; there are: %s",
                      rheo_model_name(rheo_world_definition(world)->model), name, all);
}

rheo_result rheo__painted_read(const rheo_world *world, const char *name, rheo__painted *values, rheo_error *error)
{
    uint32_t index;
    rheo_field_info info;
    *values = (rheo__painted){.value = NULL};
    if (!name)
        name = find_field(world, "temperature", &index, &info) ? "temperature" : "speed";
    if (strcmp(name, "none") == 0)
        return RHEO_OK;
    const rheo_quantity *quantity = find_quantity(world, name);
    const bool is_field = find_field(world, name, &index, &info);
    if (!quantity && !is_field)
        return refuse(world, name, error);
    const uint32_t count = rheo_world_particle_count(world);
    values->value = malloc(((size_t)count + 1) * sizeof *values->value);
    if (!values->value)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for the %s of %u particles", name, count);
    set_caption(values, name, quantity ? quantity->unit : "1", quantity && quantity->components > 1);
    rheo_result result = RHEO_OK;
    if (is_field)
        result = read_field(world, index, &info, values->value, error);
    else if (strcmp(name, "speed") == 0)
        read_speed(world, values->value);
    else
        result = read_quantity(world, quantity, values->value, error);
    if (result != RHEO_OK)
        rheo__painted_release(values);
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

rheo_result rheo_world_colour_range(const rheo_world *world, const char *colour, double range[2], rheo_error *error)
{
    rheo__painted values;
    RHEO__TRY(rheo__painted_read(world, colour, &values, error));
    const rheo_result result = rheo__painted_range(&values, rheo_world_particle_count(world), range, error);
    rheo__painted_release(&values);
    return result;
}

/* ---- The colour scale ---- */

/*
 * From dark violet over blue and green to yellow. The lightness grows evenly, so that the order of colours is seen by
 * people who confuse red and green, and in grey print.
 */
void rheo__scale_colour(double place, double colour[3])
{
    enum { STOPS = 7 };
    static const double stop[STOPS][3] = {{.31, .18, .53}, {.28, .33, .66}, {.19, .47, .69}, {.14, .60, .63},
                                          {.29, .72, .50}, {.61, .82, .32}, {.98, .91, .30}};
    double index = place * (STOPS - 1);
    index = index > 0 ? index < STOPS - 1 ? index : STOPS - 1 : 0;
    const int below = index < STOPS - 1 ? (int)index : STOPS - 2;
    for (int a = 0; a < 3; a++)
        colour[a] = stop[below][a] + (index - below) * (stop[below + 1][a] - stop[below][a]);
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
    enum { MOST_STEPS = RHEO__LABELS - 2 };
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
    const uint32_t labels = rheo__scale_labels(range, label);
    const double letters = letters_of(sheet), bottom = .84 * sheet->height, length = .62 * sheet->height;
    double room = 5.1 * letters;
    for (uint32_t i = 0; i < labels; i++) {
        const double needed = rheo__text_length(letters, label[i].text);
        room = needed > room ? needed : room;
    }
    const double left = sheet->width - room - 3.1 * letters, right = left + 1.5 * letters;
    for (uint32_t row = pixel_at(bottom - length, sheet->height); row < pixel_at(bottom, sheet->height); row++) {
        double colour[3];
        rheo__scale_colour((bottom - row - .5) / length, colour);
        for (uint32_t column = pixel_at(left, sheet->width); column < pixel_at(right, sheet->width); column++)
            for (int a = 0; a < 3; a++)
                sheet->rgb[3 * ((size_t)row * sheet->width + column) + (size_t)a] =
                    (unsigned char)(255 * colour[a] + .5);
    }
    for (uint32_t i = 0; i < labels; i++)
        rheo__sheet_text(sheet, right + .6 * letters, bottom - length * label[i].place + .5 * letters, letters,
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
