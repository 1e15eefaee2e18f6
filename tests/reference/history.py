"""Weights and modes of the memory, D^q x, and what a step adds (docs/bits.md, Memory)."""
import functions as f
import numpy as np
from lists import length2


def interior_weight(q, lag):
    """c_m of `paper` (Weights)."""
    if lag == 0:
        return 1.0
    if lag == 1:
        y, total = (1.0 - q) * f.LOG_2[0], 1.0
        for k in range(20, 1, -1):
            total = 1.0 + y / k * total
        return 2.0 * (y * total)
    m, total = float(lag), 1.0
    x = 1.0 / (m * m)
    for k in range(39 if lag < 6 else 11, 0, -1):
        total = 1.0 + (2 * k - 2 + q) * (2 * k - 1 + q) / ((2 * k + 1) * (2 * k + 2)) * x * total
    return (2.0 - q) * (1.0 - q) * f.power(m, -q) * total


def l1_weight(q, lag):
    """c_m of `l1` (Weights)."""
    if lag == 0:
        return 1.0
    m, total = float(lag), 1.0
    x = 1.0 / ((2.0 * m + 1.0) * (2.0 * m + 1.0))
    for k in range(39 if lag < 6 else 17, 0, -2):
        total = 1.0 + (k - 1 + q) * (k + q) / ((k + 1) * (k + 2)) * x * total
    return (1.0 - q) * f.power(m + 0.5, -q) * total


def first_weight(q, n):
    """f_n: weight of the very first sample, n steps later (Weights)."""
    if n == 0:
        return 1.0
    if n == 1:
        return 1.0 - q
    x, total = 1.0 / float(n), 1.0
    for k in range(57 if n < 4 else 29 if n < 16 else 17, 1, -1):
        total = 1.0 + (k - 2 + q) / (k + 1) * x * total
    return 0.5 * (2.0 - q) * (1.0 - q) * f.power(float(n), -q) * total


def weight(q, lag, kind):
    return interior_weight(q, lag) if kind == 'paper' else l1_weight(q, lag)


def scale(q, step, kind):
    """C (Weights)."""
    return f.power(step, 1.0 - q) / f.gamma((3.0 if kind == 'paper' else 2.0) - q)


def curve_weights(curve, step, count):
    """W_m of a curve and the weights of the very first sample (Weights)."""
    weights, first = [0.0] * count, [0.0] * count
    for (age, w), (next_age, next_w) in zip(curve, curve[1:]):
        start, w_start, k = age, w, int(age / step)
        while k < count and start < next_age:
            end = min(float(k + 1) * step, next_age)
            w_end = next_w if end == next_age else w + (next_w - w) * ((end - age) / (next_age - age))
            if end > start:
                x, y, l = start / step - k, end / step - k, (end - start) / 6
                weights[k] += l * (2 * (w_start * (1 - x)) + w_start * (1 - y) + w_end * (1 - x) + 2 * (w_end * (1 - y)))
                if k + 1 < count:
                    older = l * (2 * (w_start * x) + w_start * y + w_end * x + 2 * (w_end * y))
                    weights[k + 1] += older
                    first[k + 1] += older
                start, w_start = end, w_end
            k += 1
    first[0] = weights[0]
    return weights, first


def lags_of_fit(lags):
    """Lags of the fit (Fit of the modes, 2)."""
    lag = 1
    while lag <= lags:
        yield lag
        following = lag + 1 + lag // 50
        lag = lags if lag < lags < following else following


class Modes:
    """Rates and weights of the modes, slowest first (docs/bits.md, Fit of the modes)."""

    def __init__(self, definition, window):
        q, self.kind, weights = definition['history.order'], definition['history.kind'], definition['history.weights']
        lags, tau = (16384 if self.kind == 'full' else window), 0.0
        if self.kind == 'tempered':
            tau = window / f.power(f.gamma(2 - q), 1 / (1 - q))
            lags = int(12 * tau) + 1
        self.choose_rates(lags)
        self.fit(q, lags, weights)
        self.first = [first_share(r) if weights == 'paper' else 1.0 for r in self.rate]
        if self.kind == 'tempered':
            more = 1 / tau
            share = f.exp(-more)
            self.rate = [r + more for r in self.rate]
            self.weight = [w * share for w in self.weight]
        self.count = len(self.rate)

    def choose_rates(self, lags):
        """Rates (Fit of the modes, 1)."""
        slowest = 0.2 / lags
        span = 4.0 / slowest
        count, reach = 2, 3.0
        while reach < span:
            count, reach = count + 1, reach * 3.0
        count = min(count, lags)
        ratio = f.power(span, 1.0 / (count - 1)) if count > 1 else 1.0
        self.rate = [slowest]
        for _ in range(1, count):
            self.rate.append(self.rate[-1] * ratio)

    def fit(self, q, lags, weights):
        """Weights (Fit of the modes, 3 to 5)."""
        count = len(self.rate)
        triangle = [[0.0] * (count + 1) for _ in range(count)]
        for lag in lags_of_fit(lags):
            inverse = 1 / weight(q, lag, weights)
            row = [f.exp(-r * (lag - 1)) * inverse for r in self.rate] + [1.0]
            rotate_in(triangle, row, count)
        self.weight = [0.0] * count
        for k in range(count - 1, -1, -1):
            total = triangle[k][count]
            for j in range(k + 1, count):
                total -= triangle[k][j] * self.weight[j]
            self.weight[k] = total / triangle[k][k]

    def constants(self, real, window):
        """Rounded constants of a step, by mode: g, w, first, leaving, filling; and the number of slow modes."""
        decay = [1 - f.exp(-r) for r in self.rate]
        self.slow = 0
        while real is np.float32 and self.slow < self.count and decay[self.slow] < 2.5e-4:
            self.slow += 1
        self.decay = [real(d) for d in decay]
        self.rounded_weight = [real(w) for w in self.weight]
        self.rounded_first = [real(a) for a in self.first]
        self.leaving = [real(-f.exp(-r * window)) for r in self.rate]
        self.filling = [real((1 - a) * f.exp(-r * (window - 1.0))) for a, r in zip(self.first, self.rate)]


def rotate_in(triangle, row, count):
    """Rotations (Fit of the modes, 4)."""
    for k in range(count):
        if row[k] == 0:
            continue
        length = f.math.sqrt(triangle[k][k] * triangle[k][k] + row[k] * row[k])
        c, s = triangle[k][k] / length, row[k] / length
        for j in range(k, count + 1):
            above = triangle[k][j]
            triangle[k][j] = c * above + s * row[j]
            row[j] = c * row[j] - s * above


def first_share(rate):
    """a of a mode (Fit of the modes, 6)."""
    x, sinh_sum, cosh_sum = rate * rate, 1.0, 1.0
    for k in range(24, 0, -1):
        sinh_sum = 1 + x / ((2 * k + 2) * (2 * k + 3)) * sinh_sum
        cosh_sum = 1 + x / ((2 * k + 1) * (2 * k + 2)) * cosh_sum
    return 0.5 + rate * sinh_sum / (6 * cosh_sum)


def next_sample(lag, last):
    """The sampled lag after this one (Lengths)."""
    return min(lag + 1 + lag // 4, last)


class Memory:
    """Constants of a definition in force."""

    def __init__(self, definition, real):
        self.real, self.window = real, int(definition.vector('history.window')[0])
        q, kind = definition['history.order'], definition['history.weights']
        self.kind, self.lag = definition['history.kind'], int(definition.vector('history.lag')[0])
        self.of_lengths = definition['history.of'] == 'length'
        self.scale = real(scale(q, definition['step'], kind))
        curve = definition.values.get('history.curve')
        if self.of_lengths:
            self.make_samples(definition, curve)
        elif curve:
            self.scale = real(1)
            weights, first = curve_weights(curve, definition['step'], self.window + 1)
            self.weight = [real(w) for w in weights]
            self.oldest = [real(w) for w in first[:-1]] + self.weight[-1:]
        elif self.kind == 'window':
            self.weight = [real(weight(q, m, kind)) for m in range(self.window + 1)]
            self.oldest = [real(first_weight(q, m)) if kind == 'paper' and m < self.window else self.weight[m]
                           for m in range(self.window + 1)]
        else:
            self.modes = Modes(definition, self.window)
            self.modes.constants(real, self.window)

    def make_samples(self, definition, curve):
        """Lags m_k and weights u_k (Lengths)."""
        q, kind, step = definition['history.order'], definition['history.weights'], definition['step']
        rates, factor = self.window + 1, 1.0 if curve else scale(q, step, kind)
        exact = curve_weights(curve, step, rates)[0] if curve else [weight(q, m, kind) for m in range(rates)]
        self.sample, self.sample_weight = [0], []
        while self.sample[-1] < rates:
            lag, total = self.sample[-1], 0.0
            following = next_sample(lag, rates)
            for k in range(lag, following):
                total += exact[k]
            self.sample_weight.append(self.real(factor * (total / (following - lag)) / step))
            self.sample.append(following)

    def has_window(self):
        return self.kind in ('window', 'window-fast')

    def has_ring(self):
        return self.has_window() or self.lag > 0

    def ring_rows(self):
        return self.lag + (self.window + 1 if self.has_window() else 2) + self.of_lengths

    def old(self, rows):
        """How many of `rows` rows, or of the steps between them, count."""
        return max(rows - self.of_lengths - self.lag, 0)

    def mode_row(self, k):
        """Row of mode k in the field; row count + k has its rest, if it is slow."""
        return k + (not self.has_ring())


def newest(state, memory):
    """The newest velocity that counts."""
    return state.f['history_velocity'][memory.lag] if memory.has_ring() else state.f['history_modes'][0]


def fractional_derivative(state, memory):
    """Stage fractional_derivative (fractional_derivative)."""
    rows, real = memory.old(int(state.f['history_rows'][0, 0])), memory.real
    total = np.zeros_like(state.f['position'])
    if rows and memory.kind == 'window':
        for lag in range(rows - 1, -1, -1):
            w = memory.oldest[lag] if lag == rows - 1 else memory.weight[lag]
            total = total + w * state.f['history_velocity'][memory.lag + lag]
        total = total * memory.scale
    elif rows:
        for k in range(memory.modes.count):
            total = total + memory.modes.rounded_weight[k] * state.f['history_modes'][memory.mode_row(k)]
        total = memory.scale * (newest(state, memory) + total)
    state.f['derivative'] = total
    assert total.dtype == real


def length_derivatives(state, memory, pairs):
    """|D^q l| of every pair (Lengths)."""
    steps, total = memory.old(int(state.f['history_rows'][0, 0])), np.zeros_like(pairs.r)
    if steps == 0:
        return total
    used = next((k for k, lag in enumerate(memory.sample) if lag >= steps), len(memory.sample) - 1)
    before = None
    for k in range(used, -1, -1):
        x = state.f['history_position'][memory.lag + min(memory.sample[k], steps)]
        now = np.sqrt(length2(x[pairs.partner] - x[:, None]))
        if before is not None:
            total = total + memory.sample_weight[k] * (now - before)
        before = now
    return np.abs(total)


def settle(y, real):
    tiny = real(1e-30)
    return np.where((y >= tiny) | (y <= -tiny), y, real(0))


def update_modes(state, memory, rows):
    """The newest velocity that counted enters the modes (history). rows: those that count."""
    modes, real, window, lag = memory.modes, memory.real, memory.window, memory.lag
    v, y, far = newest(state, memory), state.f['history_modes'], None
    if memory.has_window() and rows > window:
        far, by = state.f['history_velocity'][lag + window], modes.leaving
    elif memory.has_window() and rows == window:
        far, by = state.f['history_velocity'][lag + window - 1], modes.filling
    for k in range(modes.count):
        at, g = memory.mode_row(k), modes.decay[k]
        enters = (modes.rounded_first[k] if rows == 1 else real(1)) * v
        if far is not None:
            enters = enters + by[k] * far
        if k >= modes.slow:
            y[at] = settle((y[at] - g * y[at]) + enters, real)
            continue
        rest = memory.mode_row(modes.count + k)
        change = y[rest] + (enters - g * y[at])
        total = y[at] + change
        taken = total - y[at]
        y[rest] = settle((y[at] - (total - taken)) + (change - taken), real)
        y[at] = settle(total, real)


def history(state, memory):
    """Stage history (history)."""
    rows = int(state.f['history_rows'][0, 0])
    velocity = state.f['velocity'].copy()
    if memory.kind != 'window' and memory.old(rows) > 0:
        update_modes(state, memory, memory.old(rows))
    if memory.has_ring():
        ring = state.f['history_position' if memory.of_lengths else 'history_velocity']
        ring.insert(0, state.f['position'].copy() if memory.of_lengths else velocity)
        del ring[memory.ring_rows():]
        rows = min(rows + 1, memory.ring_rows())
    else:
        state.f['history_modes'][0] = velocity
        rows += 1
    state.f['history_rows'] = np.array([[rows]], dtype='<u8')


def remake_modes(state, memory):
    """After a command has changed the weights of kind window-fast (Commands, Set)."""
    rows, modes, real = memory.old(int(state.f['history_rows'][0, 0])), memory.modes, memory.real
    full = rows == memory.window + 1
    for k in range(modes.count):
        y = np.zeros(state.f['position'].shape, np.float64)
        for lag in range(rows - 1, 0, -1):
            enters = float(modes.rounded_first[k]) if lag == rows - 1 and not full else 1.0
            y = y + (-float(modes.decay[k]) * y + enters * state.f['history_velocity'][memory.lag + lag].astype(np.float64))
        total = y.astype(real)
        state.f['history_modes'][memory.mode_row(k)] = total
        if k < modes.slow:
            state.f['history_modes'][memory.mode_row(modes.count + k)] = (y - total.astype(np.float64)).astype(real)
