"""Periodic space and plates (docs/bits.md, Periodic space, Plates)."""
import functions
import numpy as np

LARGEST_CELL = (1 << 20) - 2
MOST_TURNS = 1 << 30


class Period:
    """Lengths and limits as reals (Periodic space); 0: space is open along that axis."""

    def __init__(self, d, real):
        self.length, self.limit = np.zeros(3, real), np.zeros(3, real)
        for axis, given in enumerate(d.vector('space.period') if 'space.period' in d.values else ()):
            length, limit = real(given), real(1)
            if not length > 0:
                continue
            while limit < length:
                limit = limit * real(2)
            while limit / real(2) >= length:
                limit = limit / real(2)
            self.length[axis], self.limit[axis] = (length + limit) - limit, limit
        self.any = bool(np.any(self.length > 0))

    def axes(self):
        return [axis for axis in range(3) if self.length[axis] > 0]

    def rounded(self, x):
        """Coordinates of points (Periodic space)."""
        x = x.copy()
        for axis in self.axes():
            limit, own = self.limit[axis], x[:, axis]
            near = np.where(own < 0, (own - limit) + limit, (own + limit) - limit)
            x[:, axis] = np.where((own < limit) & (own > -limit), near, np.nan)
        return x

    def wrapped(self, x):
        x = x.copy()
        for axis in self.axes():
            far = x[:, axis].astype(np.float64)
            x[:, axis] = (far - turns(far, self.length[axis]) * float(self.length[axis])).astype(x.dtype)
        return x

    def nearest(self, d):
        """Differences to the nearest image, and the shifts to it in periods."""
        moved, shift = d.copy(), np.zeros(d.shape, int)
        for axis in self.axes():
            length, own = self.length[axis], d[:, axis]
            shift[:, axis] = (own < -(length / 2)).astype(int) - (own > length / 2)
            moved[:, axis] = own + shift[:, axis].astype(d.dtype) * length
        return moved, shift

    def cells(self, axis, width):
        """Cells per length, and in a period (Periodic space)."""
        if not self.length[axis] > 0:
            return 1 / width, 0
        length = float(self.length[axis])
        count = int(min(max(length / width, 1), LARGEST_CELL))
        return count / length, count

    def have_drifted(self, mean_displacement):
        return any(not -(self.length[a] / 4) < mean_displacement[a] < self.length[a] / 4 for a in self.axes())


def turns(x, length):
    """Periods by which x is away (Periodic space), in double."""
    t = np.asarray(x, np.float64) / float(length) + 0.5
    return np.where((t > -MOST_TURNS) & (t < MOST_TURNS), np.floor(t), 0.0)


# ---- Plates


def plates(state, d, real, period, number_density):
    """Stage plates (Plates)."""
    f, tau = state.f, float(state.tau)
    plate = f['plate'][:, 0]
    velocity, shift = f['plate_velocity'][0].tolist(), f['plate_displacement'][0].tolist()
    phase = float(f['plate_phase'][0, 0])
    if d['plates.control'] == 'stress':
        area = float(period.length[0]) * float(period.length[2])
        force = d['plates.stress'] * number_density * area
        upper, momentum = np.nonzero(plate == 2)[0].tolist(), 0.0
        for i in upper:
            momentum += float(f['velocity'][i, 0] - real(velocity[0]))
        if upper:
            velocity[0] += (momentum + tau * force) / float(len(upper))
        shift[0] += tau * velocity[0]
        displacement = list(shift)
    else:
        given = d.vector('plates.velocity')
        phase = phase + tau * d['plates.frequency']
        phase = phase - float(int(phase)) if phase < 2.0 ** 50 else 0.0
        shift = [s + tau * v for s, v in zip(shift, given)]
        velocity = list(given)
        velocity[0] += 6.28318530717958647692 * d['plates.frequency'] * d['plates.amplitude'] * functions.sine_of_turns(phase, 1)
        displacement = list(shift)
        displacement[0] += d['plates.amplitude'] * functions.sine_of_turns(phase)
    f['plate_velocity'], f['plate_displacement'] = np.array([velocity]), np.array([shift])
    f['plate_phase'] = np.array([[phase]])
    f['position'], f['velocity'] = f['position'].copy(), f['velocity'].copy()
    for number, moved, speed in ((1, [0.0] * 3, [0.0] * 3), (2, displacement, velocity)):
        ids = np.nonzero(plate == number)[0]
        x = f['start_position'][ids].astype(np.float64) + np.array(moved)
        for axis in period.axes() if 'list_position' in f else ():
            away = turns(x[:, axis] - f['list_position'][ids, axis].astype(np.float64), period.length[axis])
            x[:, axis] = x[:, axis] - away * float(period.length[axis])
        f['position'][ids], f['velocity'][ids] = x.astype(real), np.array(speed).astype(real)
