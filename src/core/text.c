/*
 * Numbers as text, the same in every locale: printf and strtod take the decimal separator from the locale of the
 * program. printf gets another locale where that is no point; for strtod, a point is replaced by the separator. And texts that are safe to print: those in a file may come from
 * anyone.
 */
#define _POSIX_C_SOURCE 200809L /* newlocale() */
#include "core/text.h"

#include <float.h>
#include <locale.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "rheolog/base.h"

static const char *separator(void)
{
    const char *point = localeconv()->decimal_point;
    return point && *point ? point : ".";
}

void rheo__text_from_double(double value, char text[32])
{
    for (int digits = 15; digits <= 17; digits++) {
        rheo__text_print(text, 32, "%.*g", digits, value);
        const char *end;
        if (rheo__text_to_double(text, &end) == value)
            return;
    }
}

double rheo__text_to_double(const char *text, const char **end)
{
    char local[80];
    size_t length = strspn(text, "+-.0123456789eE"), used = 0;
    *end = text;
    if (length == 0 || length >= sizeof local - 16)
        return 0;
    /* to_local[k]: number of bytes in the local form of the first k bytes of text. */
    size_t to_local[sizeof local];
    for (size_t i = 0; i < length; i++) {
        to_local[i] = used;
        if (text[i] == '.') {
            for (const char *p = separator(); *p && used < sizeof local - 1; p++)
                local[used++] = *p;
        } else if (used < sizeof local - 1) {
            local[used++] = text[i];
        }
    }
    to_local[length] = used;
    local[used] = 0;
    char *stop;
    double value = strtod(local, &stop);
    for (size_t i = 1; i <= length; i++)
        if (to_local[i] == (size_t)(stop - local))
            *end = text + i;
    return value;
}

void rheo_number_text(double value, char *text)
{
    if (value != value)
        snprintf(text, 32, "nan"); /* the sign of NaN differs between machines */
    else
        rheo__text_from_double(value, text);
}

double rheo_text_number(const char *text, const char **end)
{
    return rheo__text_to_double(text, end);
}

/* From a million on, zeros that only fill up a number are hard to count: 2.46e+07, not 24600000. */
static void write_large(double value, char text[32])
{
    const char *end;
    for (int decimals = 0; decimals <= 16; decimals++) {
        rheo__text_print(text, 32, "%.*e", decimals, value);
        if (rheo__text_to_double(text, &end) == value)
            return;
    }
}

const char *rheo__text_brief(double value, int digits, bool down, char text[32])
{
    double least = 1, scale = 1, size = value < 0 ? -value : value;
    if (value != value || size > DBL_MAX) {
        snprintf(text, 32, "%s", value != value ? "not a number" : "infinite");
        return text;
    }
    for (int i = 1; i < digits; i++)
        least *= 10;
    int exponent = 0; /* size * scale is the number of 10^exponent */
    if (size > 0) {
        for (; size * scale < least && scale < 1e300; exponent--)
            scale *= 10;
        for (; size * scale >= 10 * least; exponent++)
            scale /= 10;
        char number[48];
        const char *end;
        snprintf(number, sizeof number, "%llue%d", (unsigned long long)(size * scale + (down ? 1e-9 : 0.5)),
                 exponent);
        size = rheo__text_to_double(number, &end);
        if (size > DBL_MAX) /* rounded up beyond all numbers */
            size = DBL_MAX;
    }
    if (size >= 1e6 && size >= 10 * least)
        write_large(value < 0 ? -size : size, text);
    else
        rheo__text_from_double(value < 0 ? -size : size, text);
    return text;
}

const char *rheo_number_brief(double value, int digits, char *text)
{
    return rheo__text_brief(value, digits, false, text);
}

void rheo__text_two(double a, double b, char text_a[32], char text_b[32])
{
    enum { FEWEST = 3, MOST = 15 };
    int digits = FEWEST;
    do {
        rheo__text_brief(a, digits, false, text_a);
        rheo__text_brief(b, digits, false, text_b);
    } while (a != b && strcmp(text_a, text_b) == 0 && digits++ < MOST);
    if (a != b && strcmp(text_a, text_b) == 0) {
        rheo__text_from_double(a, text_a);
        rheo__text_from_double(b, text_b);
    }
}

void rheo__text_add(char *text, size_t size, const char *format, ...)
{
    const size_t used = strlen(text);
    va_list arguments;
    va_start(arguments, format);
    rheo__text_vprint(text + used, size - used, format, arguments);
    va_end(arguments);
}

int rheo__text_vprint(char *text, size_t size, const char *format, va_list arguments)
{
    locale_t own = (locale_t)0, plain = (locale_t)0;
    if (strcmp(separator(), ".") != 0)
        plain = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    if (plain)
        own = uselocale(plain); /* of this thread only */
    const int length = vsnprintf(text, size, format, arguments);
    if (plain) {
        uselocale(own);
        freelocale(plain);
    }
    return length;
}

int rheo__text_print(char *text, size_t size, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    const int length = rheo__text_vprint(text, size, format, arguments);
    va_end(arguments);
    return length;
}

/* ---- Text from anyone ---- */

/* Length in bytes of the UTF-8 character at `c`; 0: not valid. */
static size_t utf8_length(const unsigned char *c)
{
    if (c[0] < 0x80)
        return 1;
    const size_t length = c[0] >= 0xf0 ? 4 : c[0] >= 0xe0 ? 3 : 2;
    if (c[0] < 0xc2 || c[0] > 0xf4)
        return 0;
    for (size_t i = 1; i < length; i++)
        if ((c[i] & 0xc0) != 0x80)
            return 0;
    /* Refuses overlong forms, surrogates, and code points above U+10FFFF. */
    if ((c[0] == 0xe0 && c[1] < 0xa0) || (c[0] == 0xed && c[1] > 0x9f) || (c[0] == 0xf0 && c[1] < 0x90) ||
        (c[0] == 0xf4 && c[1] > 0x8f))
        return 0;
    return length;
}

size_t rheo_printable_length(const char *text)
{
    const unsigned char *c = (const unsigned char *)text;
    const bool control = c[0] < 0x20 || c[0] == 0x7f || (c[0] == 0xc2 && c[1] < 0xa0);
    return control ? 0 : utf8_length(c);
}

bool rheo__text_is_printable(const char *text, const char *also)
{
    while (*text) {
        const size_t length = strchr(also, *text) ? 1 : rheo_printable_length(text);
        if (length == 0)
            return false;
        text += length;
    }
    return true;
}

void rheo__text_make_printable(char *text)
{
    while (*text) {
        const size_t length = rheo_printable_length(text);
        if (length == 0)
            *text = *text == '\n' || *text == '\t' ? ' ' : '?';
        text += length ? length : 1;
    }
}

const char *rheo__plural(uint64_t count)
{
    return count == 1 ? "" : "s";
}
