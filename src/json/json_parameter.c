/* Writes values of parameters as JSON: numbers and vectors without quotes, words and times with them. */
#include "json/json_parameter.h"

/* Reads "[x, y, z]". The locale of the program may have another decimal separator, so scanf cannot read it. */
static bool read_vector(const char *text, double v[3])
{
    for (size_t i = 0; i < 3; i++) {
        const char *end = NULL;
        text += *text == (i ? ',' : '[');
        text += *text == ' ';
        v[i] = rheo_text_number(text, &end);
        if (end == text)
            return false;
        text = end;
    }
    return *text == ']';
}

void rheo__json_parameter(rheo__json *json, const char *key, const rheo_parameter *parameter, const char *value)
{
    const char *end = NULL;
    const double number = rheo_text_number(value, &end);
    double v[3];
    if (parameter->type == RHEO_PARAMETER_VECTOR && read_vector(value, v))
        rheo__json_vector(json, key, v, 3);
    else if (parameter->type != RHEO_PARAMETER_CHOICE && parameter->type != RHEO_PARAMETER_NAME && end != value &&
             *end == 0)
        rheo__json_number(json, key, number);
    else
        rheo__json_text(json, key, value);
}
