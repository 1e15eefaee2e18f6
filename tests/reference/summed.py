"""The stages between pairs of scheme summed (docs/bits.md, Scheme summed)."""
import numpy as np
from history import length_derivatives
from lists import larger, length2, smaller


def sum_rows(terms):
    """Sums of all rows (Pairs): partners ascending, from 0. terms: n x longest, 0 where there is no partner."""
    total = np.zeros_like(terms[:, 0]) if terms.shape[1] else np.zeros(terms.shape[:1] + terms.shape[2:], terms.dtype)
    for k in range(terms.shape[1]):
        total = total + terms[:, k]
    return total


def least_distance2(d):
    """Square of the distance of pairs without direction (Pairs)."""
    return max(6.25e-22 * (d['fluid.support'] * d['fluid.support']), 1e-36)


class Pairs:
    """d, r and 1/r of all entries at the present positions (Pairs)."""

    def __init__(self, state, real, least=None):
        l, x = state.list, state.period.rounded(state.f['position'])
        self.partner, self.there = l.partner, l.there
        self.d = np.where(l.there[..., None], (x[l.partner] + l.shift * state.period.length) - x[:, None], real(2e18))
        self.r2 = length2(self.d)
        if least is not None:
            self.r2 = larger(self.r2, real(least))
        self.r = np.sqrt(self.r2)

    def weight(self, d, real):
        return np.where(self.there, larger(real(1) - self.r * real(1 / d['fluid.support']), real(0)), real(0))

    def inverse(self, real):
        return self.r * (real(1) / self.r2)


def of_particles(path, state, d, real):
    """A parameter of the material of each particle (Materials); one number without materials."""
    if 'material' not in state.f:
        return real(d[path])
    return np.array(d.of_materials(path)).astype(real)[state.f['material'][:, 0]]


def of_pairs(own, state, pairs, real):
    """A parameter of the spring of each pair (Materials). own: of_particles()."""
    return real(0.5) * (own[:, None] + own[pairs.partner]) if 'material' in state.f else own


def differences(derivative, pairs):
    """N of vectors (viscosity and stiffness)."""
    return np.sqrt(length2(derivative[:, None] - derivative[pairs.partner]))


def history_stiffness(n, state, pairs, d, real):
    """H (viscosity and stiffness)."""
    k_hist, onset = (of_pairs(of_particles(path, state, d, real), state, pairs, real)
                     for path in ('history.stiffness', 'history.onset'))
    share = np.where(n > 0, n / (n + onset), real(0))
    return k_hist * (n * share)


def stiffness(state, pairs, d, real, before, memory):
    """K, S and F (viscosity and stiffness). before: D^q x of the step before."""
    own = of_particles('springs.stiffness', state, d, real)
    k_min = of_pairs(own, state, pairs, real)
    history = np.zeros_like(pairs.r)
    if memory:
        n = length_derivatives(state, memory, pairs) if memory.of_lengths else differences(state.f['derivative'], pairs)
        history = history_stiffness(n, state, pairs, d, real)
    k = k_min + history
    rest = state.rest
    if memory and d['history.hardening'] == 'passive':
        earlier = k_min + history_stiffness(differences(before, pairs), state, pairs, d, real)
        kept = larger(pairs.r - earlier / k * (pairs.r - rest), real(0))
        rest = np.where((rest > -1) & (earlier < k), kept, rest)
        state.rest = rest
    spring = pairs.there & (rest > -1)
    state.k = k
    state.stiffness_sum = sum_rows(np.where(spring | (pairs.there & (pairs.r < real(d['fluid.support']))), k, real(0)))
    number, total = sum_rows(spring.astype(real)), sum_rows(np.where(spring, history, real(0)))
    scale = number * (real(10) * own)
    state.wall_friction = np.where(scale > 0, total / scale, real(0))


def viscosity(state, d, real, before, memory):
    """Stages viscosity and stiffness (viscosity and stiffness)."""
    pairs = Pairs(state, real, least_distance2(d))
    if state.has_springs:
        stiffness(state, pairs, d, real, before, memory)
    if not (d['fluid.linear_viscosity'] > 0 or d['fluid.quadratic_viscosity'] > 0):
        return
    step, v = real(d['step']), state.f['velocity']
    a, b = step * real(d['fluid.linear_viscosity']), step * real(d['fluid.quadratic_viscosity'])
    relative = v[:, None] - v[pairs.partner]
    inverse, w = pairs.inverse(real), pairs.weight(d, real)
    dot = (relative[..., 0] * pairs.d[..., 0] + relative[..., 1] * pairs.d[..., 1]) + relative[..., 2] * pairs.d[..., 2]
    u = larger(dot * inverse, real(0))
    share = w * (a + b * u)
    by = (share * u) * inverse
    total = sum_rows(np.where((u > 0) & pairs.there, share, real(0)))
    if np.any(total > 1):
        bound = larger(total, real(1))
        by = by / larger(bound[:, None], bound[pairs.partner])
    by = np.where(pairs.there, by, real(0))
    state.f['velocity'] = v - real(0.5) * sum_rows(by[..., None] * pairs.d)


def substeps(state, d, real):
    """Stage substeps (substeps)."""
    stiffest = real(max(state.stiffness_sum.tolist(), default=0.0)) if state.has_springs else real(0)
    count = int(d['substeps'])
    if count == 0:
        speed2 = real(max(length2(state.f['velocity']).tolist(), default=0.0))
        for v in state.f.get('ball_velocity', ()):
            speed2 = larger(speed2, length2(v))
        count = needed(d, float(stiffest), float(speed2))
    state.f['substeps'] = np.array([[count]], dtype='<u8')
    state.tau = real(d['step'] / count)
    if not state.has_springs:
        return
    step2 = state.tau * state.tau
    if step2 * larger(stiffest, real(max(d.of_materials('springs.stiffness')))) > real(2):
        soften(state, real(2) / step2)


def needed(d, stiffest, speed2):
    """m (substeps)."""
    h, step2 = d['fluid.support'], d['step'] * d['step']
    squared = max(step2 * stiffest / 2.0, step2 * speed2 / (0.25 * 0.25 * h * h),
                  step2 * d['fluid.stiffness'] / (h * (0.75 * 0.06)), step2 * d['fluid.near_stiffness'] / (h * (0.75 * 0.1)))
    count, most = 2, int(d['max_substeps'])
    while count < most and float(count * count) < squared:
        count += 1
    return min(count, most)


def soften(state, bound):
    """Softened springs (substeps)."""
    s, l = state.stiffness_sum, state.list
    most = larger(larger(s[:, None], s[l.partner]), state.k)
    state.k = np.where(most > bound, state.k * (bound / most), state.k)


def densities(state, d, real, wetting):
    """Stage densities (densities)."""
    pairs = Pairs(state, real)
    w = pairs.weight(d, real)
    w2 = w * w
    density, near = sum_rows(w2), sum_rows(w2 * w)
    state.coinciding = pairs.there & (pairs.r2 == 0)
    if state.has_springs:
        flow(state, pairs, w, d, real)
    k, k_near = real(0.5 * d['fluid.stiffness']), real(0.5 * d['fluid.near_stiffness'])
    rest, least = real(d['fluid.rest_density']), real(-0.5 * d['fluid.cohesion'] * d['fluid.stiffness'])
    state.pressure, state.near_pressure = larger(k * (density - rest), least), k_near * near
    state.wet = wetting.find(state) if wetting else []
    for wet in state.wet:
        i = wet.id
        density[i] = density[i] + wet.density
        state.pressure[i] = larger(k * (density[i] - rest), least)
        state.near_pressure[i] = state.near_pressure[i] + k_near * wet.near_density


def flow(state, pairs, w, d, real):
    """Springs are born, flow and vanish (densities)."""
    born = pairs.r if d['springs.rest_length'] == 'distance' else real(d['fluid.support'])
    length = np.where(state.rest < 0, born, state.rest)
    gamma = of_pairs(of_particles('springs.yield_ratio', state, d, real), state, pairs, real)
    rate = of_pairs(state.tau * of_particles('springs.plasticity', state, d, real), state, pairs, real)
    tolerated, stretch = gamma * length, pairs.r - length
    stays = larger(smaller(stretch, tolerated), -tolerated)
    length = larger(length + rate * (stretch - stays), real(0))
    state.rest = np.where(w > 0, length, real(-1))


def forces(state, d, real, wetting):
    """Stage forces (forces)."""
    pairs = Pairs(state, real, least_distance2(d))
    inverse = pairs.inverse(real)
    zero = np.zeros_like(state.f['position'])
    by_springs, by_pressure = zero, zero
    with_pressure = d['fluid.stiffness'] > 0 or d['fluid.near_stiffness'] > 0
    if with_pressure or not state.has_springs:
        w, p, n = pairs.weight(d, real), state.pressure, state.near_pressure
        push = w * ((p[:, None] + p[pairs.partner]) + w * (n[:, None] + n[pairs.partner]))
        by = np.where(pairs.there, push * inverse, real(0))
        by_pressure = sum_rows(-(by[..., None] * pairs.d))
    if state.has_springs:
        pull = np.where(pairs.there & (state.rest >= 0), state.k * (state.rest - pairs.r) * inverse, real(0))
        by_springs = real(0.5) * sum_rows(-(pull[..., None] * pairs.d))
    if np.any(state.coinciding):
        part(state, by_pressure, real)
    if wetting and with_pressure:
        wetting.push(state, by_pressure)
    a = by_springs + by_pressure
    state.f['velocity'] = state.f['velocity'] + state.tau * a
    state.f['position'] = state.f['position'] + (state.tau * state.tau) * a


def part(state, by_pressure, real):
    """Coinciding particles (forces): by rank of the first, then in the order of its row; each pair at its lower rank."""
    l = state.list
    rank = {i: r for r, i in enumerate(l.ranks)}
    for i in l.ranks:
        for k in np.nonzero(state.coinciding[i])[0].tolist():
            j = int(l.partner[i, k])
            if rank[j] <= rank[i]:
                continue
            p, n = state.pressure, state.near_pressure
            push = (p[i] + p[j]) + (n[i] + n[j])
            step = push * direction(i, j, real)
            by_pressure[i] = by_pressure[i] - step
            by_pressure[j] = by_pressure[j] + step


def direction(a, b, real):
    """Direction from a to b of coinciding particles (forces)."""
    mixed = (min(a, b) * 0x9E3779B1 ^ max(a, b) * 0x85EBCA77) & 0xFFFFFFFF
    v = np.array([mixed >> (29 - 3 * axis) & 7 for axis in range(3)]).astype(real) - real(3.5)
    return v * (real(1 if a < b else -1) / np.sqrt(length2(v)))
