/* Vectors of the writers of files. */
#ifndef RHEO__VIEW_VECTORS_H
#define RHEO__VIEW_VECTORS_H

static inline double rheo__view_dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void rheo__view_cross(const double a[3], const double b[3], double c[3])
{
    for (int k = 0; k < 3; k++)
        c[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

static inline double rheo__view_length(const double a[3])
{
    return __builtin_sqrt(rheo__view_dot(a, a));
}

static inline void rheo__view_normalise(double a[3])
{
    const double length = rheo__view_length(a);
    for (int k = 0; k < 3; k++)
        a[k] /= length;
}

#endif
