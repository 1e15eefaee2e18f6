/*
 * The operator A = 1 + dt K of viscosity (viscous_operator.c) and its solver (conjugate_gradient.c), within one SIMD
 * variant. Used by stage viscosity and by each other.
 */
#ifndef RHEO__MELTING_VISCOUS_OPERATOR_H
#define RHEO__MELTING_VISCOUS_OPERATOR_H

#include "melting/melting.h"

/* The iterations met a number that is not finite. */
enum { RHEO__UNSOLVABLE = -1 };

/*
 * Prepares A from m->point: the viscous coefficients of pairs, and the blocks of the diagonal in m->cg. Makes
 * Av = A v plus the drag of moving walls.
 */
void RHEO__VARIANT(make_viscous_operator)(rheo__melting *m, const rheo__point *v, rheo__point *Av);
/* Av = A v. walls_move: plus the drag of moving walls, which does not depend on v. */
void RHEO__VARIANT(apply_viscous_operator)(rheo__melting *m, const rheo__point *v, rheo__point *Av, bool walls_move);
/*
 * Solves A x = v* for m->cg.x, with v* in m->velocity. Returns the number of iterations, or RHEO__UNSOLVABLE.
 */
int64_t RHEO__VARIANT(conjugate_gradient)(rheo__state *s, rheo__melting *m);

/*
 * The account (core/account.h) of stage viscosity, which has changed v* to m->cg.x: what A takes from v for each pair and
 * wall (viscous_account.c). Nested, m->stress is that of v.
 */
void rheo__account_viscosity(const rheo__state *s, const rheo__melting *m, const rheo__point *v);

/* a + by b; w becomes 0. */
static inline rheo__point rheo__point_add(rheo__point a, rheo_real by, rheo__point b)
{
    return (rheo__point){a.x + by * b.x, a.y + by * b.y, a.z + by * b.z, 0};
}

#endif
