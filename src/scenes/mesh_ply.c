/*
 * PLY (Turk, Stanford) in ascii and both binary forms. The elements vertex (x, y, z) and face (vertex_indices) are
 * read, other elements are skipped. Polygons are cut into fans.
 */
#include <stdio.h>
#include <string.h>

#include "core/strict.h"
#include "core/text.h"
#include "scenes/mesh_reader.h"

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
    int8_t axis;  /* 0, 1, 2: a coordinate of a vertex; -1: any other property */
    bool corners; /* this is the vertex list of a face */
} ply_property;

enum { PLY_ELEMENTS = 16, PLY_PROPERTIES = 64 };

typedef struct ply_element {
    uint64_t count;
    size_t properties;
    bool vertex, face;
    ply_property property[PLY_PROPERTIES];
} ply_element;

typedef struct ply {
    rheo__mesh_reader *r;
    enum { PLY_ASCII, PLY_LITTLE, PLY_BIG } form;
    uint64_t vertices; /* number in the header */
    size_t elements;
    ply_element element[PLY_ELEMENTS];
} ply;

/* Fails with the line, or in a binary file with the byte. */
static rheo_result ply_wrong(const ply *p, const char *what)
{
    const rheo__mesh_reader *r = p->r;
    if (p->form == PLY_ASCII)
        return rheo__mesh_wrong(r, "%s", what);
    return rheo__fail(r->error, RHEO_ERROR_FORMAT, "%.200s: byte %zu: %s", r->name, (size_t)(r->at - r->begin), what);
}

static rheo_result read_type(rheo__mesh_reader *r, ply_type *type)
{
    rheo__token t = rheo__mesh_word(r);
    char text[RHEO__TOKEN];
    for (size_t i = 0; i < sizeof ply_types / sizeof *ply_types; i++)
        if (rheo__token_is(&t, ply_types[i].name) || rheo__token_is(&t, ply_types[i].other)) {
            *type = (ply_type)i;
            return RHEO_OK;
        }
    return rheo__mesh_wrong(
        r, "\"%s\" is no type of PLY; there are char, uchar, short, ushort, int, uint, float, double",
        rheo__token_shown(&t, text));
}

static rheo_result read_property(ply *p)
{
    rheo__mesh_reader *r = p->r;
    if (p->elements == 0)
        return rheo__mesh_wrong(r, "a property before the first element");
    ply_element *element = &p->element[p->elements - 1];
    if (element->properties == PLY_PROPERTIES)
        return rheo__mesh_wrong(r, "an element has more than %d properties", PLY_PROPERTIES);
    ply_property *property = &element->property[element->properties++];
    *property = (ply_property){.axis = -1};
    const char *before = r->at;
    rheo__token t = rheo__mesh_word(r);
    property->list = rheo__token_is(&t, "list");
    if (property->list)
        RHEO__TRY(read_type(r, &property->count_type));
    else
        r->at = before;
    RHEO__TRY(read_type(r, &property->type));
    t = rheo__mesh_word(r);
    for (int8_t axis = 0; axis < 3 && element->vertex; axis++)
        if (t.length == 1 && *t.text == "xyz"[axis])
            property->axis = axis;
    property->corners = element->face && (rheo__token_is(&t, "vertex_indices") || rheo__token_is(&t, "vertex_index"));
    if ((property->axis >= 0 && property->list) || (property->corners && !property->list))
        return rheo__mesh_wrong(r, "coordinates must not be lists, and the vertices of a face must be one");
    for (size_t i = 0; i + 1 < element->properties; i++)
        if ((property->corners && element->property[i].corners) ||
            (property->axis >= 0 && element->property[i].axis == property->axis))
            return rheo__mesh_wrong(r, "a property is given twice");
    return RHEO_OK;
}

static rheo_result read_element(ply *p)
{
    rheo__mesh_reader *r = p->r;
    rheo__token t = rheo__mesh_word(r), number = rheo__mesh_word(r);
    double count;
    if (p->elements == PLY_ELEMENTS)
        return rheo__mesh_wrong(r, "a file has more than %d elements", PLY_ELEMENTS);
    ply_element *element = &p->element[p->elements++];
    memset(element, 0, sizeof *element);
    element->vertex = rheo__token_is(&t, "vertex");
    element->face = rheo__token_is(&t, "face");
    if (!rheo__token_number(&number, &count) || !(count >= 0 && count <= 4294967295.0) ||
        count != (double)(uint64_t)count)
        return rheo__mesh_wrong(r, "an element is \"element name count\"");
    element->count = (uint64_t)count;
    for (size_t i = 0; i + 1 < p->elements; i++)
        if ((element->vertex && p->element[i].vertex) || (element->face && p->element[i].face))
            return rheo__mesh_wrong(r, "an element is given twice");
    if (element->vertex)
        p->vertices = element->count;
    return RHEO_OK;
}

static rheo_result read_header(ply *p)
{
    rheo__mesh_reader *r = p->r;
    bool format = false;
    char text[RHEO__TOKEN];
    rheo__token t = rheo__mesh_word(r);
    if (!rheo__token_is(&t, "ply"))
        return rheo__mesh_wrong(r, "is no PLY file; one begins with \"ply\"");
    for (;;) {
        while (r->at < r->end && *r->at != '\n')
            r->at++;
        if (r->at == r->end)
            return rheo__mesh_wrong(r, "the header has no end; \"end_header\" ends it");
        r->at++;
        r->line++;
        t = rheo__mesh_word(r);
        if (rheo__token_is(&t, "end_header"))
            break;
        if (rheo__token_is(&t, "format")) {
            rheo__token form = rheo__mesh_word(r), version = rheo__mesh_word(r);
            format = rheo__token_is(&version, "1.0") &&
                     (rheo__token_is(&form, "ascii") || rheo__token_is(&form, "binary_little_endian") ||
                      rheo__token_is(&form, "binary_big_endian"));
            if (!format)
                return rheo__mesh_wrong(r, "a format is ascii, binary_little_endian or binary_big_endian, and 1.0");
            p->form = rheo__token_is(&form, "ascii")               ? PLY_ASCII
                      : rheo__token_is(&form, "binary_big_endian") ? PLY_BIG
                                                                   : PLY_LITTLE;
        } else if (rheo__token_is(&t, "element")) {
            RHEO__TRY(read_element(p));
        } else if (rheo__token_is(&t, "property")) {
            RHEO__TRY(read_property(p));
        } else if (t.length > 0 && !rheo__token_is(&t, "comment") && !rheo__token_is(&t, "obj_info")) {
            return rheo__mesh_wrong(r, "\"%s\" is no line of a PLY header", rheo__token_shown(&t, text));
        }
    }
    if (!format)
        return rheo__mesh_wrong(r, "the header names no format");
    while (r->at < r->end && *r->at != '\n') /* rest of the last line of the header */
        r->at++;
    if (r->at == r->end)
        return rheo__mesh_wrong(r, "the file ends with its header");
    r->at++;
    r->line++;
    return RHEO_OK;
}

/* Checks that vertices have three coordinates and faces have corners. */
static rheo_result check_header(const ply *p)
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
        return rheo__mesh_wrong(p->r, "there is no element \"vertex\" with x, y and z");
    if (!faces)
        return rheo__mesh_wrong(p->r, "there is no element \"face\" with a list vertex_indices");
    return RHEO_OK;
}

static rheo_result read_text(const ply *p, double *value)
{
    rheo__mesh_reader *r = p->r;
    char text[RHEO__TOKEN], message[128];
    rheo__token t;
    while (r->at < r->end && (*r->at == ' ' || *r->at == '\t' || *r->at == '\r' || *r->at == '\n'))
        r->line += *r->at++ == '\n';
    t = (rheo__token){r->at, 0};
    for (; r->at < r->end && !strchr(" \t\r\n", *r->at); r->at++) /* a NUL byte also ends it */
        t.length++;
    if (t.length == 0 && r->at == r->end)
        return ply_wrong(p, "the file ends before its last element");
    if (rheo__token_number(&t, value))
        return RHEO_OK;
    snprintf(message, sizeof message, "\"%s\" is no number", rheo__token_shown(&t, text));
    return ply_wrong(p, message);
}

static rheo_result read_number(const ply *p, ply_type type, double *value)
{
    rheo__mesh_reader *r = p->r;
    if (p->form == PLY_ASCII)
        return read_text(p, value);
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

static rheo_result read_list(const ply *p, const ply_property *property)
{
    rheo__mesh_reader *r = p->r;
    double count, value;
    RHEO__TRY(read_number(p, property->count_type, &count));
    double least = p->form == PLY_ASCII ? 1 : (double)ply_types[property->type].size;
    if (!(count >= 0 && count * least <= (double)(r->end - r->at)) || count != (double)(uint64_t)count)
        return ply_wrong(p, "a list is longer than the rest of the file, or its length is not a whole number");
    if (property->corners && count < 3)
        return ply_wrong(p, "a face has fewer than three corners");
    rheo__fan f = {0, 0, 0};
    for (uint64_t i = 0; i < (uint64_t)count; i++) {
        RHEO__TRY(read_number(p, property->type, &value));
        if (!property->corners)
            continue;
        if (!(value >= 0 && value < (double)p->vertices) || value != (double)(uint64_t)value) {
            char message[128];
            rheo__text_print(message, sizeof message, "a face has the vertex %g; there are %llu, counted from 0",
                             value, (unsigned long long)p->vertices);
            return ply_wrong(p, message);
        }
        if (!rheo__fan_add(&f, r->mesh, (uint32_t)value))
            return rheo__mesh_no_memory(r);
    }
    return RHEO_OK;
}

static rheo_result read_item(const ply *p, const ply_element *element)
{
    double position[3] = {0, 0, 0}, value;
    for (size_t i = 0; i < element->properties; i++) {
        const ply_property *property = &element->property[i];
        if (property->list) {
            RHEO__TRY(read_list(p, property));
            continue;
        }
        RHEO__TRY(read_number(p, property->type, &value));
        if (property->axis < 0)
            continue;
        if (!rheo__is_coordinate(value))
            return ply_wrong(p, "a coordinate of a vertex is not finite");
        position[property->axis] = value;
    }
    if (element->vertex && !rheo__mesh_add_vertex(p->r->mesh, position))
        return rheo__mesh_no_memory(p->r);
    return RHEO_OK;
}

rheo_result rheo__mesh_read_ply(rheo__mesh_reader *r)
{
    ply p = {.r = r};
    RHEO__TRY(read_header(&p));
    RHEO__TRY(check_header(&p));
    for (size_t e = 0; e < p.elements; e++) /* an item has at least one byte, so a false count ends soon */
        for (uint64_t i = 0; i < p.element[e].count && p.element[e].properties > 0; i++)
            RHEO__TRY(read_item(&p, &p.element[e]));
    return RHEO_OK;
}
