"""The share of the ball in sums of particles near it, and its mass (docs/bits.md, Wetting)."""
import balls
import numpy as np
from lists import larger, length2

PI = 3.14159265358979323846
NODES = 65
INTERVALS = 64


def sums_at(nu):
    """The factors of P (wetting, Table)."""
    u = nu - 7
    return 2.248 + 0.381 * u, 0.8761 + 0.1917 * u, 4.3 + 0.596 * u, 1.372 + 0.1894 * u


def pressure_at(d, nu):
    ww, www, wr, wwr = sums_at(nu)
    return d['fluid.support'] / 6 * (d['fluid.stiffness'] * (ww - d['fluid.rest_density']) * wr +
                                     d['fluid.near_stiffness'] * www * wwr)


def number_density(d):
    h, spacing, low, high = d['fluid.support'], d['fluid.spacing'], 4.0, 10.0
    if d['fluid.number_density'] > 0:
        return d['fluid.number_density']
    positive = d['fluid.stiffness'] > 0 and d['fluid.near_stiffness'] > 0 and d['fluid.rest_density'] > 0
    if not (positive and pressure_at(d, low) < 0 < pressure_at(d, high)):
        return 1 / (spacing * spacing * spacing)
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if pressure_at(d, middle) < 0 else (low, middle)
    return high / (h * h * h)


def ball_mass(d):
    radius = d['ball.radius']
    return d['ball.density_ratio'] * (4.0 / 3.0 * PI * radius * radius * radius) * number_density(d)


def integrate(distance, radius, h):
    """A, A', B and B' of a particle at a distance from the surface of the ball (wetting, Table)."""
    to_centre, step = radius + distance, (h - distance) / INTERVALS
    total = [0.0] * 4
    for i in range(INTERVALS + 1):
        r = distance + i * step
        w = 1 - r / h
        simpson = (1 if i in (0, INTERVALS) else 4 if i % 2 else 2) * step / 3
        c = (to_centre * to_centre + r * r - radius * radius) / (2 * to_centre * r) if r > 0 else 0.0
        c = min(max(c, -1.0), 1.0)
        cap, along = simpson * 2 * PI * r * r * (1 - c), simpson * PI * r * r * (1 - c * c)
        total = [total[0] + w * w * cap, total[1] + w * w * w * cap, total[2] + w * along, total[3] + w * w * along]
    return total


class Wet:
    """A particle near a ball."""

    def __init__(self, i, ball, normal, integrals):
        self.id, self.ball, self.normal = i, ball, normal
        self.density, self.near_density, self.push, self.near_push = integrals


class Wetting:
    def __init__(self, state, d, real, masses):
        self.d, self.real, self.masses = d, real, [float(real(mass)) for mass in masses]
        n, h = real(number_density(d)), d['fluid.support']
        self.tables = [[[n * real(x) for x in integrate(node * h / (NODES - 1), d['ball.radius'], h)] for node in range(NODES)]
                       for _ in balls.each(state, d)]

    def look_up(self, distance):
        real, table = self.real, self.tables[self.d.ball]
        at = larger(distance, real(0)) * real((NODES - 1) / self.d['fluid.support'])
        node = min(int(at), NODES - 2)
        b = at - real(node)
        a = real(1) - b
        return [a * low + b * high for low, high in zip(table[node], table[node + 1])]

    def find(self, state):
        """The wet particles of ball after ball, by rank (wetting, Wet)."""
        real, found = self.real, []
        for k in balls.each(state, self.d):
            reach = real(self.d['ball.radius']) + real(self.d['fluid.support'])
            d = state.f['position'] - state.f['ball_position'][0]
            r2 = length2(d)
            for i in state.list.ranks:
                if r2[i] < reach * reach and r2[i] > 0:
                    r = np.sqrt(r2[i])
                    found.append(Wet(i, k, d[i] / r, self.look_up(r - real(self.d['ball.radius']))))
        return found

    def push(self, state, acceleration):
        """Adds the pushes of the balls, which take the opposite ones (wetting, Push)."""
        real, totals, tau = self.real, [[0.0] * 3 for _ in self.masses], float(state.tau)
        for wet in state.wet:
            push = real(2) * (state.pressure[wet.id] * wet.push + state.near_pressure[wet.id] * wet.near_push)
            by = push * wet.normal
            acceleration[wet.id] = acceleration[wet.id] + by
            totals[wet.ball] = [t + x for t, x in zip(totals[wet.ball], by.tolist())]
        by = [tau / mass for mass in self.masses]
        v, x = state.f['ball_velocity'], state.f['ball_position']
        state.f['ball_velocity'] = v - np.array([[b * t for t in total] for b, total in zip(by, totals)]).astype(real)
        state.f['ball_position'] = x - np.array([[tau * b * t for t in total] for b, total in zip(by, totals)]).astype(real)
