/*
 * Encodes pictures as PNG in memory. The settings are fixed, and there is no time in the file, so that the bytes depend on
 * the pixels and the versions of libpng and zlib only.
 */
#include "cli/png.h"

#include <png.h>
#include <setjmp.h>
#include <stdlib.h>
#include <string.h>

enum { LEVEL = 6 }; /* of the compression */

/* Bytes of a file in the making. */
typedef struct bytes {
    unsigned char *at;
    size_t size, room;
} bytes;

typedef struct encoder {
    png_structp png;
    png_infop info;
    bytes made;
} encoder;

int cli_check_png(void)
{
    return CLI_DONE;
}

static void add_bytes(png_structp png, png_bytep from, png_size_t size)
{
    bytes *b = png_get_io_ptr(png);
    if (size > b->room - b->size) {
        const size_t room = 2 * b->room + size;
        unsigned char *at = realloc(b->at, room);
        if (!at)
            png_error(png, "no memory");
        b->at = at;
        b->room = room;
    }
    memcpy(b->at + b->size, from, size);
    b->size += size;
}

static void flush_nothing(png_structp png)
{
    (void)png;
}

/* libpng goes back to setjmp() after an error; nothing that it changes is a local variable. */
static bool encode(encoder *e, const unsigned char *rgb, uint32_t width, uint32_t height)
{
    e->png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    e->info = e->png ? png_create_info_struct(e->png) : NULL;
    if (!e->info || setjmp(png_jmpbuf(e->png)))
        return false;
    png_set_write_fn(e->png, &e->made, add_bytes, flush_nothing);
    png_set_compression_level(e->png, LEVEL);
    png_set_compression_strategy(e->png, 1); /* Z_FILTERED */
    png_set_filter(e->png, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB);
    png_set_IHDR(e->png, e->info, width, height, 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_sRGB(e->png, e->info, PNG_sRGB_INTENT_PERCEPTUAL);
    png_write_info(e->png, e->info);
    for (size_t row = 0; row < height; row++)
        png_write_row(e->png, rgb + 3 * row * width);
    png_write_end(e->png, e->info);
    return true;
}

int cli_write_png(const char *path, const unsigned char *rgb, uint32_t width, uint32_t height, bool force)
{
    encoder e = {.png = NULL};
    rheo_error error = {"no memory"};
    rheo_result result = RHEO_ERROR_MEMORY;
    if (encode(&e, rgb, width, height))
        result = rheo_export_bytes(path, e.made.at, e.made.size, force, &error);
    png_destroy_write_struct(&e.png, &e.info);
    free(e.made.at);
    return result == RHEO_OK ? CLI_DONE : cli_error(result, &error);
}
