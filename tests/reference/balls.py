"""Several balls: one by one, and their contact with each other (docs/bits.md, balls)."""
import contextlib
import math

import numpy as np

FIELDS = ('ball_position', 'ball_velocity', 'ball_spin', 'ball_orientation', 'ball_push_phase')


def count(state):
    return len(state.f.get('ball_position', ()))


@contextlib.contextmanager
def one(state, d, k):
    """While it lasts, ball k is the only one of the state, and has the parameters of the first."""
    all_of = {name: state.f[name] for name in FIELDS if name in state.f}
    for name, values in all_of.items():
        state.f[name] = values[k:k + 1].copy()
    d.ball = k
    yield
    d.ball = 0
    for name, values in all_of.items():
        state.f[name] = np.concatenate([values[:k], state.f[name], values[k + 1:]])


def each(state, d):
    """Ball after ball."""
    for k in range(count(state)):
        with one(state, d, k):
            yield k


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


class Partner:
    """A ball in a contact. side: -1 of the first, +1 of the second."""

    def __init__(self, state, d, mass, k, side):
        self.state, self.k, self.side, self.inverse_mass = state, k, side, 1 / float(mass)
        d.ball = k
        self.radius, self.friction = d['ball.radius'], d['ball.friction']
        d.ball = 0

    def of(self, name):
        return self.state.f['ball_' + name][self.k].tolist()

    def surface_velocity(self, n):
        turn = cross(self.of('spin'), [-self.side * self.arm * x for x in n])
        return [v + t for v, t in zip(self.of('velocity'), turn)]

    def push(self, n, impulse, apart, real):
        tau, x, v, w = float(self.state.tau), self.of('position'), self.of('velocity'), self.of('spin')
        turn, by = cross(n, impulse), 2.5 * self.arm / (self.radius * self.radius) * self.inverse_mass
        for axis in range(3):
            change = self.side * self.inverse_mass * impulse[axis]
            self.state.f['ball_velocity'][self.k, axis] = real(v[axis] + change)
            self.state.f['ball_position'][self.k, axis] = real(
                x[axis] + tau * change + self.side * self.inverse_mass * apart * n[axis])
            self.state.f['ball_spin'][self.k, axis] = real(w[axis] - by * turn[axis])


def collide(state, a, b, real):
    tau, reach = float(state.tau), a.radius + b.radius
    n = [x - y for x, y in zip(b.of('position'), a.of('position'))]
    distance = math.sqrt(dot(n, n))
    overlap = reach - distance
    if not overlap > 0:
        return
    n = [x / distance for x in n] if distance > 0 else [0.0, 1.0, 0.0]
    share, mass = distance / reach, 1 / (a.inverse_mass + b.inverse_mass)
    a.arm, b.arm = share * a.radius, share * b.radius
    u = [x - y for x, y in zip(b.surface_velocity(n), a.surface_velocity(n))]
    approach = dot(n, u)
    explained = approach + overlap / tau
    change = (explained if explained < 0 else 0.0) - approach if approach < 0 else 0.0
    left = overlap - tau * change
    rubbing = 0.5 * (a.friction + b.friction) * tau
    slows = rubbing / (1 + rubbing) * mass / (1 + 2.5 * share * share) if change > 0 else 0.0
    impulse = [mass * change * n[axis] - slows * (u[axis] - approach * n[axis]) for axis in range(3)]
    apart = mass * left if left > 0 else 0.0
    a.push(n, impulse, apart, real)
    b.push(n, impulse, apart, real)


def contacts(state, d, masses, real):
    """Stage balls (balls)."""
    for name in ('ball_position', 'ball_velocity', 'ball_spin'):
        state.f[name] = state.f[name].copy()
    for k in range(count(state)):
        for other in range(k + 1, count(state)):
            collide(state, Partner(state, d, masses[k], k, -1.0), Partner(state, d, masses[other], other, 1.0), real)
