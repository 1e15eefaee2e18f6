/* Reads the pages of `rheolog report`: their description, and their arrays. */
#ifndef RHEO__TESTS_REPORT_SUPPORT_H
#define RHEO__TESTS_REPORT_SUPPORT_H

#include <math.h>

#include "cli_support.h"

static char *page;           /* text of the file */
static char *description;    /* of it: report-meta */
static const char *meta;     /* the same */
static unsigned char *bytes; /* report-data */
static size_t size;

/* Value of a digit of base64; -1: it is none. */
static inline int digit_of(char c)
{
    return c >= 'A' && c <= 'Z'   ? c - 'A'
           : c >= 'a' && c <= 'z' ? c - 'a' + 26
           : c >= '0' && c <= '9' ? c - '0' + 52
           : c == '+'             ? 62
           : c == '/'             ? 63
                                  : -1;
}

/* Reads the text and the data of a page. */
static inline void read_page(const char *path)
{
    static const char meta_begins[] = "<script type=\"application/json\" id=\"report-meta\">\n",
                      data_begins[] = "<script type=\"text/plain\" id=\"report-data\">";
    free(page);
    free(description);
    free(bytes);
    const size_t length = (size_t)file_size(path);
    page = malloc(length + 1);
    read_file(path, page, length + 1);
    meta = strstr(page, meta_begins);
    assert_non_null(meta);
    meta += strlen(meta_begins);
    const char *data = strstr(meta, data_begins);
    assert_non_null(data);
    const size_t described = (size_t)(data - page);
    bytes = malloc(length);
    size = 0;
    unsigned bits = 0, have = 0;
    for (data += strlen(data_begins); digit_of(*data) >= 0; data++) {
        bits = bits << 6 | (unsigned)digit_of(*data);
        have += 6;
        if (have >= 8) {
            have -= 8;
            bytes[size++] = (unsigned char)(bits >> have);
        }
    }
    data += strspn(data, "=");
    assert_memory_equal(data, "</script>", 9);
    /* With sanitizers each search reads its text to the end, and the data are megabytes. */
    meta = description = strndup(meta, described - (size_t)(meta - page));
}

static inline bool is_exact(void)
{
    return strstr(meta, "\"exact\": true") != NULL;
}

/* The frame of a step and a stage, "null" for the end of the step. NULL: there is none. */
static const char *frame_of(unsigned step, const char *stage)
{
    char begin[96];
    snprintf(begin, sizeof begin, "{\"step\": %u, \"stage\": %s, \"time\":", step, stage);
    const char *frames = strstr(meta, "\"frames\": [");
    assert_non_null(frames);
    return strstr(frames, begin);
}

/* Number of a quantity; -1: there is none. */
static inline int quantity_of(const char *name)
{
    char key[64];
    snprintf(key, sizeof key, "{\"name\": \"%s\"", name);
    const char *end = strstr(meta, "\"materials\": ["), *at = strstr(meta, "\"quantities\": ["),
               *found = strstr(at, key);
    int index = 0;
    if (!found || found > end)
        return -1;
    for (at = strstr(at, "{\"name\""); at < found; at = strstr(at + 1, "{\"name\""))
        index++;
    return index;
}

/* An array of a frame. */
typedef struct array {
    size_t offset;
    double min[3], max[3];
    const char *far; /* list of those out of the range; NULL: none */
} array;

static inline array array_at(const char *at, int components)
{
    array a = {0};
    a.offset = (size_t)number_after(&at, "offset");
    if (components == 3) {
        at = strstr(at, "\"box\": [") + strlen("\"box\": [");
        for (int i = 0; i < 6; i++) {
            (i < 3 ? a.min : a.max - 3)[i] = number_at(&at);
            at += strspn(at, ", ");
        }
        at++;
    } else {
        a.min[0] = number_after(&at, "min");
        a.max[0] = number_after(&at, "max");
    }
    at += strspn(at, ", ");
    if (strncmp(at, "\"far\": [", 8) == 0)
        a.far = at + 8;
    return a;
}

static inline array positions_of(const char *frame)
{
    assert_non_null(frame);
    return array_at(strstr(frame, "\"position\": {"), 3);
}

/* False: the frame does not know it. */
static inline bool values_of(const char *frame, const char *name, array *a)
{
    const int quantity = quantity_of(name);
    assert_non_null(frame);
    assert_true(quantity >= 0);
    const char *at = strstr(frame, "\"values\": [") + strlen("\"values\": [");
    for (int i = 0; i < quantity; i++) {
        if (*at == '{') {
            for (int depth = 0;; at++) {
                depth += (*at == '{') - (*at == '}');
                if (depth == 0)
                    break;
            }
        } else {
            assert_memory_equal(at, "null", 4);
        }
        at += strcspn(at, ",") + 2;
    }
    if (*at != '{')
        return false;
    *a = array_at(at, 1);
    return true;
}

/* A value, and by how much it may differ from the one that was encoded. */
static inline double value_in(const array *a, size_t index, int components, int component, double *tolerance)
{
    const size_t number = index * (size_t)components + (size_t)component;
    *tolerance = 0;
    if (is_exact()) {
        uint32_t bits = 0;
        float value;
        assert_true(a->offset + 4 * number + 4 <= size);
        for (int i = 3; i >= 0; i--)
            bits = bits << 8 | bytes[a->offset + 4 * number + (size_t)i];
        memcpy(&value, &bits, sizeof value);
        return (double)value;
    }
    for (const char *far = a->far; far && *far == '[';) { /* [index, value, ...], ... */
        const char *at = far + 1;
        const bool own = number_at(&at) == (double)index;
        for (int c = 0; c <= component && own; c++) {
            at += 2;
            const double value = number_at(&at);
            if (c == component)
                return value;
        }
        far += strcspn(far, "]") + 1;
        far += strspn(far, ", \n");
    }
    assert_true(a->offset + 2 * number + 2 <= size);
    const unsigned u = bytes[a->offset + 2 * number] | (unsigned)bytes[a->offset + 2 * number + 1] << 8;
    if (u == 65535)
        return NAN;
    const double range = a->max[component] - a->min[component];
    *tolerance = range / 65534 * .51;
    return a->min[component] + u / 65534. * range;
}

static inline void assert_value(const array *a, size_t index, int components, int component, double expected)
{
    double tolerance;
    const double value = value_in(a, index, components, component, &tolerance);
    if (is_exact())
        expected = (double)(float)expected;
    if (!isfinite(expected)) {
        assert_true(!isfinite(value));
        return;
    }
    if (!(fabs(value - expected) <= tolerance + 1e-15 * fabs(expected)))
        fail_msg("particle %zu, component %d: %.17g instead of %.17g, tolerance %g", index, component, value,
                 expected, tolerance);
}

/* Compares a frame with a world: positions and those quantities that it knows. Returns how many. */
static inline int assert_frame(const char *frame, const rheo_world *world)
{
    const uint32_t count = rheo_world_particle_count(world);
    const char *at = frame;
    assert_non_null(frame);
    assert_int_equal(number_after(&at, "particles"), count);
    rheo_particle_state *state = malloc((count + 1) * sizeof *state);
    assert_int_equal(rheo_world_particles(world, state, NULL), RHEO_OK);
    const array position = positions_of(frame);
    for (uint32_t i = 0; i < count; i++)
        for (int axis = 0; axis < 3; axis++)
            assert_value(&position, i, 3, axis, state[i].position[axis]);
    const rheo_quantity *q;
    int known = 0;
    for (uint32_t k = 0; (q = rheo_world_quantity(world, k)) != NULL; k++) {
        array values;
        if (strstr(q->name, "position") || strcmp(q->name, "velocity") == 0 || quantity_of(q->name) < 0 ||
            !values_of(frame, q->name, &values))
            continue;
        known++;
        for (uint32_t i = 0; i < count; i++) {
            double v[3] = {0};
            memcpy(v, (const char *)&state[i] + q->offset, q->components * sizeof *v);
            assert_value(&values, i, 1, 0, q->components == 1 ? v[0] : sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]));
        }
    }
    free(state);
    return known;
}

/* Compares all frames with a recording. Returns their number. */
static inline int assert_all_frames(const char *path)
{
    rheo_recording *recording;
    rheo_player *player;
    assert_int_equal(rheo_recording_open(path, &recording, NULL), RHEO_OK);
    assert_int_equal(rheo_player_open(recording, NULL, &player, NULL), RHEO_OK);
    const char *at = strstr(meta, "\"frames\": ["), *end = strstr(meta, "], \"marks\": [");
    int frames = 0;
    double last = -1;
    while ((at = strstr(at, "{\"step\": ")) != NULL && at < end) {
        const char *frame = at, *number = at, *name = strstr(at, "\"stage\": ") + strlen("\"stage\": ");
        const double step = number_after(&number, "step");
        assert_true(step >= last); /* in order */
        last = step;
        char stage[64] = "";
        if (*name == '"')
            snprintf(stage, sizeof stage, "%.*s", (int)strcspn(name + 1, "\""), name + 1);
        assert_int_equal(*stage ? rheo_player_seek_stage(player, (uint64_t)step, stage, NULL)
                                : rheo_player_seek(player, (uint64_t)step, NULL),
                         RHEO_OK);
        assert_true(assert_frame(frame, rheo_player_world(player)) > 0);
        frames++;
        at++;
    }
    rheo_player_close(player);
    rheo_recording_close(recording);
    return frames;
}

/* Number of times that a text stands in the page. */
static size_t times(const char *text)
{
    size_t count = 0;
    for (const char *at = page; (at = strstr(at, text)) != NULL; at++)
        count++;
    return count;
}

#endif
