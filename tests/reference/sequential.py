"""The stages between pairs of scheme sequential (docs/bits.md, Scheme sequential)."""
import numpy as np
from lists import Cells, larger, length2, smaller


class Sweep:
    """
    Pairs closer than the support, and the order in which loops visit them. order: ids by rank. visit: ids in the order of
    the sweeps. row: by id, all partners by rank. later: by id, those of higher rank.
    """

    def __init__(self, position, support, real):
        cells = Cells(position, support * (1 + 1.0 / (1 << 20)))
        self.order = cells.order
        n = len(position)
        self.row, self.later = [None] * n, [None] * n
        for i in range(n):
            near = np.nonzero(length2(position - position[i]) < real(support) * real(support))[0]
            near = near[near != i]
            self.row[i] = near[np.argsort(cells.rank[near], kind='stable')]
            self.later[i] = self.row[i][cells.rank[self.row[i]] > cells.rank[i]]
        x, _, z = cells.cell.T
        self.visit = sorted(self.order, key=lambda i: (x[i] % 3 + 3 * (z[i] % 3), z[i], x[i], cells.rank[i]))

    def pairs(self):
        """All pairs in the order of the rows: (ids of lower ranks, ids of higher ranks)."""
        return (np.array([i for i in self.order for _ in self.later[i]], dtype=int),
                np.concatenate([self.later[i] for i in self.order] + [np.zeros(0, int)]).astype(int))


def viscosity(state, sweep, d, real):
    """Stage viscosity: each pair reads the velocities that the pairs before it have written."""
    step, x = real(d['step']), state.f['position']
    sigma, beta = step * real(d['fluid.linear_viscosity']), step * real(d['fluid.quadratic_viscosity'])
    zero, half = real(0), real(0.5)
    v = [list(row) for row in state.f['velocity']]
    for i in sweep.visit:
        partners = sweep.later[i]
        to = x[partners] - x[i]
        r2 = length2(to)
        r = np.sqrt(r2)
        inverse = np.where(r2 > 0, real(1) / r, zero)
        to, w = to * inverse[:, None], real(1) - r * real(1 / d['fluid.support'])
        vi = v[i]
        for j, n, weight in zip(partners.tolist(), to, w):
            vj, (nx, ny, nz) = v[j], n
            u = ((vi[0] - vj[0]) * nx + (vi[1] - vj[1]) * ny) + (vi[2] - vj[2]) * nz
            if not u > 0:
                continue
            impulse = weight * u * (sigma + beta * u)
            impulse = (impulse if impulse < u else u) * half
            for axis, e in enumerate((nx, ny, nz)):
                loses = e * impulse
                vi[axis], vj[axis] = vi[axis] - loses, vj[axis] + loses
    state.f['velocity'] = np.array(v, dtype=real).reshape(-1, 3)


def springs(state, sweep, d, real):
    """Stage springs: the springs become the pairs; rest lengths flow."""
    old = state.springs()
    a, b = sweep.pairs()
    x = state.f['position']
    r = np.sqrt(length2(x[b] - x[a]))
    keys = [(min(p), max(p)) for p in zip(a.tolist(), b.tolist())]
    length = np.array([old.get(key, -1) for key in keys], dtype=real)
    length = np.where(length < 0, r if d['springs.rest_length'] == 'distance' else real(d['fluid.support']), length)
    tolerated, rate = real(d['springs.yield_ratio']) * length, real(d['step']) * real(d['springs.plasticity'])
    stretched, squeezed = larger(r - length - tolerated, real(0)), larger(length - tolerated - r, real(0))
    length = larger(length + rate * (stretched - squeezed), real(0))
    state.table = dict(zip(keys, length))


def spring_displacement(state, sweep, d, real):
    """Stage spring_displacement: each spring reads the positions that the springs before it have written."""
    step, one, half = real(d['step']), real(1), real(0.5)
    step2, k_min, implicit = step * step, real(d['springs.stiffness']), d['springs.solver'] == 'implicit'
    x = [list(row) for row in state.f['position']]
    total = [real(0)] * len(x)
    for i in sweep.visit:
        partners = sweep.later[i]
        history = np.zeros(len(partners), real)
        if 'derivative' in state.f:
            n = np.sqrt(length2(state.f['derivative'][i] - state.f['derivative'][partners]))
            share = np.where(n > 0, n * (n / (n + real(d['history.onset']))), real(0))
            history = real(d['history.stiffness']) * share
        kappa = step2 * (k_min + history)
        by = half * (kappa / (one + kappa) if implicit else kappa)
        xi = x[i]
        for j, half_kappa, more in zip(partners.tolist(), by, history):
            xj = x[j]
            dx, dy, dz = xj[0] - xi[0], xj[1] - xi[1], xj[2] - xi[2]
            r2 = (dx * dx + dy * dy) + dz * dz
            total[i], total[j] = total[i] + more, total[j] + more
            if not r2 > 0:
                continue
            r = np.sqrt(r2)
            part = half_kappa * (r - state.table[min(i, j), max(i, j)]) / r
            for axis, e in enumerate((dx, dy, dz)):
                moves = e * part
                xi[axis], xj[axis] = xi[axis] + moves, xj[axis] - moves
    state.f['position'] = np.array(x, dtype=real).reshape(-1, 3)
    if state.sticks:
        number = [real(len(row)) for row in sweep.row]
        state.wall_friction = np.array([t / (n * (real(10) * k_min)) if n > 0 and k_min > 0 else real(0)
                                        for t, n in zip(total, number)], dtype=real)


def density(state, sweep, d, real):
    """Stage density: each particle reads the positions that the particles before it have written."""
    from summed import direction
    step, x = real(d['step']), state.f['position'].copy()
    half_step2 = real(0.5) * (step * step)
    k, k_near, rest = real(d['fluid.stiffness']), real(d['fluid.near_stiffness']), real(d['fluid.rest_density'])
    for i in sweep.visit:
        partners = sweep.row[i]
        to = x[partners] - x[i]
        r2 = length2(to)
        r = np.sqrt(r2)
        w = real(1) - r * real(1 / d['fluid.support'])
        w = np.where(w > 0, w, real(0))
        to = to * (real(1) / r)[:, None]
        for k_of_row in np.nonzero(r2 == 0)[0].tolist():
            to[k_of_row] = direction(i, int(partners[k_of_row]), real)
        sum_of_w2 = sum_of_w3 = real(0)
        for weight in w:
            sum_of_w2, sum_of_w3 = sum_of_w2 + weight * weight, sum_of_w3 + weight * weight * weight
        pressure, near = half_step2 * (k * (sum_of_w2 - rest)), half_step2 * (k_near * sum_of_w3)
        loses = (w * (pressure + near * w))[:, None] * to
        x[partners] = x[partners] + loses
        own = x[i].copy()
        for row in loses:
            own = own - row
        x[i] = own
    state.f['position'] = x


def velocity(state, before, d, real):
    """Stage velocity. before: positions at the start of the step."""
    state.f['velocity'] = (state.f['position'] - before) * (real(1) / real(d['step']))
