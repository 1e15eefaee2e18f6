"""
Reads recordings of rheolog. docs/python.md shows how to use it; docs/format.md describes the file.

    import rheolog
    r = rheolog.open('ball.rlog')
    r.metrics['max_speed']                  one value for each step
    r[-1].position                          the last state, as numpy arrays in the order of ids
    r.step(40, stage='densities').position  a state in the middle of a step, from librheolog
    r.verify()                              check sums and hashes, computed here

Needs numpy; frame() needs pandas. States that the file does not store come from librheolog, which simulates them. Everything
else works without it. A recording must not be used by several threads at once.
"""
import collections
import ctypes
import io
import operator
import os
import struct
import sys
import weakref
import zlib

import numpy as np

try:
    import fcntl
except ImportError:  # no such locks on this system
    fcntl = None

MAGIC = b'\x89RLOG\r\n\x1a'
ELEMENTS = {0: np.dtype('<f4'), 1: np.dtype('<f8'), 2: np.dtype('<u4'), 3: np.dtype('<u8')}
FLAT, SPRING, RING, MODES = range(4)
WORLD, PARTICLE, SPRINGS, BODY, VIBRATOR, OBSTACLE = range(6)
LOCATIONS = ['world', 'particle', 'spring', 'body', 'vibrator', 'obstacle']
REASONS = ['none', 'not-finite', 'density-not-positive', 'substeps-for-sound', 'substeps-for-viscosity',
           'substeps-for-printed-viscosity', 'substeps-for-heat', 'viscosity-out-of-range']
SAMENESS = [None, 'differs', 'statistics', 'step', 'rounding', 'bits']
MELTING = 256
MOST_RAW_BYTES = 16 << 20
MOST_ZEROS = 256 << 20


class Error(Exception):
    """What is wrong, where, and what would be right."""


class Damaged(Error):
    """The file is no recording, or a byte or hash of it is wrong."""


class NotStored(Error):
    """The file does not hold this, and there is no library that simulates it."""


class LibraryError(Error):
    """librheolog cannot be loaded, is of the other number type, or refuses to do something."""


def require(condition, message):
    if not condition:
        raise Damaged(message)


# ---- Payloads (docs/format.md) ----


class Cursor:
    """Reads the members of a payload (Notation)."""

    def __init__(self, payload):
        self.payload, self.at = payload, 0

    def take(self, count):
        require(self.at + count <= len(self.payload), 'a payload ends early')
        self.at += count
        return self.payload[self.at - count:self.at]

    def get(self, letter, count=None):
        size = struct.calcsize('<' + letter)
        data = self.take(size * (1 if count is None else count))
        return struct.unpack('<' + letter, data)[0] if count is None else list(struct.unpack(f'<{count}{letter}', data))

    def u32(self, count=None):
        return self.get('I', count)

    def u64(self, count=None):
        return self.get('Q', count)

    def f64(self, count=None):
        return self.get('d', count)

    def text(self):
        return self.take(self.get('H')).decode(errors='replace')

    def planes(self, count, dtype):
        """Byte planes."""
        data = np.frombuffer(self.take(count * dtype.itemsize), dtype=np.uint8).reshape(dtype.itemsize, count)
        return np.ascontiguousarray(data.T).view(dtype).reshape(count)

    def packed(self, count, dtype):
        """Packed values, as unsigned integers of the same size."""
        halves = dtype.itemsize // 4
        groups = -(-count // 8) * halves
        starts, widths = np.empty(groups, np.intp), np.empty(groups, np.uint8)
        at, payload = self.at, self.payload
        try:
            for group in range(groups):
                starts[group], widths[group] = at + 1, payload[at]
                at += 1 + payload[at]
        except IndexError:
            at = len(payload) + 1
        require(at <= len(payload), 'a payload ends early')
        self.at = at
        data = np.frombuffer(payload, np.uint8)
        values = np.zeros((groups, 8), '<u4')
        for bits in np.unique(widths).tolist():
            require(bits <= 32, 'a group of packed values has more than 32 bits')
            if bits:
                rows = np.flatnonzero(widths == bits)
                found = np.zeros((len(rows), 8, 32), np.uint8)
                found[:, :, :bits] = np.unpackbits(data[starts[rows, None] + np.arange(bits)], axis=1,
                                                   bitorder='little').reshape(-1, 8, bits)
                values[rows] = np.packbits(found, axis=2, bitorder='little').view('<u4')[:, :, 0]
        if halves == 1:
            return values.reshape(-1)[:count]
        values = values.reshape(-1, 2, 8).astype('<u8')
        return (values[:, 0] | values[:, 1] << np.uint64(32)).reshape(-1)[:count]

    def done(self):
        return self.at == len(self.payload)


class Field:
    """A field entry of HEAD."""

    def __init__(self, c):
        self.name = c.text()
        element, self.components, self.location, self.storage = c.u32(4)
        require(element in ELEMENTS and self.location <= OBSTACLE and self.storage <= MODES,
                f'HEAD describes the field {self.name} in numbers that this reader does not know')
        self.dtype = ELEMENTS[element]


class Stage:
    """A stage entry of HEAD."""

    def __init__(self, c):
        self.name, self.phase = c.text(), c.u32()
        self.writes = c.u32(c.u32())


class Head:
    """HEAD."""

    def __init__(self, payload):
        c = Cursor(payload)
        self.version = c.u32()
        require(self.version in (5, 6), f'this reads versions 5 and 6 of the format, not {self.version}')
        self.real_bytes, full = c.u32(2)
        require(self.real_bytes in (4, 8) and full <= 1, 'HEAD has another number type than float and double')
        self.full = full == 1
        self.real = {4: np.float32, 8: np.float64}[self.real_bytes]
        self.keyframe_spacing = c.u64()
        self.scene, self.build, self.features = c.text(), c.text(), c.u32()
        self.walls = [(c.f64(3), c.f64(3)) for _ in range(c.u32())]
        self.vibrators = [c.f64(2) for _ in range(c.u32())]
        self.fields = [Field(c) for _ in range(c.u32())]
        self.stages = [Stage(c) for _ in range(c.u32())]
        self.metrics = [c.text() for _ in range(c.u32())]
        self.meshes = []  # of obstacles: (vertices, triangles)
        for _ in range(c.u32() if self.version == 6 else 0):
            vertices = [c.f64(3) for _ in range(c.u32())]
            self.meshes.append((vertices, [c.u32(3) for _ in range(c.u32())]))
        require(c.done(), 'HEAD has bytes left over')
        require(all(w < len(self.fields) for s in self.stages for w in s.writes), 'a stage writes a field that is not in HEAD')

    def hashes_of(self, phase):
        return sum(len(s.writes) for s in self.stages if s.phase == phase)

    def stage_runs(self, substeps):
        """(stage, substep or 0) in the order of a step."""
        runs = [(s, 0) for s in self.stages if s.phase == 0]
        for substep in range(substeps):
            runs += [(s, substep + 1) for s in self.stages if s.phase == 1]
        return runs + [(s, 0) for s in self.stages if s.phase == 2]


class Keyframe:
    """KEYF with the FILD chunks that it commits; `values` by name: items x components, of rings and modes a list of such rows."""

    def __init__(self, head, step, payload, filds=None):
        c = Cursor(payload)
        self.step = step
        self.particles, self.bodies, self.vibrators, self.springs, self.history_rows, self.chunks = c.u64(6)
        self.hashes = c.u64(len(head.fields))
        self.metrics = c.f64(len(head.metrics))
        self.parameters = {}
        for _ in range(c.u32()):
            path = c.text()
            values = c.f64(c.u32())
            if path == 'history.curve':  # a list of points (Parameter list)
                self.parameters.setdefault(path, []).append(values)
            else:
                self.parameters[path] = values
        require(c.done(), 'KEYF has bytes left over')
        self.obstacles = sum(path.startswith('obstacles.') and path.endswith('.shape') for path in self.parameters)
        if filds is not None:
            require(self.chunks == len(filds), 'KEYF claims another number of FILD chunks')
            self.values = self.read_fields(head, filds)

    def items(self, field):
        return [1, self.particles, self.springs, self.bodies, self.vibrators, self.obstacles][field.location]

    def read_fields(self, head, filds):
        arrays = join(pieces(filds, head, lambda c, field, part, count: c.planes(count, head.fields[field].dtype)))
        values = {}
        for index, field in enumerate(head.fields):
            rows = []
            while (index, len(rows)) in arrays:
                row = arrays.pop((index, len(rows)))
                require(len(row) == self.items(field) * field.components, f'{field.name} has another number of items')
                rows.append(row.reshape(-1, field.components))
            if field.storage in (FLAT, SPRING):
                require(len(rows) == (self.items(field) > 0), f'{field.name} is missing')
                values[field.name] = rows[0] if rows else np.zeros((0, field.components), field.dtype)
            else:
                require(field.storage == MODES or len(rows) == self.history_rows or self.particles == 0,
                        f'{field.name} has another number of rows')
                values[field.name] = rows
        require(not arrays, 'FILD holds an array of no field')
        return values

    def check(self, head):
        """The hashes, from the values."""
        for field, expected in zip(head.fields, self.hashes):
            require(hash_of_field(field, self.values) == expected,
                    f'keyframe of step {self.step}: {field.name} does not have the recorded hash')


def pieces(payloads, head, read):
    """The pieces of some chunks: ((field, part), first, values)."""
    for payload in payloads:
        c = Cursor(payload)
        while not c.done():
            field, part = c.u32(2)
            first, count = c.u64(2)
            require(field < len(head.fields) or field == COUNTS, 'a piece is of no field')
            require(count <= MOST_RAW_BYTES, 'a piece has more values than a chunk can hold')
            yield (field, part), first, read(c, field, part, count)


def join(parts):
    """Arrays of pieces, by field and part."""
    arrays = {}
    for key, first, values in parts:
        require(first == sum(map(len, arrays.get(key, []))), 'pieces are not in order')
        arrays.setdefault(key, []).append(values)
    return {key: np.concatenate(found) for key, found in arrays.items()}


class Command:
    """INPT."""

    KINDS = {1: 'set', 2: 'push_body', 3: 'add_particles', 4: 'move_vibrator'}

    def __init__(self, payload, real):
        c = Cursor(payload)
        self.kind = c.u32()
        if self.kind == 1:
            self.path, self.value = c.text(), c.text()
        elif self.kind == 2:
            self.body, has_point = c.u32(2)
            self.impulse = c.f64(3)
            self.point = c.f64(3) if has_point else None
        elif self.kind == 3:
            count = c.u32()
            self.position = c.planes(3 * count, np.dtype(real)).reshape(-1, 3)
            self.velocity = c.planes(3 * count, np.dtype(real)).reshape(-1, 3)
            self.material = 0 if c.done() else c.u32()
        elif self.kind == 4:
            self.vibrator = c.u32()
            self.place = c.f64(2)
        else:
            raise Damaged(f'there is no command of kind {self.kind}')
        require(c.done(), 'INPT has bytes left over')

    def described(self, step):
        """As `rheolog log --json` names it."""
        found = {'step': step, 'kind': self.KINDS[self.kind]}
        if self.kind == 1:
            found.update(path=self.path, value=self.value)
        elif self.kind == 2:
            found.update(body=self.body, impulse=self.impulse, point=self.point)
        elif self.kind == 3:
            found.update(count=len(self.position), position=self.position, velocity=self.velocity, material=self.material)
        else:
            found.update(vibrator=self.vibrator, x=self.place[0], z=self.place[1])
        return found


class Step:
    """STEP with the chunks that it commits. `stats` are payloads that state_after() reads."""

    def __init__(self, head, number, payload, inputs, stats):
        c = Cursor(payload)
        self.number = number
        require(c.u32() == len(inputs), 'STEP claims another number of INPT chunks')
        require(c.u32() == len(stats), 'STEP claims another number of STAT chunks')
        count = (len(payload) - 8) // 8 - len(head.metrics)
        require(count >= 0, 'STEP ends early')
        self.hashes = c.u64(count)
        self.metrics = c.f64(len(head.metrics))
        require(c.done(), 'STEP has bytes left over')
        self.commands = [Command(p, head.real) for p in inputs]
        self.stats = stats
        self.keyframe = None
        once, repeated = head.hashes_of(0) + head.hashes_of(2), head.hashes_of(1)
        self.substeps = 0
        if repeated:
            self.substeps, rest = divmod(count - once, repeated)
            require(rest == 0 and self.substeps >= 1, 'STEP has no whole number of substeps')
        else:
            require(count == once, 'STEP has another number of hashes')

    def stage_runs(self, head):
        return head.stage_runs(self.substeps)

    def last_hashes(self, head):
        """The hash of each field after the last stage that wrote it, by index."""
        expected = iter(self.hashes)
        return {index: next(expected) for stage, _ in self.stage_runs(head) for index in stage.writes}


class Failure:
    """FAIL."""

    def __init__(self, head, step, payload, inputs):
        c = Cursor(payload)
        self.step = step
        require(c.u32() == len(inputs), 'FAIL claims another number of INPT chunks')
        self.commands = [Command(p, head.real) for p in inputs]
        self.stage, self.field, self.location = c.text(), c.text(), c.u32()
        self.id, self.component, self.reason = c.u64(), c.u32(), c.u32()
        self.required, self.limit = c.f64(2)
        self.metrics = c.f64(len(head.metrics))
        require(c.done() and self.location <= OBSTACLE, 'FAIL has bytes left over')


COUNTS = 65536  # the "field" of the counts of STAT


def unfold(expected, folded):
    """The reals at these folded differences from the expected ones (STAT). All integers are modulo 2^32 or 2^64."""
    unsigned = folded.dtype.type
    one, top = unsigned(1), unsigned(1 << 8 * folded.dtype.itemsize - 1)
    require(len(expected) == len(folded), 'STAT has another number of values')
    bits = np.ascontiguousarray(expected).view(folded.dtype)
    a = np.where(bits & top, ~bits, bits | top)
    b = a + ((folded >> one) ^ (~(folded & one) + one))
    return np.where(b & top, b & ~top, ~b).view(expected.dtype)


def state_after(head, step, before):
    """
    The state at the end of a step of a full recording (STAT): flat fields and springs, by name. before: those of the old state.
    """
    def read(c, field, part, count):
        if field == COUNTS:
            return c.packed(count, np.dtype('<u8'))
        return c.packed(count, head.fields[field].dtype)
    arrays = join(pieces(step.stats, head, read))
    counts = arrays.get((COUNTS, 0), [])
    require(len(counts) == 6, 'STAT has no counts')
    particles, bodies, vibrators = counts[:3].tolist()
    dt = head.real(counts[5:6].view('<f8')[0])
    after = {}
    for index, field in sorted(enumerate(head.fields), key=lambda e: e[1].name != 'velocity'):
        if field.storage != FLAT:
            continue
        # Obstacles are as many as before.
        items = len(before[field.name]) if field.location == OBSTACLE else [1, particles, 0, bodies, vibrators][field.location]
        stored = arrays.get((index, 0), np.zeros(0, f'<u{field.dtype.itemsize}'))
        require(len(stored) == items * field.components, f'STAT has another number of values of {field.name}')
        if field.location == PARTICLE and field.dtype == head.real:
            expected = np.zeros((items, field.components), field.dtype)
            expected[:len(before[field.name])] = before[field.name]
            if field.name == 'position':
                with np.errstate(all='ignore'):  # in a run that goes bad the prediction may be infinite
                    expected = expected + dt * after['velocity']
            after[field.name] = unfold(expected.reshape(-1), stored).reshape(items, field.components)
        else:
            after[field.name] = stored.view(field.dtype).reshape(items, field.components)
    if 'spring_ends' in before:
        springs_after(after, before, arrays, {f.name: i for i, f in enumerate(head.fields)}, counts)
    return after


def springs_after(after, before, arrays, index, counts):
    """The springs of a full recording (STAT, the last three arrays)."""
    none = np.zeros(0, '<u4')
    removed, new = arrays.get((index['spring_ends'], 0), none), arrays.get((index['spring_ends'], 1), none)
    require((len(removed), len(new)) == (int(counts[3]), 2 * int(counts[4])), 'STAT has another number of springs')
    ends, rest = before['spring_ends'], before['spring_rest_length'].reshape(-1)
    require(len(removed) == 0 or int(removed.max()) < len(ends), 'STAT removes a spring that there is not')
    kept = np.ones(len(ends), bool)
    kept[removed] = False
    ends = np.concatenate([ends[kept], new.reshape(-1, 2)])
    rest = np.concatenate([rest[kept], np.zeros(len(new) // 2, rest.dtype)])
    order = np.lexsort((ends[:, 1], ends[:, 0]))
    after['spring_ends'] = ends[order]
    folded = arrays.get((index['spring_rest_length'], 0), np.zeros(0, f'<u{rest.dtype.itemsize}'))
    after['spring_rest_length'] = unfold(rest[order], folded).reshape(-1, 1)


# ---- Hashes (docs/format.md, Hashes) ----

MASK = (1 << 64) - 1
FIELDS = ['step', 'step_origin', 'time_origin', 'position', 'velocity', 'spring_ends', 'spring_rest_length', 'ball_position',
          'ball_velocity', 'ball_spin', 'ball_orientation', 'vibrator_position', 'vibrator_phase', 'vibrator_frequency', 'random',
          'history_rows', 'history_velocity', 'history_modes', 'density', 'temperature', 'start_position', 'substeps', 'iterations',
          'derivative', 'list_position', 'list_margin', 'predicted_acceleration', 'material', 'ball_push_phase',
          'history_position', 'plate', 'plate_displacement', 'plate_velocity', 'plate_phase', 'emitter_time', 'emitter_way',
          'emitter_emitted', 'emitter_blocked']
FACTOR, OF_WORD, OF_ROW = 0xD6E8FEB86659FD93, 0x9E3779B97F4A7C15, 0xD1B54A32D192ED03


def u64(value):
    return np.uint64(value & MASK)


def finish_all(x):
    """finish() of an array of words."""
    for _ in range(2):
        x = x ^ (x >> u64(32))
        x = x * u64(FACTOR)
    return x ^ (x >> u64(32))


def finish(x):
    return int(finish_all(np.array([x & MASK], dtype=np.uint64))[0])


def word(row, n, w):
    return finish(w ^ ((n + 1) * OF_WORD + row * OF_ROW))


def total(terms):
    """Sum modulo 2^64. Integers: the order does not matter."""
    return int(np.add.reduce(terms, dtype=np.uint64)) if len(terms) else 0


def keys(ids):
    """key() of each id. The upper half of a product of 128 bits is computed from halves of 32 bits."""
    factor, half, low = 0xE7037ED1A0B428DB, u64(32), u64(0xFFFFFFFF)
    a = ids.astype(np.uint64) ^ u64(0xA0761D6478BD642F)
    a0, a1, f0, f1 = a & low, a >> half, u64(factor & 0xFFFFFFFF), u64(factor >> 32)
    middle = a1 * f0 + (a0 * f0 >> half)
    high = a1 * f1 + (middle >> half) + (a0 * f1 + (middle & low) >> half)
    return (a * u64(factor) ^ high) & u64(~3) | u64(1)


def lengths(values):
    """length() of each rest length."""
    if values.dtype.itemsize == 4:
        b = values.view(np.uint32).astype(np.uint64) + u64(0x2545F491)
        return b * b
    return finish_all(values.view(np.uint64))


def finish_field(total_of_words, rows, items):
    return finish(total_of_words + word(rows, items, 0))


def hash_of_rows(rows, items):
    """Hash of a field of rows; a flat field has one."""
    result = 0
    for row, values in enumerate(rows):
        data = np.ascontiguousarray(values).tobytes()
        w = np.frombuffer(data + b'\0' * (-len(data) % 8), dtype='<u8').astype(np.uint64)
        places = (np.arange(len(w), dtype=np.uint64) + u64(1)) * u64(OF_WORD) + u64(row * OF_ROW)
        result += total(finish_all(w ^ places))
    return finish_field(result, len(rows), items)


def hash_of_spring_ends(ends):
    k = keys(ends.reshape(-1)).reshape(-1, 2)
    return finish_field(total(k[:, 0] * k[:, 1]), 1, len(ends))


def hash_of_rest_lengths(ends, values):
    k = keys(ends.reshape(-1)).reshape(-1, 2)
    return finish_field(total((k[:, 0] + k[:, 1]) * lengths(values)), 1, len(ends))


def hash_of_field(field, values):
    """Hash of a field of a state, from the arrays of the state by name."""
    if field.name == 'spring_ends':
        return hash_of_spring_ends(values['spring_ends'])
    if field.name == 'spring_rest_length':
        return hash_of_rest_lengths(values['spring_ends'], np.ascontiguousarray(values['spring_rest_length']).reshape(-1))
    rows = [values[field.name]] if field.storage == FLAT else values[field.name]
    return hash_of_rows(rows, len(values['position']) if field.location == PARTICLE else len(values[field.name]))


def hash_of_state(hashes):
    """Hash of a state from the hashes of the fields that it has, by name."""
    return finish(sum(word(0, FIELDS.index(name), value) for name, value in hashes.items()))


# ---- States ----


class State:
    """
    The state after a step, or inside of a step after a stage. state.position, or state['position'], is a numpy array: items x
    components in the order of ids, of histories rows x items x components with the newest row first. It is the caller's own.
    """

    def __init__(self, step, stage, source, fields, arrays):
        self.step, self.stage, self.source = step, stage, source
        self._fields, self._arrays = fields, arrays

    @property
    def fields(self):
        """Names of the fields that this state has."""
        return tuple(self._arrays)

    def __contains__(self, name):
        return name in self._arrays

    def __getitem__(self, name):
        try:
            return self._arrays[name]
        except KeyError:
            if any(f.name == name for f in self._fields):
                raise NotStored(f'{name} of step {self.step} is not stored: recordings hold the history in keyframes only; '
                                f'step({self.step}) simulates it with librheolog') from None
            raise KeyError(f'there is no field {name}; there are {", ".join(self._arrays)}') from None

    def __getattr__(self, name):
        if name.startswith('_'):
            raise AttributeError(name)
        try:
            return self[name]
        except KeyError as problem:
            raise AttributeError(problem.args[0]) from None

    def hash(self):
        """Hash of the state, as the program prints it. NotStored if a field is not stored."""
        arrays = {f.name: self[f.name] for f in self._fields}
        return f'{hash_of_state({f.name: hash_of_field(f, arrays) for f in self._fields}):016x}'

    def __repr__(self):
        where = f' after {self.stage}' if self.stage else ''
        return f'<state of step {self.step}{where}: {len(self.position)} particles, {self.source}>'


class States:
    """Some states of a recording, as r[a:b:c]. Each is read when it is asked for."""

    def __init__(self, recording, indices):
        self._recording, self._indices = recording, indices

    @property
    def steps(self):
        """The numbers of their steps."""
        return [self._recording.first_step + i for i in self._indices]

    def __len__(self):
        return len(self._indices)

    def __getitem__(self, index):
        if isinstance(index, slice):
            return States(self._recording, self._indices[index])
        return self._recording[self._indices[index]]

    def __iter__(self):
        return (self._recording[i] for i in self._indices)

    def __repr__(self):
        return f'<{len(self)} states of {self._recording.path}>'


# ---- The library ----


class _CError(ctypes.Structure):
    """rheo_error"""
    _fields_ = [('message', ctypes.c_char * 512)]


class _CField(ctypes.Structure):
    """rheo_field_info"""
    _fields_ = [('name', ctypes.c_char_p), ('element', ctypes.c_int), ('location', ctypes.c_int), ('components', ctypes.c_uint32),
                ('ring', ctypes.c_bool), ('rows', ctypes.c_uint64), ('items', ctypes.c_uint64), ('bytes', ctypes.c_uint64)]


class Library:
    """librheolog of one number type. RHEOLOG_LIBRARY names the file; else the system looks for it."""

    VERIFICATION_BYTES = 1 << 20  # more than rheo_verification has, whose members are not read here

    def __init__(self, real_bytes):
        ending, type_name = ('', 'float') if real_bytes == 4 else ('-double', 'double')
        self.name = os.environ.get('RHEOLOG_LIBRARY') or (
            f'librheolog{ending}.0.dylib' if sys.platform == 'darwin' else f'librheolog{ending}.so.0')
        try:
            self.shared = ctypes.CDLL(self.name)
        except OSError as problem:
            raise LibraryError(f'{self.name} cannot be loaded ({problem}); set RHEOLOG_LIBRARY to the file of the shared library '
                               f'for {type_name}') from None
        self.ending = ending.replace('-', '_')
        other = '' if self.ending else '_double'
        if not hasattr(self.shared, 'rheo_player_open' + self.ending):
            raise LibraryError(f'{self.name} is a library for {"float" if self.ending else "double"}, and the recording is of '
                               f'{type_name}; set RHEOLOG_LIBRARY to librheolog{ending}'
                               if hasattr(self.shared, 'rheo_player_open' + other) else f'{self.name} is no librheolog')

    def function(self, name, result, *arguments):
        found = getattr(self.shared, name + self.ending)
        found.restype, found.argtypes = result, arguments
        return found

    def call(self, name, *values):
        """Calls a function that returns a rheo_result and takes a rheo_error last."""
        error = _CError()
        function = getattr(self.shared, name + self.ending)
        function.restype, function.argtypes = ctypes.c_int, None
        if function(*values, ctypes.byref(error)) != 0:
            raise LibraryError(error.message.decode(errors='replace'))

    def verify(self, path):
        memory = ctypes.create_string_buffer(self.VERIFICATION_BYTES)
        self.call('rheo_verify', os.fsencode(path), memory)
        self.call('rheo_verification_check', memory, ctypes.c_uint64(0))


class Player:
    """A rheo_player and its recording."""

    def __init__(self, library, path):
        self.shared = library
        self.recording, self.player = ctypes.c_void_p(), ctypes.c_void_p()
        library.call('rheo_recording_open', os.fsencode(path), ctypes.byref(self.recording))
        close = [(library.function('rheo_recording_close', None, ctypes.c_void_p), self.recording)]
        self.close = weakref.finalize(self, Player.release, close)
        library.call('rheo_player_open', self.recording, None, ctypes.byref(self.player))
        close.insert(0, (library.function('rheo_player_close', None, ctypes.c_void_p), self.player))

    @staticmethod
    def release(close):
        for function, value in close:
            function(value)

    def go(self, step, stage):
        if stage is None:
            self.shared.call('rheo_player_seek', self.player, ctypes.c_uint64(step))
        else:
            self.shared.call('rheo_player_seek_stage', self.player, ctypes.c_uint64(step), stage.encode())

    def arrays(self):
        """The fields of the world where the player is."""
        world = ctypes.c_void_p(self.shared.function('rheo_player_world', ctypes.c_void_p, ctypes.c_void_p)(self.player))
        count = self.shared.function('rheo_world_field_count', ctypes.c_uint32, ctypes.c_void_p)
        describe = self.shared.function('rheo_world_field', ctypes.c_int, ctypes.c_void_p, ctypes.c_uint32, ctypes.c_void_p)
        read = self.shared.function('rheo_world_field_read', ctypes.c_int, ctypes.c_void_p, ctypes.c_uint32, ctypes.c_void_p,
                                     ctypes.c_size_t)
        arrays = {}
        for index in range(count(world)):
            info = _CField()
            describe(world, index, ctypes.byref(info))
            values = np.empty((info.rows, info.items, info.components), ELEMENTS[info.element].newbyteorder('='))
            if values.nbytes != info.bytes:
                raise LibraryError(f'{self.shared.name} describes fields in another way than this module; '
                                   'use those of one version')
            if read(world, index, values.ctypes.data, values.nbytes) != 0:
                raise LibraryError('there is no memory for a state')
            arrays[info.name.decode()] = values if info.ring else values[0]
        return arrays


# ---- Recordings ----


class Chunk(collections.namedtuple('Chunk', 'kind flags step at stored raw')):
    """The header of a chunk, which begins at byte `at` of the file."""

    @property
    def end(self):
        return self.at + 36 + self.stored


Checked = collections.namedtuple('Checked', 'steps keyframes states hashes complete')
Checked.__doc__ = """What verify() found in order: numbers of steps, keyframes, and stored states after steps; of hashes that were
computed again from values; and whether the file is complete."""


class _Kept:
    """Chunks of a step or keyframe."""

    def __init__(self, chunk, pending):
        self.chunk = chunk
        self.filds, self.inputs, self.stats = (pending[kind] for kind in (b'FILD', b'INPT', b'STAT'))
        self.start = min([chunk.at] + [c.at for kept in pending.values() for c in kept[:1]])


class Recording:
    """
    A recording. r[i] is the state of index i: r[0] is the first one, r[-1] the last, r[a:b:c] some of them; len(r) is their number.
    Steps have numbers: first_step to last_step.

        head        what HEAD says: scene, build, fields, stages, metrics, full, ...
        complete    False: the file was cut off, or is being written; it holds what comes before
        torn        "", or where and why a file that is not complete ends
        parameters  values of the parameters in the first state, by path: a number, or a list of numbers
        failure     None, or a dict: in which step, stage and field, and of which reason, the run failed
    """

    def __init__(self, path):
        self.path = os.fspath(path)
        self._file = io.open(path, 'rb')
        try:
            self._scan()
        except Damaged as problem:
            self._file.close()
            raise Damaged(f'{self.path}: {problem}') from None
        except BaseException:
            self._file.close()
            raise
        self._player = self._metrics = None
        self._near = (None, None)  # number and arrays of the stored state that was read last

    # ---- Chunks ----

    def _scan(self):
        """Walks over the headers of all chunks, and reads the small ones."""
        size = self._size_without_zeros()
        self.head = self.failure = None
        self.torn, self.made, self.blessings = 'it has no end mark', None, []
        self._blessed, self._made_refused, self._done, index = False, False, None, []
        self._chunks, self._keyframes, self._steps, self._failed = [], {}, [], None
        pending = {b'FILD': [], b'INPT': [], b'STAT': []}
        at = len(MAGIC)
        while at < size:
            self._file.seek(at)
            header = self._file.read(32)
            if at + 32 > size or at + 36 + struct.unpack_from('<Q', header, 16)[0] > size:
                self.torn = f'the file ends in a chunk at byte {at}'
                break
            kind, flags, step, stored, raw = struct.unpack('<4sIQQQ', header)
            chunk = Chunk(kind, flags, step, at, stored, raw)
            require(kind.isalpha() and flags < 4 and raw <= MOST_RAW_BYTES and (flags & 2 or stored == raw),
                    f'there is no chunk at byte {at}')
            self._chunks.append(chunk)
            if kind in pending:
                require(self.head is not None and not self._done and not self._failed, f'{kind.decode()} at byte {at} is misplaced')
                pending[kind].append(chunk)
            else:
                self._take(chunk, _Kept(chunk, pending), index)
                if kind in (b'KEYF', b'STEP', b'FAIL'):
                    pending = {kind: [] for kind in pending}
            at = chunk.end
        require(self._keyframes, f'the recording ends before its first state: {self.torn}')
        self.first_step, self.last_step = min(self._keyframes), self._last()
        self.complete = self._done is not None
        if self.complete:
            self.torn = ''
            kept = [(step, k.start, k.chunk.end) for step, k in self._keyframes.items()]
            require(self._done[:2] == (self.first_step, self.last_step), 'DONE has other steps')
            require(index == kept, 'INDX does not agree with the file')
            require(not any(pending.values()), 'there are chunks that no step claims')
        first = self._read_keyframe_head(self.first_step)
        self.parameters = {path: values[0] if len(values) == 1 and path != 'history.curve' else values
                           for path, values in first.parameters.items()}
        self.particles = first.particles

    def _size_without_zeros(self):
        """The size of the file without the zeros that a power failure may leave at its end (Damage)."""
        size = self._file.seek(0, os.SEEK_END)
        self._file.seek(0)
        begin = self._file.read(64)
        require(not begin.startswith(b'version https://git-lfs'),
                'this is a pointer of git-lfs; fetch the recording with git lfs pull')
        require(begin[:8] == MAGIC, 'this is not a recording')
        end, least = size, max(8, size - MOST_ZEROS)
        while end > least:
            first = max(least, end - (1 << 16))
            self._file.seek(first)
            block = self._file.read(end - first).rstrip(b'\0')
            end = first + len(block)
            if block:
                break
        self._zeros = size - end if size - end >= 16 else 0
        return size - self._zeros

    def _take(self, chunk, kept, index):
        kind, step = chunk.kind, chunk.step
        require((kind == b'HEAD') == (self.head is None), 'HEAD is not the first chunk')
        require(self._done is None, 'there are chunks after DONE')
        ending = self._failed or self.blessings
        if kind == b'HEAD':
            self.head = Head(self._read(chunk))
        elif kind == b'KEYF':
            require(not self._keyframes or step == self._last() and step not in self._keyframes and not ending,
                    f'the keyframe of step {step} is not of the last step')
            require(not kept.inputs and not kept.stats, f'the keyframe of step {step} does not match the chunks before it')
            require(step < 1 << 63, f'no run reaches step {step}')
            self._keyframes[step] = kept
        elif kind == b'STEP':
            require(self._keyframes and not ending and step == self._last() + 1,
                    f'step {self._last() + 1 if self._keyframes else step} is missing')
            require(not kept.filds and (self.head.full or not kept.stats), f'step {step} does not match the chunks before it')
            self._steps.append(kept)
        elif kind == b'FAIL':
            require(self._keyframes and not ending and step == self._last() + 1, 'FAIL is not of the step after the last')
            self._failed = Failure(self.head, step, self._read(chunk), [self._read(c) for c in kept.inputs])
            f = self._failed
            self.failure = {'step': f.step, 'stage': f.stage, 'field': f.field, 'item': LOCATIONS[f.location], 'id': f.id,
                            'component': f.component, 'reason': REASONS[f.reason] if f.reason < len(REASONS) else 'unknown',
                            'required': f.required, 'limit': f.limit,
                            'metrics': dict(zip(self.head.metrics, f.metrics))}
        elif kind in (b'MADE', b'GOLD'):
            require(not self._keyframes, f'{kind.decode()} is behind the first keyframe')
            payload = self._read(chunk)
            if kind == b'GOLD':
                self._blessed = True
            else:
                self._take_made(Cursor(payload))
        elif kind == b'BLES':
            c = Cursor(self._read(chunk))
            self.blessings.append({'because': c.text(), 'build': c.text(), 'verdict': None, 'at_least': None, 'same': None})
        elif kind == b'SAME':
            c = Cursor(self._read(chunk))
            verdict, at_least, message = c.u32(), c.u32(), c.text()
            require(self.blessings and not self.blessings[-1]['verdict'], 'SAME does not belong to a blessing')
            if 0 < verdict < len(SAMENESS) and 0 < at_least < len(SAMENESS):
                self.blessings[-1].update(verdict=SAMENESS[verdict], at_least=SAMENESS[at_least], same=message)
        elif kind == b'INDX':
            c = Cursor(self._read(chunk))
            while not c.done():
                index.append(tuple(c.u64(3)))
        elif kind == b'DONE':
            require(self._keyframes and not self._zeros, 'DONE is not the end of a recording')
            c = Cursor(self._read(chunk))
            first, last, state_hash = c.u64(3)
            self._done = (first, last, state_hash if c.u32() else None)
        else:
            require(chunk.flags & 1, f'there is no chunk type {kind.decode()} in this version')

    def _take_made(self, c):
        try:
            self.made = [c.take(c.u32()).decode() for _ in range(2)]
        except UnicodeDecodeError:
            self.made = ['\0']
        shown = [not any(ord(l) < 32 and l not in also or 127 <= ord(l) < 160 for l in text)
                 for text, also in zip(self.made, ('', '\n\t'))]
        if not all(shown) or any(len(text.encode()) > 8000000 for text in self.made):
            self.made, self._made_refused = None, True

    def _last(self):
        return self._steps[-1].chunk.step if self._steps else min(self._keyframes)

    def _read(self, chunk):
        """The payload of a chunk, as it was before compression."""
        self._file.seek(chunk.at)
        data = self._file.read(36 + chunk.stored)
        where = f'the chunk {chunk.kind.decode()} at byte {chunk.at}'
        require(len(data) == 36 + chunk.stored, f'{where} is no longer there')
        require(zlib.crc32(data[:-4]) == struct.unpack_from('<I', data, len(data) - 4)[0], f'the CRC of {where} is wrong')
        payload = data[32:-4]
        if chunk.flags & 2:
            stream = zlib.decompressobj()
            try:
                payload = stream.decompress(payload, chunk.raw + 1)
            except zlib.error as problem:
                raise Damaged(f'{where} is no zlib stream: {problem}') from None
            require(stream.eof and not stream.unused_data, f'{where} is no whole zlib stream')
        require(len(payload) == chunk.raw, f'{where} has a wrong size')
        return payload

    def _read_keyframe_head(self, step):
        return Keyframe(self.head, step, self._read(self._keyframes[step].chunk))

    # ---- What the file holds, chunk by chunk ----

    def read_keyframe(self, step):
        """The keyframe of a step, with its values."""
        kept = self._keyframes[step]
        return Keyframe(self.head, step, self._read(kept.chunk), [self._read(c) for c in kept.filds])

    def read_step(self, number):
        """STEP and the chunks that it commits."""
        kept = self._steps[number - self.first_step - 1]
        return Step(self.head, number, self._read(kept.chunk), [self._read(c) for c in kept.inputs],
                    [self._read(c) for c in kept.stats])

    def read_failure(self):
        """FAIL, or None."""
        return self._failed

    @property
    def keyframes(self):
        """The steps of the keyframes."""
        return list(self._keyframes)

    @property
    def stored(self):
        """The steps whose states the file holds; others are simulated by librheolog."""
        return range(self.first_step, self.last_step + 1) if self.head.full else self.keyframes

    @property
    def state_hash(self):
        """The hash of the last state as the end of the file says; None: not known."""
        return None if self._done is None or self._done[2] is None else f'{self._done[2]:016x}'

    # ---- Metrics ----

    @property
    def steps(self):
        """The numbers of the steps."""
        return range(self.first_step, self.last_step + 1)

    @property
    def metrics(self):
        """A dict of arrays with one value for each state. The column `step` has the numbers of the steps."""
        if self._metrics is None:
            count = len(self.head.metrics)
            rows = np.empty((len(self), count))
            rows[0] = self._read_keyframe_head(self.first_step).metrics
            for row, kept in zip(rows[1:], self._steps):
                payload = self._read(kept.chunk)
                require(len(payload) >= 8 + 8 * count, f'STEP of step {kept.chunk.step} ends early')
                row[:] = np.frombuffer(payload, '<f8', count, len(payload) - 8 * count)
            self._metrics = rows
        columns = {'step': np.arange(self.first_step, self.last_step + 1)}
        columns.update((name, self._metrics[:, i].copy()) for i, name in enumerate(self.head.metrics) if name != 'step')
        return columns

    def frame(self):
        """The metrics as a DataFrame of pandas, whose index is the step."""
        import pandas
        return pandas.DataFrame(self.metrics).set_index('step')

    # ---- What was done ----

    @property
    def commands(self):
        """The commands in their order, as dicts with step, kind and, by kind, the members that `rheolog log --json` has."""
        found = [Command(self._read(c), self.head.real).described(kept.chunk.step) for kept in self._steps for c in kept.inputs]
        return found + ([c.described(self._failed.step) for c in self._failed.commands] if self._failed else [])

    @property
    def provenance(self):
        """How the recording came to be, as `rheolog log --json` names it, and the scene file as text (None: not stored)."""
        made_by, scene_text = ([text or None for text in self.made] + [None])[:2] if self.made else (None, None)
        return {'scene': self.head.scene, 'model': 'melting' if self.head.features & MELTING else 'thickening',
                'particles': self.particles, 'made_by': made_by, 'scene_text': scene_text, 'build': self.head.build,
                'format': self.head.version, 'real_bytes': self.head.real_bytes, 'first_step': self.first_step,
                'blessed': self._blessed or bool(self.blessings), 'blessings': [dict(b) for b in self.blessings],
                'made_refused': self._made_refused, 'ending': self.ending}

    @property
    def ending(self):
        """complete, truncated, failed, or being_written."""
        if self.complete:
            return 'failed' if self.failure else 'complete'
        if fcntl:
            try:
                fcntl.flock(self._file, fcntl.LOCK_SH | fcntl.LOCK_NB)
                fcntl.flock(self._file, fcntl.LOCK_UN)
            except BlockingIOError:
                return 'being_written'
            except OSError:  # a file system without locks
                pass
        return 'truncated'

    # ---- States ----

    def __len__(self):
        return self.last_step - self.first_step + 1

    def __iter__(self):
        return (self[i] for i in range(len(self)))

    def __getitem__(self, index):
        if isinstance(index, slice):
            return States(self, range(len(self))[index])
        index = operator.index(index)
        if not -len(self) <= index < len(self):
            raise IndexError(f'there is no state {index}; {self.path} has {len(self)}')
        step = self.first_step + range(len(self))[index]
        if step in self._keyframes:
            return self._state(step, 'keyframe', self._keyframe_arrays(step))
        if self.head.full:
            return self._state(step, 'stored', self._stored_arrays(step))
        try:
            return self.step(step)
        except LibraryError as problem:
            if self._player is None:
                raise NotStored(f'the state of step {step} is not stored, and cannot be simulated: {problem}. Stored are the '
                                f'states of {self._stored_text()}') from None
            raise

    def step(self, number, stage=None):
        """
        The state after a step, by number, simulated by librheolog from the nearest keyframe and compared with the recorded hashes.
        Or the state inside of the step, right after a stage: 'neighbours'; of a stage that runs in each substep the first, or
        'viscosity@3'. r.stages lists them. The step that failed can be entered, too.
        """
        number = operator.index(number)
        last = self.failure['step'] if self.failure and stage is not None else self.last_step
        if not self.first_step <= number <= last:
            raise IndexError(f'there is no step {number}; {self.path} has {self.first_step} to {last}')
        if self._player is None:
            self._player = Player(Library(self.head.real_bytes), self.path)
        self._player.go(number, stage)
        return self._state(number, stage, self._player.arrays(), 'simulated')

    @property
    def stages(self):
        """The names of the stages, in the order of a step."""
        return [s.name for s in self.head.stages]

    def _state(self, step, stage_or_source, arrays, source=None):
        stage = stage_or_source if source else None
        arrays = {f.name: arrays[f.name] for f in self.head.fields if f.name in arrays}
        return State(step, stage, source or stage_or_source, self.head.fields, arrays)

    def _keyframe_arrays(self, step):
        """The values of a keyframe whose hashes are right; rows of a history become one array."""
        frame = self.read_keyframe(step)
        frame.check(self.head)
        return {f.name: frame.values[f.name] if f.storage in (FLAT, SPRING) else
                np.stack(frame.values[f.name]) if frame.values[f.name] else np.zeros((0, frame.particles, f.components), f.dtype)
                for f in self.head.fields}

    def _stored_arrays(self, step):
        """The flat fields and springs of a full recording after a step that has no keyframe: the caller's own."""
        base = max(s for s in self._keyframes if s <= step)
        near, arrays = self._near
        if near is None or not base <= near <= step:
            near, arrays = base, self._keyframe_arrays(base)
        while near < step:
            near += 1
            arrays = self._next_arrays(self.read_step(near), arrays)[0]
        self._near = (step, arrays)
        return {name: values.copy() for name, values in arrays.items()}

    def _next_arrays(self, step, before):
        """The state after a step of a full recording, and how many of its hashes were compared."""
        arrays = state_after(self.head, step, before)
        compared = 0
        for index, expected in step.last_hashes(self.head).items():
            field = self.head.fields[index]
            if field.name in arrays:
                require(hash_of_field(field, arrays) == expected,
                        f'step {step.number}: {field.name} does not have the recorded hash')
                compared += 1
        return arrays, compared

    def _stored_text(self):
        steps = list(self.stored)
        if len(steps) <= 8:
            return 'step ' + str(steps[0]) if len(steps) == 1 else 'steps ' + ', '.join(map(str, steps))
        return f'steps {", ".join(map(str, steps[:4]))} ... {steps[-1]} ({len(steps)} in all)'

    # ---- Checks ----

    def check_sums(self):
        """Reads every chunk and compares its check sum, CRC-32."""
        for chunk in self._chunks:
            self._read(chunk)

    def verify(self, simulate=False):
        """
        Reads every chunk, compares its check sum, and computes the hashes of all stored states again from their values. Raises
        Damaged where something is wrong. Returns Checked: what was compared. A file that was cut off is checked up to there.

        simulate: librheolog also makes every step again and compares all hashes; LibraryError tells the first difference. It
        refuses files that are not complete.
        """
        self.check_sums()
        hashes = states = 0
        before = None
        for number in self.steps:
            frame = self.read_keyframe(number) if number in self._keyframes else None
            last = {}
            if number > self.first_step:
                step = self.read_step(number)
                last = step.last_hashes(self.head)
                if self.head.full:
                    before, compared = self._next_arrays(step, before)
                    hashes, states = hashes + compared, states + 1
            if frame:
                frame.check(self.head)
                hashes += len(self.head.fields)
                for index, expected in last.items():
                    if self.head.fields[index].storage != RING:  # STEP has the hash of its newest row only
                        require(frame.hashes[index] == expected,
                                f'keyframe of step {number}: the step has another hash of {self.head.fields[index].name}')
                before = frame.values
        if self.last_step in self._keyframes and self.state_hash is not None:
            frame = self._read_keyframe_head(self.last_step)
            found = hash_of_state({f.name: h for f, h in zip(self.head.fields, frame.hashes)})
            require(found == self._done[2], 'the state at the end does not have the recorded hash')
            hashes += 1
        if simulate:
            Library(self.head.real_bytes).verify(self.path)
        return Checked(len(self._steps), len(self._keyframes), states, hashes, self.complete)

    def close(self):
        self._file.close()
        if self._player:
            self._player.close()
            self._player = None

    def __enter__(self):
        return self

    def __exit__(self, *problem):
        self.close()

    def __repr__(self):
        return f'<recording {self.path}: {self.head.scene}, steps {self.first_step} to {self.last_step}, {self.ending}>'


def open(path):
    """Opens a recording (Recording). A file that was cut off opens if its first state is complete."""
    return Recording(path)
