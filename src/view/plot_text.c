/* Texts and numbers of plots. */
#include <string.h>

#include "view/plot.h"

void rheo__plot_number(rheo__output *out, double value)
{
    const double limit = 1e7, bounded = value > limit ? limit : value < -limit ? -limit : value;
    const long hundredths = (long)(bounded * 100 + (bounded < 0 ? -.5 : .5)),
               size = hundredths < 0 ? -hundredths : hundredths;
    rheo__output_format(out, "%s%ld", hundredths < 0 ? "-" : "", size / 100);
    if (size % 100)
        rheo__output_format(out, size % 10 ? ".%02ld" : ".%01ld", size % 10 ? size % 100 : size % 100 / 10);
}

/* Writes one character and returns its length in bytes. */
static size_t put_character(rheo__output *out, const char *text)
{
    const size_t length = rheo_printable_length(text);
    switch (*text) {
    case '&':
        rheo__output_text(out, "&amp;");
        break;
    case '<':
        rheo__output_text(out, "&lt;");
        break;
    case '>':
        rheo__output_text(out, "&gt;");
        break;
    case '"':
        rheo__output_text(out, "&quot;");
        break;
    default:
        rheo__output_bytes(out, length ? text : "?", length ? length : 1);
    }
    return length ? length : 1;
}

/* Length of ^{ or _{ at the text if there is a } behind it; 0 otherwise. */
static size_t shift_begins(const char *text)
{
    return (*text == '^' || *text == '_') && text[1] == '{' && strchr(text, '}') ? 2 : 0;
}

void rheo__plot_plain(rheo__output *out, const char *text)
{
    bool shifted = false;
    while (*text)
        if (shift_begins(text)) {
            rheo__output_bytes(out, text, *text == '^');
            text += 2;
            shifted = true;
        } else if (shifted && *text == '}') {
            text++;
            shifted = false;
        } else {
            text += put_character(out, text);
        }
}

void rheo__plot_text(rheo__output *out, const char *text, int size)
{
    int lowered = 0; /* of the text so far, in pixels */
    while (*text) {
        const size_t begin = shift_begins(text);
        const char *end = begin ? strchr(text, '}') : text + 1;
        while (!begin && *end && !shift_begins(end))
            end++;
        const int wanted = !begin ? 0 : *text == '^' ? -size / 3 : size / 4;
        const bool spans = wanted != lowered || begin;
        if (spans) {
            const bool blank = !begin && *text == ' '; /* programs drop a blank at the begin of a span */
            rheo__output_format(out, "<tspan dy=\"%d\"", wanted - lowered);
            if (begin)
                rheo__output_format(out, " font-size=\"%d\"", size * 3 / 4);
            if (blank)
                rheo__output_format(out, " dx=\"%d\"", size / 4);
            rheo__output_text(out, ">");
            text += blank;
        }
        for (text += begin; text < end;)
            text += put_character(out, text);
        rheo__output_text(out, spans ? "</tspan>" : "");
        text += begin != 0; /* the } */
        lowered = wanted;
    }
}

double rheo__plot_text_width(const char *text, int size)
{
    double width = 0;
    bool shifted = false;
    while (*text)
        if (shift_begins(text)) {
            text += 2;
            shifted = true;
        } else if (shifted && *text == '}') {
            text++;
            shifted = false;
        } else {
            const size_t length = rheo_printable_length(text);
            text += length ? length : 1;
            width += size * (shifted ? .4 : .53);
        }
    return width;
}
