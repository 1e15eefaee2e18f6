"""A world: its state, its stages in the order of a step, and commands (docs/bits.md, A step, Commands)."""
import copy

import balls
import history
import lists
import numpy as np
import periodic
import rheolog
import sequential
import solids
import summed
import wetting
from parameters import Definition


class State:
    """f: fields by name, as items x components; rings and modes as lists of rows. Springs: a table, or values of a list."""

    def __init__(self, keyframe, head):
        self.real, self.fields = head.real, head.fields
        names = [field.name for field in head.fields]
        self.f = {name: copy.deepcopy(value) for name, value in keyframe.values.items() if not name.startswith('spring_')}
        self.has_springs, self.sticks = 'spring_ends' in names, bool(head.features & 128)
        self.list = self.rest = self.k = self.stiffness_sum = self.tau = self.wet = self.wall_friction = None
        self.pressure = self.near_pressure = self.coinciding = None
        self.table = {}
        if self.has_springs:
            ends, rest = keyframe.values['spring_ends'], keyframe.values['spring_rest_length']
            self.table = dict(zip(map(tuple, ends.tolist()), rest[:, 0]))

    def take_list(self, new):
        """Springs take over the layout of a list; those of pairs that it lacks vanish."""
        old = self.springs() if self.has_springs else {}
        self.list = new
        self.rest = np.full(new.partner.shape, -1, self.real)
        for (a, b), length in old.items():
            if (a, b) in new.entry:
                self.rest[a, new.entry[a, b]] = self.rest[b, new.entry[b, a]] = length

    def spring_arrays(self):
        """Ends, the smaller id first, and rest lengths, in any order."""
        if self.list is None:
            return (np.array(list(self.table), dtype='<u4').reshape(-1, 2), np.array(list(self.table.values()), dtype=self.real))
        rows, places = np.nonzero(self.list.there & (self.rest >= 0))
        partners = self.list.partner[rows, places]
        lower = rows < partners
        ends = np.stack([rows[lower], partners[lower]], axis=1)
        return ends.astype('<u4'), self.rest[rows[lower], places[lower]]

    def springs(self):
        """Rest lengths by smaller and larger id."""
        ends, rest = self.spring_arrays()
        return dict(zip(map(tuple, ends.tolist()), rest))

    def flat(self):
        """All fields except rings and modes, with the springs."""
        values = {field.name: self.f[field.name] for field in self.fields if field.storage == rheolog.FLAT}
        if self.has_springs:
            ends, rest = self.spring_arrays()
            order = np.lexsort((ends[:, 1], ends[:, 0]))
            values['spring_ends'], values['spring_rest_length'] = ends[order], rest[order].reshape(-1, 1)
        return values

    def hash_of(self, field, newest=False):
        """Hash of a field. newest: of a ring only row 0, as after a stage."""
        if field.name.startswith('spring_'):
            ends, rest = self.spring_arrays()
            return rheolog.hash_of_spring_ends(ends) if field.name == 'spring_ends' else rheolog.hash_of_rest_lengths(ends, rest)
        if field.storage == rheolog.FLAT:
            return rheolog.hash_of_rows([self.f[field.name]], len(self.f[field.name]))
        rows = self.f[field.name]
        rows = rows[:1] if newest and field.storage == rheolog.RING else rows
        return rheolog.hash_of_rows(rows, len(self.f['position']))

    def hash(self):
        return rheolog.hash_of_state({field.name: self.hash_of(field) for field in self.fields})


class World:
    def __init__(self, head, keyframe, parameters):
        self.real, self.head = head.real, head
        self.state = State(keyframe, head)
        self.d = Definition(parameters, keyframe.parameters)
        self.walls = solids.Walls(head.walls, self.real)
        self.state.period = periodic.Period(self.d, self.real)
        self.configure()

    def configure(self):
        """Constants of the parameters in force."""
        masses = [wetting.ball_mass(self.d) for _ in balls.each(self.state, self.d)]
        self.solids = solids.Solids(self.walls, self.d, self.real, masses)
        self.wetting = wetting.Wetting(self.state, self.d, self.real, masses) if masses else None
        self.memory = history.Memory(self.d, self.real) if 'history_rows' in self.state.f else None

    # ---- Stages

    def begin(self):
        """Start of a step."""
        self.before = {name: self.state.f[name].copy() for name in ('position', 'derivative') if name in self.state.f}
        self.state.tau = self.real(self.d['step'])

    def run(self, name):
        """Runs a stage."""
        s, d, real = self.state, self.d, self.real
        is_summed = d['scheme'] == 'summed'
        if name == 'gravity':
            s.f['velocity'] = s.f['velocity'] + s.tau * np.array(d.vector('gravity')).astype(real)
        elif name == 'prediction':
            s.f['position'] = s.f['position'] + s.tau * s.f['velocity']
        elif name == 'vibrators':
            self.solids.vibrators(s)
        elif name in ('ball_push', 'ball_motion', 'ball'):
            for _ in balls.each(s, d):
                getattr(self.solids, name)(s)
        elif name == 'balls':
            balls.contacts(s, d, self.solids.masses, real)
        elif name == 'walls':
            self.solids.stop_at_walls(s)
        elif name == 'fractional_derivative':
            if not self.memory.of_lengths:  # else stages viscosity and stiffness do it
                history.fractional_derivative(s, self.memory)
        elif name == 'history':
            history.history(s, self.memory)
        elif is_summed:
            self.run_summed(name)
        else:
            self.run_sequential(name)

    def run_summed(self, name):
        s, d, real = self.state, self.d, self.real
        if name == 'neighbours':
            lists.neighbours(s, d, real)
        elif name in ('viscosity', 'stiffness'):
            summed.viscosity(s, d, real, self.before.get('derivative'), self.memory)
        elif name == 'substeps':
            summed.substeps(s, d, real)
        elif name == 'densities':
            summed.densities(s, d, real, self.wetting)
        elif name == 'forces':
            summed.forces(s, d, real, self.wetting)
        elif name == 'plates':
            periodic.plates(s, d, real, s.period, wetting.number_density(d))
        else:
            raise rheolog.Damaged(f'there is no stage {name} in scheme summed')

    def run_sequential(self, name):
        s, d, real = self.state, self.d, self.real
        if name in ('neighbours_start', 'neighbours'):
            self.sweep = sequential.Sweep(s.f['position'], d['fluid.support'], real)
        elif name == 'velocity':
            sequential.velocity(s, self.before['position'], d, real)
        elif name in ('viscosity', 'springs', 'spring_displacement', 'density'):
            getattr(sequential, name)(s, self.sweep, d, real)
        else:
            raise rheolog.Damaged(f'there is no stage {name} in scheme sequential')

    def end(self):
        """End of a step."""
        self.state.f['step'] = self.state.f['step'] + np.uint64(1)

    # ---- Commands

    def command(self, c):
        {1: self.set, 2: self.push_body, 3: self.add_particles, 4: self.move_vibrator}[c.kind](c)

    def set(self, c):
        s, before = self.state, dict(self.d.values)
        time = float(s.f['time_origin'][0, 0]) + float(s.f['step'][0, 0] - s.f['step_origin'][0, 0]) * self.d['step']
        self.d.set(c.path, c.value)
        self.configure()
        if 'list_margin' in s.f and self.d.values['fluid.support'] != before['fluid.support']:
            s.f['list_margin'] = np.zeros_like(s.f['list_margin'])
        if self.memory and self.memory.kind == 'window-fast' and self.d.values['history.weights'] != before['history.weights']:
            history.remake_modes(s, self.memory)
        if self.d.values['step'] != before['step']:
            s.f['step_origin'], s.f['time_origin'] = s.f['step'].copy(), np.array([[time]])
        group, _, member = c.path.partition('.')
        if group.startswith('ball') and member in ('position', 'velocity', 'spin'):
            s.f['ball_' + member][int(group[4:] or 1) - 1] = np.array(self.d.vector(c.path)).astype(self.real)

    def push_body(self, c):
        with balls.one(self.state, self.d, c.body):
            self.push_ball(c)

    def push_ball(self, c):
        s, mass, radius = self.state.f, float(self.solids.mass), float(self.real(self.d['ball.radius']))
        arm = [p - x for p, x in zip(c.point, s['ball_position'][0].tolist())] if c.point else [0.0] * 3
        torque = solids.cross(arm, c.impulse)
        v = [v + j / mass for v, j in zip(s['ball_velocity'][0].tolist(), c.impulse)]
        w = [w + 2.5 * t / (mass * radius * radius) for w, t in zip(s['ball_spin'][0].tolist(), torque)]
        s['ball_velocity'], s['ball_spin'] = np.array([v]).astype(self.real), np.array([w]).astype(self.real)

    def add_particles(self, c):
        s, count = self.state, len(c.position)
        for field in self.head.fields:
            value = s.f.get(field.name)
            if field.location != rheolog.PARTICLE or value is None:
                continue
            given = {'position': c.position, 'start_position': c.position, 'velocity': c.velocity,
                     'material': np.full((count, 1), c.material, '<u4')}
            more = given.get('position' if field.name == 'history_position' else field.name,
                             np.zeros((count, field.components), field.dtype))
            if field.storage == rheolog.FLAT:
                s.f[field.name] = np.concatenate([value, more])
            else:
                s.f[field.name] = [np.concatenate([row, more]) for row in value]

    def move_vibrator(self, c):
        self.state.f['vibrator_position'][c.vibrator] = np.array(c.place).astype(self.real)
