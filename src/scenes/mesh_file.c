/*
 * Meshes from files: OBJ (Wavefront) and PLY (Turk, Stanford; ascii and both binary forms). Of both only vertices and
 * faces count; polygons are cut into fans around their first vertex. Files are data from anywhere: every number,
 * index and length is checked, nothing is allocated because a file says how much there will be, and a message names
 * the line, or in binary parts the byte.
 */
#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "core/error.h"
#include "core/strict.h"
#include "core/text.h"
#include "scenes/mesh.h"

typedef struct reader {
    rheo__mesh *mesh;
    const char *begin, *at, *end;
    const char *name;
    size_t line;
    rheo_error *error;
} reader;

typedef struct token {
    const char *text;
    size_t length;
} token;

enum { TOKEN = 64 }; /* no number and no name is longer */

static rheo_result no_memory(const reader *r)
{
    return rheo__fail(r->error, RHEO_ERROR_MEMORY, "%.200s: no memory for a mesh of %zu triangles", r->name,
                      r->mesh->triangles);
}

/* What a message may repeat of a token: printable and short. */
static const char *shown(const token *t, char text[TOKEN])
{
    size_t length = t->length < 24 ? t->length : 24;
    for (size_t i = 0; i < length; i++)
        text[i] = t->text[i] >= 0x20 && t->text[i] < 0x7f ? t->text[i] : '?';
    text[length] = 0;
    return text;
}

static rheo_result wrong(const reader *r, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* `file:line: what is wrong`. */
static rheo_result wrong(const reader *r, const char *format, ...)
{
    char message[256];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    return rheo__fail(r->error, RHEO_ERROR_FORMAT, "%.200s:%zu: %s", r->name, r->line, message);
}

static bool is(const token *t, const char *word)
{
    return t->length == strlen(word) && memcmp(t->text, word, t->length) == 0;
}

static bool text_to_double(const token *t, double *value)
{
    char text[TOKEN];
    const char *end;
    if (t->length == 0 || t->length >= sizeof text)
        return false;
    memcpy(text, t->text, t->length);
    text[t->length] = 0;
    *value = rheo__text_to_double(text, &end);
    return end == text + t->length;
}

static bool is_finite(double x)
{
    return x >= -RHEO__MAX_MESH_COORDINATE && x <= RHEO__MAX_MESH_COORDINATE;
}

/* Corners of a polygon, one after the other. */
typedef struct fan {
    uint32_t first, last;
    size_t corners;
} fan;

static bool add_corner(reader *r, fan *f, uint32_t vertex)
{
    bool enough = f->corners < 2 || rheo__mesh_add_triangle(r->mesh, f->first, f->last, vertex);
    if (f->corners == 0)
        f->first = vertex;
    f->last = vertex;
    f->corners++;
    return enough;
}

/* ---- OBJ ---- */

/* Past blanks and over a backslash at the end of a line. */
static void skip_blanks(reader *r)
{
    while (r->at < r->end) {
        size_t left = (size_t)(r->end - r->at);
        if (*r->at == ' ' || *r->at == '\t' || *r->at == '\r') {
            r->at++;
        } else if (left >= 2 && r->at[0] == '\\' && r->at[1] == '\n') {
            r->at += 2;
            r->line++;
        } else if (left >= 3 && r->at[0] == '\\' && r->at[1] == '\r' && r->at[2] == '\n') {
            r->at += 3;
            r->line++;
        } else {
            return;
        }
    }
}

/* The next word of the line; an empty one at its end, or where a comment begins. */
static token next_word(reader *r)
{
    skip_blanks(r);
    token t = {r->at, 0};
    if (r->at < r->end && *r->at == '#')
        return t;
    for (; r->at < r->end; r->at++) {
        char c = *r->at;
        if (c == ' ' || c == '\t' || c == '\r' || c == '\n' ||
            (c == '\\' && r->at + 1 < r->end && (r->at[1] == '\n' || r->at[1] == '\r')))
            break;
        t.length++;
    }
    return t;
}

static void skip_line(reader *r)
{
    while (r->at < r->end && *r->at != '\n') {
        const char *before = r->at;
        skip_blanks(r);
        r->at += r->at == before; /* any other character */
    }
    if (r->at < r->end) {
        r->at++;
        r->line++;
    }
}

static rheo_result read_obj_vertex(reader *r)
{
    double position[3];
    char text[TOKEN];
    for (int axis = 0; axis < 3; axis++) {
        token t = next_word(r);
        if (!text_to_double(&t, &position[axis]) || !is_finite(position[axis]))
            return wrong(r, "\"%s\" is no finite coordinate; a vertex is \"v x y z\"", shown(&t, text));
    }
    return rheo__mesh_add_vertex(r->mesh, position) ? RHEO_OK : no_memory(r);
}

/* A whole number at the start of a word; *end is behind it. False: none, or one of more than ten digits. */
static bool read_index(const char **at, const char *end, int64_t *index)
{
    bool negative = *at < end && **at == '-';
    const char *digits = *at += negative;
    for (*index = 0; *at < end && **at >= '0' && **at <= '9' && *at - digits < 11; ++*at)
        *index = 10 * *index + (**at - '0');
    size_t count = (size_t)(*at - digits);
    *index = negative ? -*index : *index;
    return count > 0 && count <= 10;
}

/* a, a/b, a//c or a/b/c: of the vertex, its texture and its normal. */
static bool read_obj_corner(const token *t, int64_t *vertex)
{
    const char *at = t->text, *end = at + t->length;
    int64_t other;
    if (!read_index(&at, end, vertex))
        return false;
    if (at < end && *at++ != '/')
        return false;
    if (at < end && *at != '/' && !read_index(&at, end, &other))
        return false;
    if (at < end && *at++ != '/')
        return false;
    if (at < end && !read_index(&at, end, &other))
        return false;
    return at == end && end[-1] != '/';
}

static rheo_result read_obj_face(reader *r)
{
    fan f = {0, 0, 0};
    char text[TOKEN];
    for (token t; (t = next_word(r)).length > 0;) {
        int64_t vertex, count = (int64_t)r->mesh->vertices;
        if (!read_obj_corner(&t, &vertex))
            return wrong(r, "\"%s\" is no corner of a face; one is a, a/b, a/b/c or a//c", shown(&t, text));
        if (vertex == 0 || vertex > count || vertex < -count)
            return wrong(r, "a face has the vertex %lld; so far there are %lld, counted from 1", (long long)vertex,
                         (long long)count);
        if (!add_corner(r, &f, (uint32_t)(vertex > 0 ? vertex - 1 : count + vertex)))
            return no_memory(r);
    }
    return f.corners < 3 ? wrong(r, "a face has %zu corners; it needs three or more", f.corners) : RHEO_OK;
}

static rheo_result read_obj(reader *r)
{
    while (r->at < r->end) {
        token t = next_word(r);
        if (is(&t, "v"))
            RHEO__TRY(read_obj_vertex(r));
        else if (is(&t, "f"))
            RHEO__TRY(read_obj_face(r));
        skip_line(r);
    }
    return RHEO_OK;
}

/* ---- PLY ---- */

typedef enum ply_type {
    PLY_INT8,
    PLY_UINT8,
    PLY_INT16,
    PLY_UINT16,
    PLY_INT32,
    PLY_UINT32,
    PLY_FLOAT,
    PLY_DOUBLE
} ply_type;

static const struct {
    const char *name, *other;
    size_t size;
} ply_types[] = {{"char", "int8", 1}, {"uchar", "uint8", 1}, {"short", "int16", 2},   {"ushort", "uint16", 2},
                 {"int", "int32", 4}, {"uint", "uint32", 4}, {"float", "float32", 4}, {"double", "float64", 8}};

typedef struct ply_property {
    ply_type type, count_type;
    bool list;
    int8_t axis;  /* 0, 1, 2: a coordinate of a vertex; -1 */
    bool corners; /* of a face */
} ply_property;

enum { PLY_ELEMENTS = 16, PLY_PROPERTIES = 64 };

typedef struct ply_element {
    uint64_t count;
    size_t properties;
    bool vertex, face;
    ply_property property[PLY_PROPERTIES];
} ply_element;

typedef struct ply {
    reader *r;
    enum { PLY_ASCII, PLY_LITTLE, PLY_BIG } form;
    uint64_t vertices; /* that there will be */
    size_t elements;
    ply_element element[PLY_ELEMENTS];
} ply;

/* Where reading stands, for messages: a line of text, or a byte. */
static rheo_result ply_wrong(const ply *p, const char *what)
{
    const reader *r = p->r;
    if (p->form == PLY_ASCII)
        return wrong(r, "%s", what);
    return rheo__fail(r->error, RHEO_ERROR_FORMAT, "%.200s: byte %zu: %s", r->name, (size_t)(r->at - r->begin), what);
}

static rheo_result read_ply_type(reader *r, ply_type *type)
{
    token t = next_word(r);
    char text[TOKEN];
    for (size_t i = 0; i < sizeof ply_types / sizeof *ply_types; i++)
        if (is(&t, ply_types[i].name) || is(&t, ply_types[i].other)) {
            *type = (ply_type)i;
            return RHEO_OK;
        }
    return wrong(r, "\"%s\" is no type of PLY; there are char, uchar, short, ushort, int, uint, float, double",
                 shown(&t, text));
}

static rheo_result read_ply_property(ply *p)
{
    reader *r = p->r;
    if (p->elements == 0)
        return wrong(r, "a property before the first element");
    ply_element *element = &p->element[p->elements - 1];
    if (element->properties == PLY_PROPERTIES)
        return wrong(r, "an element has more than %d properties", PLY_PROPERTIES);
    ply_property *property = &element->property[element->properties++];
    *property = (ply_property){.axis = -1};
    const char *before = r->at;
    token t = next_word(r);
    property->list = is(&t, "list");
    if (property->list)
        RHEO__TRY(read_ply_type(r, &property->count_type));
    else
        r->at = before;
    RHEO__TRY(read_ply_type(r, &property->type));
    t = next_word(r);
    for (int8_t axis = 0; axis < 3 && element->vertex; axis++)
        if (t.length == 1 && *t.text == "xyz"[axis])
            property->axis = axis;
    property->corners = element->face && (is(&t, "vertex_indices") || is(&t, "vertex_index"));
    if ((property->axis >= 0 && property->list) || (property->corners && !property->list))
        return wrong(r, "coordinates are no lists, and the vertices of a face are one");
    for (size_t i = 0; i + 1 < element->properties; i++)
        if ((property->corners && element->property[i].corners) ||
            (property->axis >= 0 && element->property[i].axis == property->axis))
            return wrong(r, "a property is given twice");
    return RHEO_OK;
}

static rheo_result read_ply_element(ply *p)
{
    reader *r = p->r;
    token t = next_word(r), number = next_word(r);
    double count;
    if (p->elements == PLY_ELEMENTS)
        return wrong(r, "a file has more than %d elements", PLY_ELEMENTS);
    ply_element *element = &p->element[p->elements++];
    memset(element, 0, sizeof *element);
    element->vertex = is(&t, "vertex");
    element->face = is(&t, "face");
    if (!text_to_double(&number, &count) || !(count >= 0 && count <= 4294967295.0) ||
        count != (double)(uint64_t)count)
        return wrong(r, "an element is \"element name count\"");
    element->count = (uint64_t)count;
    for (size_t i = 0; i + 1 < p->elements; i++)
        if ((element->vertex && p->element[i].vertex) || (element->face && p->element[i].face))
            return wrong(r, "an element is given twice");
    if (element->vertex)
        p->vertices = element->count;
    return RHEO_OK;
}

static rheo_result read_ply_header(ply *p)
{
    reader *r = p->r;
    bool format = false;
    char text[TOKEN];
    token t = next_word(r);
    if (!is(&t, "ply"))
        return wrong(r, "is no PLY file; one begins with \"ply\"");
    for (;;) {
        while (r->at < r->end && *r->at != '\n')
            r->at++;
        if (r->at == r->end)
            return wrong(r, "the header has no end; \"end_header\" ends it");
        r->at++;
        r->line++;
        t = next_word(r);
        if (is(&t, "end_header"))
            break;
        if (is(&t, "format")) {
            token form = next_word(r), version = next_word(r);
            format = is(&version, "1.0") &&
                     (is(&form, "ascii") || is(&form, "binary_little_endian") || is(&form, "binary_big_endian"));
            if (!format)
                return wrong(r, "a format is ascii, binary_little_endian or binary_big_endian, and 1.0");
            p->form = is(&form, "ascii") ? PLY_ASCII : is(&form, "binary_big_endian") ? PLY_BIG : PLY_LITTLE;
        } else if (is(&t, "element")) {
            RHEO__TRY(read_ply_element(p));
        } else if (is(&t, "property")) {
            RHEO__TRY(read_ply_property(p));
        } else if (t.length > 0 && !is(&t, "comment") && !is(&t, "obj_info")) {
            return wrong(r, "\"%s\" is no line of a PLY header", shown(&t, text));
        }
    }
    if (!format)
        return wrong(r, "the header names no format");
    while (r->at < r->end && *r->at != '\n') /* the rest of its last line */
        r->at++;
    if (r->at == r->end)
        return wrong(r, "the file ends with its header");
    r->at++;
    r->line++;
    return RHEO_OK;
}

/* Every vertex has three coordinates, every face corners. */
static rheo_result check_ply_header(const ply *p)
{
    bool vertices = false, faces = false;
    for (size_t e = 0; e < p->elements; e++) {
        const ply_element *element = &p->element[e];
        size_t coordinates = 0;
        for (size_t i = 0; i < element->properties; i++) {
            coordinates += element->property[i].axis >= 0;
            faces = faces || element->property[i].corners;
        }
        vertices = vertices || coordinates == 3;
    }
    if (!vertices)
        return wrong(p->r, "there is no element \"vertex\" with x, y and z");
    if (!faces)
        return wrong(p->r, "there is no element \"face\" with a list vertex_indices");
    return RHEO_OK;
}

static rheo_result read_ply_text(const ply *p, double *value)
{
    reader *r = p->r;
    char text[TOKEN], message[128];
    token t;
    while (r->at < r->end && (*r->at == ' ' || *r->at == '\t' || *r->at == '\r' || *r->at == '\n'))
        r->line += *r->at++ == '\n';
    t = (token){r->at, 0};
    for (; r->at < r->end && !strchr(" \t\r\n", *r->at); r->at++) /* a NUL byte ends it too */
        t.length++;
    if (t.length == 0 && r->at == r->end)
        return ply_wrong(p, "the file ends before its last element");
    if (text_to_double(&t, value))
        return RHEO_OK;
    snprintf(message, sizeof message, "\"%s\" is no number", shown(&t, text));
    return ply_wrong(p, message);
}

static rheo_result read_ply_number(const ply *p, ply_type type, double *value)
{
    reader *r = p->r;
    if (p->form == PLY_ASCII)
        return read_ply_text(p, value);
    size_t size = ply_types[type].size;
    if ((size_t)(r->end - r->at) < size)
        return ply_wrong(p, "the file ends before its last element");
    uint64_t bits = 0;
    for (size_t i = 0; i < size; i++)
        bits |= (uint64_t)(unsigned char)r->at[i] << 8 * (p->form == PLY_BIG ? size - 1 - i : i);
    uint32_t half = (uint32_t)bits;
    float single;
    switch (type) {
    case PLY_INT8:
    case PLY_INT16:
    case PLY_INT32: {
        int64_t limit = (int64_t)1 << (8 * size - 1), whole = (int64_t)bits;
        *value = (double)(whole < limit ? whole : whole - 2 * limit);
        break;
    }
    case PLY_UINT8:
    case PLY_UINT16:
    case PLY_UINT32:
        *value = (double)bits;
        break;
    case PLY_FLOAT:
        memcpy(&single, &half, sizeof single);
        *value = (double)single;
        break;
    case PLY_DOUBLE:
        memcpy(value, &bits, sizeof bits);
        break;
    }
    r->at += size;
    return RHEO_OK;
}

static rheo_result read_ply_list(const ply *p, const ply_property *property)
{
    reader *r = p->r;
    double count, value;
    RHEO__TRY(read_ply_number(p, property->count_type, &count));
    double least = p->form == PLY_ASCII ? 1 : (double)ply_types[property->type].size;
    if (!(count >= 0 && count * least <= (double)(r->end - r->at)) || count != (double)(uint64_t)count)
        return ply_wrong(p, "a list is longer than what is left of the file, or its length is no whole number");
    if (property->corners && count < 3)
        return ply_wrong(p, "a face has less than three corners");
    fan f = {0, 0, 0};
    for (uint64_t i = 0; i < (uint64_t)count; i++) {
        RHEO__TRY(read_ply_number(p, property->type, &value));
        if (!property->corners)
            continue;
        if (!(value >= 0 && value < (double)p->vertices) || value != (double)(uint64_t)value) {
            char message[128];
            snprintf(message, sizeof message, "a face has the vertex %g; there are %llu, counted from 0", value,
                     (unsigned long long)p->vertices);
            return ply_wrong(p, message);
        }
        if (!add_corner(r, &f, (uint32_t)value))
            return no_memory(r);
    }
    return RHEO_OK;
}

static rheo_result read_ply_item(const ply *p, const ply_element *element)
{
    double position[3] = {0, 0, 0}, value;
    for (size_t i = 0; i < element->properties; i++) {
        const ply_property *property = &element->property[i];
        if (property->list) {
            RHEO__TRY(read_ply_list(p, property));
            continue;
        }
        RHEO__TRY(read_ply_number(p, property->type, &value));
        if (property->axis < 0)
            continue;
        if (!is_finite(value))
            return ply_wrong(p, "a coordinate of a vertex is not finite");
        position[property->axis] = value;
    }
    if (element->vertex && !rheo__mesh_add_vertex(p->r->mesh, position))
        return no_memory(p->r);
    return RHEO_OK;
}

static rheo_result read_ply(reader *r)
{
    ply p = {.r = r};
    RHEO__TRY(read_ply_header(&p));
    RHEO__TRY(check_ply_header(&p));
    for (size_t e = 0; e < p.elements; e++) /* an item takes a byte at least, so that counts cannot lie */
        for (uint64_t i = 0; i < p.element[e].count && p.element[e].properties > 0; i++)
            RHEO__TRY(read_ply_item(&p, &p.element[e]));
    return RHEO_OK;
}

/* ---- Files ---- */

static const char bunny[] = {
#include "scenes/data/bunny.obj.inc"
};

/* Whether a name ends so, in capitals or not. */
static bool ends_with(const char *name, const char *ending)
{
    size_t length = strlen(name), tail = strlen(ending);
    if (length <= tail)
        return false;
    for (size_t i = 0; i < tail; i++) {
        char c = name[length - tail + i];
        if ((c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c) != ending[i])
            return false;
    }
    return true;
}

rheo_result rheo__mesh_read(rheo__mesh *mesh, const rheo_allocator *allocator, const char *bytes, size_t size,
                            const char *name, rheo_error *error)
{
    bool obj = ends_with(name, ".obj");
    if (!obj && !ends_with(name, ".ply"))
        return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                          "there is no mesh \"%.200s\"; a mesh is \"bunny\" or a file that ends in .obj or .ply",
                          name);
    if (size > RHEO__MAX_MESH_BYTES)
        return rheo__fail(error, RHEO_ERROR_FORMAT, "%.200s: the file has more than %zu MiB", name,
                          RHEO__MAX_MESH_BYTES >> 20);
    rheo__mesh_init(mesh, allocator, obj ? 1 : 0);
    reader r = {mesh, bytes, bytes, bytes + size, name, 1, error};
    rheo_result result = obj ? read_obj(&r) : read_ply(&r);
    if (result == RHEO_OK)
        result = rheo__mesh_check(mesh, name, error);
    if (result != RHEO_OK)
        rheo__mesh_release(mesh);
    return result;
}

rheo_result rheo__mesh_open(rheo__mesh *mesh, const rheo_allocator *allocator, const char *name, rheo_error *error)
{
    if (strcmp(name, "bunny") == 0)
        return rheo__mesh_read(mesh, allocator, bunny, sizeof bunny, "bunny.obj", error);
    if (!ends_with(name, ".obj") && !ends_with(name, ".ply"))
        return rheo__mesh_read(mesh, allocator, "", 0, name, error); /* says what a mesh is */
    rheo_allocator from = rheo__allocator_or_default(*allocator);
    FILE *file = fopen(name, "rb");
    if (!file)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "cannot read the mesh %.200s: %s", name, strerror(errno));
    void *bytes = NULL;
    size_t size = 0, room = 0, got = 1;
    bool enough = true;
    while (enough && got > 0 && size <= RHEO__MAX_MESH_BYTES) {
        enough = size < room || rheo__grow(&from, &bytes, &room, size < 65536 ? 65536 : 2 * size, size, 1);
        if (enough)
            size += got = fread((char *)bytes + size, 1, room - size, file);
    }
    bool failed = ferror(file) != 0;
    fclose(file);
    rheo_result result;
    if (!enough)
        result = rheo__fail(error, RHEO_ERROR_MEMORY, "no memory to read %.200s", name);
    else if (failed)
        result = rheo__fail(error, RHEO_ERROR_FILE, "cannot read %.200s to its end", name);
    else
        result = rheo__mesh_read(mesh, allocator, bytes, size, name, error);
    rheo__release(&from, bytes);
    return result;
}
