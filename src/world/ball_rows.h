/* Rows of the parameters of a ball, those of the first and those of a further one (world/row_macros.h). */
#ifndef RHEO__WORLD_BALL_ROWS_H
#define RHEO__WORLD_BALL_ROWS_H

#include "world/row_macros.h"

/* REAL_OF, VECTOR_OF(ball, member of rheo_ball, unit, range, default, LIVE or FIXED, meaning) */
#define RHEO__BALL_ROWS(REAL_OF, VECTOR_OF, ball)                                                                  \
    REAL_OF(ball, radius, "L", RANGE(0, 1e12), 0, FIXED,                                                           \
            "R; 0: no ball. Further balls have the same parameters: ball2.radius, ball3.radius, ...")              \
    REAL_OF(ball, density_ratio, "1", AT_LEAST(1e-6), 2, LIVE, "density of the ball divided by that of the fluid") \
    VECTOR_OF(ball, position, "L", ANY, XYZ(0, 0, 0), LIVE, "centre at step 0")                                    \
    VECTOR_OF(ball, velocity, "L/T", ANY, XYZ(0, 0, 0), LIVE, "velocity at step 0")                                \
    VECTOR_OF(ball, spin, "1/T", ANY, XYZ(0, 0, 0), LIVE, "angular velocity at step 0")                            \
    REAL_OF(ball, friction, "1/T", AT_LEAST(0), 25, LIVE, "mu, rate at which contact stops sliding")               \
    VECTOR_OF(ball, push, "L/T^2", ANY, XYZ(0, 0, 0), LIVE,                                                        \
              "periodic push: its mean acceleration; 0 at the start: none")                                        \
    REAL_OF(ball, push_frequency, "1/T", RANGE(TINY, 1e12), 1, LIVE,                                               \
            "pushes in a unit of time; the first begins at step 0")                                                \
    REAL_OF(ball, push_duty, "1", RANGE(1e-6, 1), 0.5, LIVE,                                                       \
            "share of a period in which the ball is pushed, as half a sine")

#define FIRST_BALL_REAL(ball, member, unit, range, initial, live, meaning) \
    {{HEAD("ball." #member, REAL, unit, live, meaning), range}, OFFSET(ball.member, double), 0, {initial}},
#define FIRST_BALL_VECTOR(ball, member, unit, range, initial, live, meaning) \
    {{HEAD("ball." #member, VECTOR, unit, live, meaning), range}, OFFSET(ball.member, double *), 0, {initial}},

#endif
