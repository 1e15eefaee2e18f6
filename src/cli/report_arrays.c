/*
 * Arrays of a page: the values of all particles in a frame, as float32 or as uint16 between two numbers. All encoded values are
 * computed by basic operations, so that they are the same on every machine.
 */
#include "cli/report.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { STEPS = 65534, NOT_FINITE = 65535, MOST_FAR = 64 };

/* Beyond it, differences overflow. */
static const double LARGEST = 1e300;

static bool is_known(double value)
{
    return fabs(value) <= LARGEST; /* not NaN */
}

/* ---- Range ---- */

static int compare(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/*
 * Chooses the range of a component: all values that are finite; or, where a few are so far away that the others would hardly
 * differ any more, all but those few.
 */
static void choose_range(double *sorted, size_t count, double *min, double *max)
{
    *min = *max = 0;
    if (count == 0)
        return;
    qsort(sorted, count, sizeof *sorted, compare);
    const size_t few = count / 256 + 4 < MOST_FAR ? count / 256 + 4 : MOST_FAR;
    const double all = sorted[count - 1] - sorted[0];
    *min = sorted[0];
    *max = sorted[count - 1];
    for (size_t low = 0; count > 2 * few && low <= few; low++) {
        const double least = sorted[low], most = sorted[count - 1 - (few - low)];
        if (16 * (most - least) < all && most - least < *max - *min) {
            *min = least;
            *max = most;
        }
    }
}

/* ---- Bytes ---- */

static uint64_t hash_of(const unsigned char *at, size_t size)
{
    uint64_t hash = UINT64_C(14695981039346656037);
    for (size_t i = 0; i < size; i++)
        hash = (hash ^ at[i]) * UINT64_C(1099511628211);
    return hash;
}

/* Takes bytes from malloc, or frees them if it has them already. */
static bool add_block(cli_page_blocks *blocks, unsigned char *at, size_t size, uint32_t *index)
{
    const uint64_t hash = hash_of(at, size);
    for (size_t i = 0; i < blocks->count; i++)
        if (blocks->block[i].hash == hash && blocks->block[i].size == size &&
            memcmp(blocks->block[i].at, at, size) == 0) {
            free(at);
            *index = (uint32_t)i;
            return true;
        }
    if (blocks->count == blocks->room) {
        const size_t room = 2 * blocks->room + 64;
        cli_page_block *block = realloc(blocks->block, room * sizeof *block);
        if (!block) {
            free(at);
            return false;
        }
        blocks->block = block;
        blocks->room = room;
    }
    *index = (uint32_t)blocks->count;
    blocks->block[blocks->count++] = (cli_page_block){.at = at, .size = size, .hash = hash};
    return true;
}

void cli_page_blocks_release(cli_page_blocks *blocks)
{
    for (size_t i = 0; i < blocks->count; i++)
        free(blocks->block[i].at);
    free(blocks->block);
}

static void put_float(unsigned char *to, double value)
{
    const float number = (float)value;
    uint32_t bits;
    memcpy(&bits, &number, sizeof bits);
    if (isnan(value))
        bits = UINT32_C(0x7fc00000); /* machines have different ones */
    for (int i = 0; i < 4; i++)
        to[i] = (unsigned char)(bits >> 8 * i);
}

static void put_uint16(unsigned char *to, double value, double min, double max)
{
    const double range = max - min;
    uint32_t number = NOT_FINITE;
    if (is_known(value))
        number = value >= max && range > 0    ? STEPS
                 : value <= min || range <= 0 ? 0
                                              : (uint32_t)((value - min) / range * STEPS + 0.5);
    to[0] = (unsigned char)number;
    to[1] = (unsigned char)(number >> 8);
}

/* ---- Encoding ---- */

/* Lists the particles outside of the range with their exact values. */
static bool list_far(const double *value, size_t count, size_t stride, uint32_t components, cli_page_array *array)
{
    for (int writes = 0; writes < 2; writes++) {
        uint32_t found = 0;
        for (size_t i = 0; i < count; i++) {
            const double *v = value + i * stride;
            bool far = false, known = true;
            for (uint32_t c = 0; c < components; c++) {
                far = far || v[c] < array->min[c] || v[c] > array->max[c];
                known = known && is_known(v[c]);
            }
            if (!far || !known)
                continue;
            if (writes) {
                array->far[found].particle = (uint32_t)i;
                memcpy(array->far[found].value, v, components * sizeof *v);
            }
            found++;
        }
        array->far_count = found;
        if (!writes && found && !(array->far = calloc(found, sizeof *array->far)))
            return false;
    }
    return true;
}

static bool choose_ranges(const double *value, size_t count, size_t stride, uint32_t components,
                          cli_page_array *array)
{
    double *sorted = malloc((count + 1) * sizeof *sorted);
    if (!sorted)
        return false;
    for (uint32_t c = 0; c < components; c++) {
        size_t finite = 0;
        for (size_t i = 0; i < count; i++)
            if (is_known(value[i * stride + c]))
                sorted[finite++] = value[i * stride + c] + 0.; /* no -0 */
        choose_range(sorted, finite, &array->min[c], &array->max[c]);
    }
    free(sorted);
    return true;
}

bool cli_page_encode(cli_page_blocks *blocks, const double *value, size_t count, size_t stride, uint32_t components,
                     bool exact, cli_page_array *array)
{
    const size_t size = count * components * (exact ? 4 : 2);
    *array = (cli_page_array){.known = true};
    if (!choose_ranges(value, count, stride, components, array))
        return false;
    if (!exact && !list_far(value, count, stride, components, array))
        return false;
    unsigned char *bytes = malloc(size + 1);
    for (size_t i = 0; bytes && i < count; i++)
        for (uint32_t c = 0; c < components; c++) {
            const size_t at = i * components + c;
            if (exact)
                put_float(bytes + 4 * at, value[i * stride + c]);
            else
                put_uint16(bytes + 2 * at, value[i * stride + c], array->min[c], array->max[c]);
        }
    return bytes && add_block(blocks, bytes, size, &array->block);
}

/* ---- Base64 ---- */

uint64_t cli_page_base64_size(uint64_t bytes)
{
    return (bytes + 2) / 3 * 4;
}

static void put_three(FILE *file, const unsigned char byte[3], unsigned count)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const uint32_t bits = (uint32_t)byte[0] << 16 | (uint32_t)byte[1] << 8 | byte[2];
    for (unsigned i = 0; i < 4; i++)
        fputc(i <= count ? digits[bits >> (18 - 6 * i) & 63] : '=', file);
}

void cli_page_put_base64(FILE *file, const cli_page_blocks *blocks)
{
    unsigned char three[3] = {0};
    unsigned count = 0;
    for (size_t b = 0; b < blocks->count; b++)
        for (size_t i = 0; blocks->block[b].used && i < blocks->block[b].size; i++) {
            three[count++] = blocks->block[b].at[i];
            if (count == 3) {
                put_three(file, three, count);
                count = 0;
            }
        }
    if (count) {
        memset(three + count, 0, 3 - count);
        put_three(file, three, count);
    }
}
