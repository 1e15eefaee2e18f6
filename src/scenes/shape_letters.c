/* A text in letters of 5 x 7 dots along x, extruded along z: points in the dots that are set. */
#include <string.h>

#include "core/error.h"
#include "core/strict.h"
#include "scenes/letters.h"
#include "scenes/shape.h"

static const rheo_shape_member members[] = {
    RHEO__MEMBER("text", name, RHEO_SHAPE_TEXT, "", "text of A-Z, 0-9, blanks and . , ! ? - + = : /",
                 .required = true),
    RHEO__MEMBER("height", height, RHEO_SHAPE_NUMBER, "L", "height (y) of a letter", .maximum = 1e30,
                 .above_minimum = true, .required = true),
    RHEO__MEMBER("depth", depth, RHEO_SHAPE_NUMBER, "L", "depth (z) of a letter", .maximum = 1e30,
                 .above_minimum = true, .required = true),
    RHEO__MEMBER("position", position, RHEO_SHAPE_VECTOR, "L", "middle of the underside of its bounding box",
                 RHEO__FINITE),
    RHEO__COMMON_MEMBERS,
};

static rheo_result check(const rheo_fill *fill, rheo_error *error)
{
    return fill->name[0] ? rheo__letters_check(fill->name, error)
                         : rheo__fail(error, RHEO_ERROR_ARGUMENT, "the text is empty");
}

static void measure(const rheo_fill *fill, const void *data, double size[3])
{
    (void)data;
    size[0] = fill->height / RHEO__LETTER_ROWS * (RHEO__LETTER_ADVANCE * (double)strlen(fill->name) - 1);
    size[1] = fill->height;
    size[2] = fill->depth;
}

/* First point at or after the beginning of a dot. Dot 0 begins at `edge`; `width` and `edge` are in points. */
static int64_t first_in_dot(int64_t dot, double width, double edge, int64_t points)
{
    const int64_t first = rheo__round_up((double)dot * width + edge);
    return first < 0 ? 0 : first > points ? points : first;
}

static rheo_result run_rows(const rheo__solid *solid, const rheo__lattice *l, rheo__run *run, void *user,
                            rheo_error *error)
{
    (void)error;
    const char *text = solid->fill->name;
    double size[3];
    measure(solid->fill, NULL, size);
    const double dot = size[1] / solid->spacing / RHEO__LETTER_ROWS;
    const double left = 0.5 * ((double)l->high[0] - size[0] / solid->spacing);
    const int64_t columns = RHEO__LETTER_ADVANCE * (int64_t)strlen(text);
    uint8_t dots[RHEO__LETTER_ROWS][RHEO__LETTER_ADVANCE * sizeof((rheo_fill *)0)->name];
    for (size_t row = 0; row < RHEO__LETTER_ROWS; row++)
        rheo__letters_row(text, row, dots[row]);
    for (int64_t z = 0; z <= l->high[2]; z++)
        for (int64_t row = 0, y = 0; row < RHEO__LETTER_ROWS; row++)
            for (int64_t end = first_in_dot(row + 1, dot, -0.5, l->high[1] + 1); y < end; y++)
                for (int64_t column = 0, last; column < columns; column = last + 1) {
                    for (last = column; dots[row][last]; last++) /* the last column of a letter is free */
                        ;
                    if (last == column)
                        continue;
                    const int64_t x = first_in_dot(column, dot, left, l->high[0] + 1);
                    const int64_t x_end = first_in_dot(last, dot, left, l->high[0] + 1);
                    if (x < x_end && !run(user, x, x_end, y, z))
                        return RHEO_OK;
                }
    return RHEO_OK;
}

const rheo__shape rheo__shape_letters = {
    .row = RHEO__ROW("letters", "a text in block letters along x, extruded along z", members),
    .max_points = 65536, /* rows are counted one by one */
    .check = check,
    .measure = measure,
    .lattice = rheo__lattice_on_underside,
    .run = run_rows,
};
