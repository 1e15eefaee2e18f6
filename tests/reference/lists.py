"""Neighbour lists: margins, cells, ranks and rows (docs/bits.md, Neighbours)."""
import math

import balls
import numpy as np

STRAIGHT, MOST, LIFE, SHORTEST, SINGLE, SAMPLES = 0.75, 0.125, 8, 3, 2, 1024
LARGEST_CELL = (1 << 20) - 2


def larger(a, b):
    return np.where(a > b, a, b)


def smaller(a, b):
    return np.where(a < b, a, b)


def length2(v):
    return (v[..., 0] * v[..., 0] + v[..., 1] * v[..., 1]) + v[..., 2] * v[..., 2]


def mean(values, real):
    """Mean of a sample (Margins)."""
    total, count = [0.0] * 3, 0
    for row in values[::1 + len(values) // SAMPLES].tolist():
        total = [t + x for t, x in zip(total, row)]
        count += 1
    return np.array([t / count if count else 0.0 for t in total]).astype(real)


class Needs:
    """What the coming step needs of the margins (Margins)."""

    def __init__(self, state, d, real):
        g, h = d.vector('gravity'), d['fluid.support']
        x, v = state.f['position'], state.f['velocity']
        self.most = real(MOST * h)
        fall = real(d['step'] * math.sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]))
        mean_velocity = mean(v, real)
        self.mean_displacement = mean(x - state.f['list_position'], real)
        speed2 = length2(v - mean_velocity)
        for _ in balls.each(state, d):
            ball2 = length2(state.f['ball_velocity'][0] - mean_velocity)
            near = real(d['ball.radius'] + h) + real(d['step']) * np.sqrt(ball2)
            of_ball = np.where(length2(x - state.f['ball_position'][0]) < near * near, ball2, real(0))
            speed2 = larger(speed2, of_ball)
        self.need = smaller(real(STRAIGHT * d['step']) * (np.sqrt(speed2) + fall), self.most)

    def list_lasts(self, state):
        moved = np.sqrt(length2((state.f['position'] - state.f['list_position']) - self.mean_displacement))
        return bool(np.all(moved + self.need < state.f['list_margin'][:, 0]))

    def margins(self, d, real, vibrators):
        least = real((0.04 if vibrators else 0.025) * d['fluid.support'])
        largest, life = max(self.need.tolist(), default=0.0), real(LIFE)
        largest = real(largest)
        if largest * life > self.most:
            life = real(SINGLE) if largest * real(SHORTEST) > self.most else self.most / largest
        return smaller(larger(life * self.need, least), self.most)


class Cells:
    """The order of cells (Cells and rows, Periodic space)."""

    def __init__(self, position, width, period=None):
        per_length, self.count = zip(*(period.cells(axis, width) if period else (1 / width, 0) for axis in range(3)))
        exact = position.astype(np.float64) * np.array(per_length)
        self.cell = np.clip(np.floor(exact), -LARGEST_CELL, LARGEST_CELL).astype(int)
        for axis, count in enumerate(self.count):
            self.cell[:, axis] = self.cell[:, axis] % count if count else self.cell[:, axis]
        x, y, z = self.cell.T
        self.order = sorted(range(len(position)), key=lambda i: (z[i], x[i], y[i], i))
        self.rank = np.zeros(len(position), int)
        self.rank[self.order] = range(len(position))

    def around(self, i):
        """Along each axis: 0, 1, 2 for cells at the first difference of -1, 0, 1 from that of i that fits; 3 elsewhere."""
        place = np.full(self.cell.shape, 3)
        for axis, count in enumerate(self.count):
            for k in (2, 1, 0):
                at = self.cell[i, axis] + k - 1
                place[self.cell[:, axis] == (at % count if count else at), axis] = k
        return place


class List:
    """
    Row of each particle (Cells and rows): its partners in the order of cells. partner: ids, n x longest; there: entries that are
    used; shift: periods from the partner to the image that is the neighbour.
    """

    def __init__(self, position, margin, support, real, period):
        largest = max(margin.tolist(), default=0.0)
        cells = Cells(position, (support + 2 * largest) * (1 + 1.0 / (1 << 20)), period)
        n = len(position)
        reach = real(support / 2) + margin
        rows, shifts = [], []
        for i in range(n):
            limit = reach + reach[i]
            d, shift = period.nearest(position - position[i])
            near = np.nonzero(length2(d) < limit * limit)[0]
            near = near[near != i]
            if period.any:
                x, y, z = cells.around(i)[near].T
                near = near[np.lexsort((near, y, x, z))]
            else:
                near = near[np.argsort(cells.rank[near], kind='stable')]
            rows.append(near)
            shifts.append(shift[near])
        longest = max(map(len, rows), default=0)
        self.partner, self.there = np.zeros((n, longest), int), np.zeros((n, longest), bool)
        self.shift = np.zeros((n, longest, 3), real)
        for i, row in enumerate(rows):
            self.partner[i, :len(row)], self.there[i, :len(row)] = row, True
            self.shift[i, :len(row)] = shifts[i]
        self.ranks = deal([i for i in cells.order], [len(r) for r in rows])
        self.entry = {(i, j): k for i, row in enumerate(rows) for k, j in enumerate(row.tolist())}


def deal(order, lengths):
    """Ids by rank (Ranks)."""
    ids = []
    for first in range(0, len(order), 256):
        ids += sorted(order[first:first + 256], key=lambda i: -min(lengths[i], 255))
    return ids


def neighbours(state, d, real):
    """Stage neighbours of scheme summed (Neighbours)."""
    needs = Needs(state, d, real)
    lasts = needs.list_lasts(state) and not state.period.have_drifted(needs.mean_displacement)
    if not lasts:
        state.f['position'] = state.period.wrapped(state.f['position'])
        state.f['list_margin'] = needs.margins(d, real, len(state.f.get('vibrator_phase', ()))).reshape(-1, 1)
        state.f['list_position'] = state.f['position'].copy()
    if not lasts or state.list is None:
        state.take_list(List(state.f['list_position'], state.f['list_margin'][:, 0], d['fluid.support'], real, state.period))
