/*
 * Weights of the history term from a curve w(age) (docs/model.md, Curves): D x = integral of w(a) v(a) da.
 *
 * The rule is that of the paper's weights, the product trapezoidal rule: the velocity is linear between samples, and its
 * product with w is integrated exactly. So sample m has the weight
 *
 *     W_m = integral of w(a) h(a/step - m) da,    h(x) = max(1 - |x|, 0)
 *
 * w is linear between its points, so the integrand is a quadratic function between neighbours of the joint set of points
 * and samples. Its integral over a piece of length l is l/6 (2 w_a h_a + w_a h_b + w_b h_a + 2 w_b h_b).
 */
#include "thickening/weights.h"

#include <float.h>

#include "core/error.h"
#include "core/strict.h"
#include "core/text.h"

#define MOST_STEPS 1e6
#define LARGEST 1e12

uint32_t rheo_history_curve_window(const rheo_curve_point *curve, size_t points, double step)
{
    if (!curve || points < 2 || !(step > 0 && step <= DBL_MAX))
        return 0;
    const double exact = curve[points - 1].age / step;
    if (!(exact > 0 && exact <= MOST_STEPS))
        return 0;
    const uint32_t whole = (uint32_t)exact;
    /* An age that is a whole number of steps may be rounded up. */
    return exact - whole > 1e-9 * exact || whole == 0 ? whole + 1 : whole;
}

/* Adds the integrals over a piece that lies between the samples k and k + 1. */
static void add_piece(double from, double to, double w_from, double w_to, double step, size_t k, size_t count,
                      double *weight, double *first)
{
    const double x_from = from / step - (double)k, x_to = to / step - (double)k, sixth = (to - from) / 6;
    const double younger =
        sixth * (2 * (w_from * (1 - x_from)) + w_from * (1 - x_to) + w_to * (1 - x_from) + 2 * (w_to * (1 - x_to)));
    const double older = sixth * (2 * (w_from * x_from) + w_from * x_to + w_to * x_from + 2 * (w_to * x_to));
    if (k < count)
        weight[k] += younger;
    if (k + 1 < count) {
        weight[k + 1] += older;
        if (first)
            first[k + 1] += older;
    }
}

rheo_result rheo_history_curve_weights(const rheo_curve_point *curve, size_t points, double step, size_t count,
                                       double *weight, double *first)
{
    rheo_error ignored;
    if ((count && !weight) || rheo__curve_check(curve, points, step, &ignored) != RHEO_OK)
        return RHEO_ERROR_ARGUMENT;
    for (size_t m = 0; m < count; m++) {
        weight[m] = 0;
        if (first)
            first[m] = 0;
    }
    for (size_t i = 0; i + 1 < points; i++) {
        const rheo_curve_point p = curve[i], q = curve[i + 1];
        const double length = q.age - p.age;
        double from = p.age, w_from = p.weight;
        for (size_t k = (size_t)(p.age / step); k < count && from < q.age; k++) {
            const double end = (double)(k + 1) * step, to = end < q.age ? end : q.age;
            const double w_to = to < q.age ? p.weight + (q.weight - p.weight) * ((to - p.age) / length) : q.weight;
            if (!(to > from)) /* age/step was rounded down to k */
                continue;
            add_piece(from, to, w_from, w_to, step, k, count, weight, first);
            from = to;
            w_from = w_to;
        }
    }
    if (first && count)
        first[0] = weight[0];
    return RHEO_OK;
}

rheo_result rheo__curve_check_point(const rheo_curve_point *curve, size_t index, rheo_error *error)
{
    const rheo_curve_point p = curve[index];
    char age[32], other[32];
    rheo__text_from_double(p.age, age);
    if (!(p.age >= 0 && p.age <= LARGEST))
        return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                          "the age of point %zu of history.curve is %s; it must be a number from 0 to 1e12", index,
                          age);
    rheo__text_from_double(p.weight, other);
    if (!(p.weight >= -LARGEST && p.weight <= LARGEST))
        return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                          "the weight of point %zu of history.curve is %s; it must be a number from -1e12 to 1e12",
                          index, other);
    if (!index || p.age > curve[index - 1].age)
        return RHEO_OK;
    rheo__text_from_double(curve[index - 1].age, other);
    return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                      "the ages of points %zu and %zu of history.curve are %s and %s; ages must ascend", index - 1,
                      index, other, age);
}

rheo_result rheo__curve_check(const rheo_curve_point *curve, size_t points, double step, rheo_error *error)
{
    if (points < 2 || points > RHEO_MAX_CURVE_POINTS)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "history.curve has %zu point%s; it must have from 2 to %d",
                          points, points == 1 ? "" : "s", RHEO_MAX_CURVE_POINTS);
    if (!curve)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "history.curve is NULL; it must hold %zu points", points);
    for (size_t i = 0; i < points; i++)
        RHEO__TRY(rheo__curve_check_point(curve, i, error));
    if (rheo_history_curve_window(curve, points, step))
        return RHEO_OK;
    char age[32], length[32];
    rheo__text_from_double(curve[points - 1].age, age);
    rheo__text_from_double(step, length);
    return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                      "history.curve ends at the age %s; it must end within 1000000 steps of %s", age, length);
}
