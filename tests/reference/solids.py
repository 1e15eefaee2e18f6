"""Walls, ball and vibrators (docs/bits.md, Solids)."""
import math

import functions as f
import balls
import numpy as np
from lists import larger, length2, smaller

TWO_PI = 6.28318530717958647692


def dot(a, b):
    return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


class Walls:
    """Planes (walls)."""

    def __init__(self, walls, real):
        self.normal, self.offset = [], []
        for point, normal in walls:
            scale = 1 / math.sqrt(dot(normal, normal))
            offset = 0.0
            for n, p in zip(normal, point):
                offset += n * scale * p
            self.normal.append([real(n * scale) for n in normal])
            self.offset.append(real(offset))


class Solids:
    """Contact in a world. definition: parameters in force; real: number type."""

    def __init__(self, walls, definition, real, ball_masses):
        self.walls, self.d, self.real, self.masses = walls, definition, real, [real(mass) for mass in ball_masses]
        self.wall_distance = real(definition['fluid.spacing'] / 2)
        self.wave = self.wave_rate = None

    @property
    def mass(self):
        return self.masses[self.d.ball]

    # ---- Vibrators

    def vibrating_wall(self, state):
        """The wall that is the raised floor (vibrators)."""
        if len(state.f.get('vibrator_phase', ())) and self.d['vibrators.kind'] == 'floor':
            for w, normal in enumerate(self.walls.normal):
                if normal[1] == 1:
                    return w
        return None

    def largest_bump(self, state):
        """amplitude k (walls)."""
        position, real = state.f['vibrator_position'], self.real
        radius = real(self.d['vibrators.radius'])
        most = 0
        for a in position:
            dx, dz = a[0] - position[:, 0], a[1] - position[:, 1]
            most = max(most, int(np.count_nonzero(dx * dx + dz * dz <= real(4) * radius * radius)))
        return real(self.d['vibrators.amplitude']) * real(most)

    def vibrators(self, state):
        """Stage vibrators (vibrators)."""
        real, d, step = self.real, self.d, state.tau
        mean, spread = real(d['vibrators.frequency']), real(d['vibrators.spread'])
        wander = real(d['vibrators.wander']) * np.sqrt(step)
        lowest, highest = mean * (real(1) - spread), mean * (real(1) + spread)
        count = len(state.f['vibrator_phase'])
        self.wave, self.wave_rate = [None] * count, [None] * count
        for i in range(count):
            x = state.f['vibrator_frequency'][i, 0]
            x = x + mean * wander * (real(2) * random_unit(state, real) - real(1))
            x = real(2) * highest - x if x > highest else x
            x = real(2) * lowest - x if x < lowest else x
            x = smaller(larger(x, lowest), highest)[()]
            state.f['vibrator_frequency'][i, 0] = x
            phase = state.f['vibrator_phase'][i, 0] + smaller(x * step, real(1 << 20))[()]
            phase = phase - real(int(phase))
            state.f['vibrator_phase'][i, 0] = phase
            self.wave[i] = real(f.sine_of_turns(float(phase)))
            self.wave_rate[i] = real(TWO_PI * float(x) * f.sine_of_turns(float(phase), 1))
        if d['vibrators.kind'] == 'force':
            self.push_by_vibrators(state)

    def push_by_vibrators(self, state):
        """Kind force (vibrators)."""
        real, d, x = self.real, self.d, state.f['position']
        radius = real(d['vibrators.radius'])
        low = x[:, 1] < real(d['vibrators.height'])
        for i, (px, pz) in enumerate(state.f['vibrator_position']):
            rate = real(TWO_PI * float(state.f['vibrator_frequency'][i, 0]))
            gain = state.tau * real(d['vibrators.amplitude']) * (rate * rate) * self.wave[i]
            dx, dz = x[:, 0] - px, x[:, 2] - pz
            distance2 = dx * dx + dz * dz
            v = state.f['velocity'][:, 1]
            pushed = v + gain * (real(1) - distance2 / (radius * radius))
            state.f['velocity'][:, 1] = np.where(low & (distance2 < radius * radius), pushed, v)

    def bump(self, state, x, z):
        """Height of the raised floor at some points, and its rate (vibrators)."""
        real = self.real
        radius = real(self.d['vibrators.radius'])
        height, rate = np.zeros_like(x), np.zeros_like(x)
        for i, (px, pz) in enumerate(state.f['vibrator_position']):
            dx, dz = x - px, z - pz
            distance2 = dx * dx + dz * dz
            inside, shape = distance2 < radius * radius, real(1) - distance2 / (radius * radius)
            shape = shape * (shape * real(self.d['vibrators.amplitude']))
            height = height + np.where(inside, shape * self.wave[i], real(0))
            rate = rate + np.where(inside, shape * self.wave_rate[i], real(0))
        return height, rate

    # ---- Walls

    def stop_at_walls(self, state):
        """Stage walls (walls)."""
        vibrating = self.vibrating_wall(state)
        for w in range(len(self.walls.normal)):
            self.stop_particles(state, w, vibrating == w)
        for _ in balls.each(state, self.d):
            for w in range(len(self.walls.normal)):
                self.stop_ball(state, w, vibrating == w)

    def slowed(self, normal, overlap, tau):
        """c (walls)."""
        return np.where(normal < 0, smaller(overlap / tau, -normal), self.real(0))

    def stop_particles(self, state, w, vibrates):
        """All particles at one wall (walls)."""
        real, tau, n = self.real, state.tau, self.walls.normal[w]
        x, v = state.f['position'].T, state.f['velocity'].T
        distance = dot(n, x) - self.walls.offset[w]
        near = distance < self.wall_distance + (self.largest_bump(state) if vibrates else real(0))
        rate = np.zeros_like(distance)
        if vibrates:
            height, rate = self.bump(state, x[0], x[2])
            distance = distance - height
        overlap = self.wall_distance - distance
        touches = near & (overlap > 0)
        normal = dot(n, v)
        change = self.slowed(normal - rate, overlap, tau)
        friction = state.wall_friction if state.sticks else np.zeros_like(distance)
        most = real(1e30)
        stick = smaller(tau * real(self.d['walls.sticking']) * smaller(friction, most), most)
        lost, left = stick / (real(1) + stick), larger(overlap - tau * change, real(0))
        new_x, new_v = x.copy(), v.copy()
        for axis in range(3):
            by = change * n[axis] - lost * (v[axis] - normal * n[axis])
            new_v[axis] = np.where(touches, v[axis] + by, v[axis])
            new_x[axis] = np.where(touches, x[axis] + (tau * by + left * n[axis]), x[axis])
        state.f['position'], state.f['velocity'] = np.ascontiguousarray(new_x.T), np.ascontiguousarray(new_v.T)

    def stop_ball(self, state, w, vibrates):
        """The ball at one wall (walls, Ball)."""
        real, tau, n = self.real, state.tau, self.walls.normal[w]
        x, v, spin = (state.f[name][0].copy() for name in ('ball_position', 'ball_velocity', 'ball_spin'))
        radius, friction = real(self.d['ball.radius']), real(self.d['ball.friction']) * tau
        distance, rate = dot(n, x) - self.walls.offset[w] - radius, real(0)
        if vibrates:
            height, rates = self.bump(state, x[0:1], x[2:3])
            distance, rate = distance - height[0], rates[0]
        if not distance < 0:
            return
        change = self.slowed(dot(n, v) - rate, -distance, tau)[()]
        left = larger(-distance - tau * change, real(0))[()]
        arm = [-radius * n[axis] for axis in range(3)]
        for axis in range(3):
            v[axis] = v[axis] + change * n[axis]
            x[axis] = x[axis] + (tau * change + left) * n[axis]
        if change > 0:
            surface = cross(spin, arm)
            slide = [v[axis] + surface[axis] for axis in range(3)]
            into, share = dot(n, slide), friction / (real(1) + friction) / real(3.5)
            slide = [-share * (slide[axis] - into * n[axis]) for axis in range(3)]
            turn = cross(arm, slide)
            for axis in range(3):
                v[axis] = v[axis] + slide[axis]
                x[axis] = x[axis] + tau * slide[axis]
                spin[axis] = spin[axis] + real(2.5) * turn[axis] / (radius * radius)
        state.f['ball_position'], state.f['ball_velocity'], state.f['ball_spin'] = x[None], v[None], spin[None]

    # ---- Ball

    def ball_push(self, state):
        """Stage ball_push of a ball (ball_push)."""
        d, duty = self.d, self.d['ball.push_duty']

        def given(phase):
            share = phase / duty
            return 0.5 - 0.5 * f.sine_of_turns(0.5 * (share if share < 1 else 1), 1)
        start = float(state.f['ball_push_phase'][0, 0])
        end = start + d['ball.push_frequency'] * d['step']
        whole = float(int(end))
        periods = whole + given(end - whole) - given(start)
        gain = np.array([[self.real(a / d['ball.push_frequency'] * periods) for a in d.vector('ball.push')]])
        state.f['ball_velocity'] = state.f['ball_velocity'] + gain.astype(self.real)
        state.f['ball_push_phase'] = np.array([[end - whole]])

    def ball_motion(self, state):
        """Stage ball_motion of a ball (ball_motion)."""
        real, tau = self.real, state.tau
        v, x, q = (state.f[name][0] for name in ('ball_velocity', 'ball_position', 'ball_orientation'))
        v = np.array([v[axis] + tau * real(self.d.vector('gravity')[axis]) for axis in range(3)], dtype=real)
        x = x + tau * v
        w = [0.5 * float(tau) * s for s in state.f['ball_spin'][0].tolist()]
        q = q.tolist()
        turned = [q[0] - (w[0] * q[1] + w[1] * q[2] + w[2] * q[3]), q[1] + (w[0] * q[0] + w[1] * q[3] - w[2] * q[2]),
                  q[2] + (w[1] * q[0] + w[2] * q[1] - w[0] * q[3]), q[3] + (w[2] * q[0] + w[0] * q[2] - w[1] * q[1])]
        length = math.sqrt(turned[0] * turned[0] + turned[1] * turned[1] + turned[2] * turned[2] + turned[3] * turned[3])
        state.f['ball_velocity'], state.f['ball_position'] = v[None], x[None]
        state.f['ball_orientation'] = np.array([[real(t / length) for t in turned]], dtype=real)

    def ball(self, state):
        """Stage ball of a ball (ball)."""
        Collision(self, state).resolve()


class Collision:
    """Contact of a ball with all particles in a substep (docs/bits.md, ball). Doubles."""

    def __init__(self, solids, state):
        d, self.real, self.state = solids.d, solids.real, state
        self.tau, self.mass, radius = float(state.tau), float(solids.mass), d['ball.radius']
        self.surface = radius + (0.0 if d['scheme'] == 'summed' else d['fluid.spacing'] / 2)
        reach = radius + 0.75 * d['fluid.spacing']
        self.inertia = 0.4 * self.mass * radius * radius
        friction = d['ball.friction'] * self.tau
        self.share = friction / (1 + friction)
        x = state.f['position'] - state.f['ball_position'][0]
        near = np.nonzero(length2(x) < solids.real(reach * reach))[0]
        self.ball_velocity = state.f['ball_velocity'][0].tolist()
        self.ball_spin = state.f['ball_spin'][0].tolist()
        self.contacts = [Contact(self, int(i)) for i in near]

    def outward(self, i):
        n = [a - b for a, b in zip(self.state.f['position'][i].tolist(), self.state.f['ball_position'][0].tolist())]
        length = math.sqrt(dot(n, n))
        return length, [x / length for x in n] if length > 0 else [0.0, 1.0, 0.0]

    def equations(self):
        a, b = [[0.0] * 6 for _ in range(6)], [0.0] * 6
        for axis in range(3):
            a[axis][axis], b[axis] = self.mass, self.mass * self.ball_velocity[axis]
            a[3 + axis][3 + axis], b[3 + axis] = self.inertia, self.inertia * self.ball_spin[axis]
        for contact in self.contacts:
            contact.add_to(a, b)
        return a, b

    def resolve(self):
        if not self.contacts:
            return
        for turn in range(4):
            result = solve(*self.equations())
            changed = False
            for c in self.contacts:
                pushes = c.overlaps and c.target + dot(c.normal, result) > c.velocity
                if turn < 3 and pushes != c.active:
                    c.active, changed = pushes, True
            if not changed:
                break
        real, s = self.real, self.state.f
        move = [real(self.tau * (new - old)) for new, old in zip(result, self.ball_velocity)]
        s['ball_position'] = s['ball_position'] + np.array([move], dtype=real)
        s['ball_velocity'] = np.array([result[:3]]).astype(real)
        s['ball_spin'] = np.array([result[3:]]).astype(real)
        for c in self.contacts:
            c.push(result)


class Contact:
    def __init__(self, collision, i):
        self.of, self.id = collision, i
        self.distance, self.normal = collision.outward(i)
        overlap = collision.surface - self.distance
        self.velocity = approach = 0.0
        for n, v, of_ball in zip(self.normal, collision.state.f['velocity'][i].tolist(), collision.ball_velocity):
            self.velocity += n * v
            approach += n * (v - of_ball)
        slowed = approach + overlap / collision.tau
        self.target = slowed if slowed < 0 else 0.0
        self.overlaps = overlap > 0
        self.active = self.overlaps and approach < 0

    def sliding(self):
        return [v - self.velocity * n for v, n in zip(self.of.state.f['velocity'][self.id].tolist(), self.normal)]

    def add_to(self, a, b):
        n, share, radius = self.normal, self.of.share, self.distance
        arm = [[0.0, -radius * n[2], radius * n[1]], [radius * n[2], 0.0, -radius * n[0]], [-radius * n[1], radius * n[0], 0.0]]
        pushes = 1.0 if self.active else 0.0
        normal, tangential = pushes * (self.velocity - self.target), self.sliding()
        turn = [dot(row, tangential) for row in arm]
        for i in range(3):
            for j in range(3):
                along = (1.0 if i == j else 0.0) - n[i] * n[j]
                if j <= i:
                    a[i][j] += pushes * n[i] * n[j] + share * along
                    a[3 + i][3 + j] += share * radius * radius * along
                a[3 + i][j] += share * arm[i][j]
            b[i] += normal * n[i] + share * tangential[i]
            b[3 + i] += share * turn[i]

    def push(self, result):
        of, n, real = self.of, self.normal, self.of.real
        ball = dot(n, result)
        impulse = self.target + ball - self.velocity if self.active else 0.0
        surface = cross(result[3:], [self.distance * x for x in n])
        tangential = self.sliding()
        x, v = of.state.f['position'][self.id], of.state.f['velocity'][self.id]
        for axis in range(3):
            slide = tangential[axis] - (result[axis] - ball * n[axis]) - surface[axis]
            change = impulse * n[axis] - of.share * slide
            v[axis] = v[axis] + real(change)
            x[axis] = x[axis] + real(of.tau * change)
        length, direction = of.outward(self.id)
        if length < of.surface:
            for axis, centre in enumerate(of.state.f['ball_position'][0].tolist()):
                x[axis] = real(centre + of.surface * direction[axis])


def solve(a, b):
    """Cholesky's method (ball); a: lower triangle."""
    for i in range(6):
        for j in range(i + 1):
            total = a[i][j]
            for k in range(j):
                total -= a[i][k] * a[j][k]
            a[i][j] = math.sqrt(total) if i == j else total / a[j][j]
    for i in range(6):
        for k in range(i):
            b[i] -= a[i][k] * b[k]
        b[i] /= a[i][i]
    for i in range(5, -1, -1):
        for k in range(i + 1, 6):
            b[i] -= a[k][i] * b[k]
        b[i] /= a[i][i]
    return b


def random_unit(state, real):
    """u, a number in [0, 1) from splitmix64 (vibrators)."""
    mask = (1 << 64) - 1
    x = int(state.f['random'][0, 0]) + 0x9E3779B97F4A7C15 & mask
    state.f['random'] = np.array([[x]], dtype='<u8')
    x = (x ^ x >> 30) * 0xBF58476D1CE4E5B9 & mask
    x = (x ^ x >> 27) * 0x94D049BB133111EB & mask
    x ^= x >> 31
    return real(x >> 40) * real(1.0 / (1 << 24))
