"""Reads recordings (docs/format.md). Refuses whatever that page does not allow."""
import struct
import zlib

import numpy as np

MAGIC = b'\x89RLOG\r\n\x1a'
ELEMENTS = {0: np.dtype('<f4'), 1: np.dtype('<f8'), 2: np.dtype('<u4'), 3: np.dtype('<u8')}
FLAT, SPRING, RING, MODES = range(4)
WORLD, PARTICLE, SPRINGS, BODY, VIBRATOR = range(5)


class Damaged(Exception):
    pass


def require(condition, message):
    if not condition:
        raise Damaged(message)


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
        values = struct.unpack(f'<{count or 1}{letter}' if count != 0 else '', self.take(size * (1 if count is None else count)))
        return values[0] if count is None else list(values)

    def u32(self, count=None):
        return self.get('I', count)

    def u64(self, count=None):
        return self.get('Q', count)

    def f64(self, count=None):
        return self.get('d', count)

    def text(self):
        return self.take(self.get('H')).decode()

    def planes(self, count, dtype):
        """Byte planes."""
        data = np.frombuffer(self.take(count * dtype.itemsize), dtype=np.uint8).reshape(dtype.itemsize, count)
        return np.ascontiguousarray(data.T).view(dtype).reshape(count)

    def packed_halves(self):
        """One group of eight values of 32 bits (Packed values)."""
        bits = self.take(1)[0]
        require(bits <= 32, 'a group of packed values has more than 32 bits')
        number = int.from_bytes(self.take(bits), 'little')
        return [number >> bits * k & (1 << bits) - 1 for k in range(8)]

    def packed(self, count, dtype):
        values = []
        while len(values) < count:
            low = self.packed_halves()
            high = self.packed_halves() if dtype.itemsize == 8 else [0] * 8
            values += [a | b << 32 for a, b in zip(low, high)]
        return np.array(values[:count], dtype='<u8').astype(f'<u{dtype.itemsize}')

    def done(self):
        return self.at == len(self.payload)


class Field:
    """A field entry of HEAD."""

    def __init__(self, c):
        self.name = c.text()
        element, self.components, self.location, self.storage = c.u32(4)
        self.dtype = ELEMENTS[element]


class Stage:
    """A stage entry of HEAD."""

    def __init__(self, c):
        self.name, self.phase = c.text(), c.u32()
        self.writes = c.u32(c.u32())


class Head:
    def __init__(self, payload):
        c = Cursor(payload)
        self.version, self.real_bytes, self.full = c.u32(3)
        require(self.version == 5, f'this reads version 5 of the format, not {self.version}')
        self.real = {4: np.float32, 8: np.float64}[self.real_bytes]
        self.keyframe_spacing = c.u64()
        self.scene, self.build, self.features = c.text(), c.text(), c.u32()
        self.walls = [(c.f64(3), c.f64(3)) for _ in range(c.u32())]
        self.vibrators = [c.f64(2) for _ in range(c.u32())]
        self.fields = [Field(c) for _ in range(c.u32())]
        self.stages = [Stage(c) for _ in range(c.u32())]
        self.metrics = [c.text() for _ in range(c.u32())]
        require(c.done(), 'HEAD has bytes left over')

    def hashes_of(self, phase):
        return sum(len(s.writes) for s in self.stages if s.phase == phase)


class Keyframe:
    def __init__(self, head, step, payload, filds):
        c = Cursor(payload)
        self.step = step
        self.particles, self.bodies, self.vibrators, self.springs, self.history_rows, count = c.u64(6)
        require(count == len(filds), 'KEYF claims another number of FILD chunks')
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
        self.values = self.read_fields(head, filds)

    def items(self, field):
        return [1, self.particles, self.springs, self.bodies, self.vibrators][field.location]

    def read_fields(self, head, filds):
        """Values by name: items x components of a flat field or springs, a list of such rows of rings and modes (FILD)."""
        arrays = join(pieces(filds, lambda c, field, part, count: c.planes(count, head.fields[field].dtype)))
        values = {}
        for index, field in enumerate(head.fields):
            rows = []
            while (index, len(rows)) in arrays:
                rows.append(arrays.pop((index, len(rows))).reshape(-1, field.components))
                require(len(rows[-1]) == self.items(field), f'{field.name} has another number of items')
            if field.storage in (FLAT, SPRING):
                require(len(rows) == (self.items(field) > 0), f'{field.name} is missing')
                values[field.name] = rows[0] if rows else np.zeros((0, field.components), field.dtype)
            else:
                require(field.storage == MODES or len(rows) == self.history_rows or self.particles == 0,
                        f'{field.name} has another number of rows')
                values[field.name] = rows
        require(not arrays, 'FILD holds an array of no field')
        return values


def pieces(payloads, read):
    """The pieces of some chunks: ((field, part), first, values)."""
    for payload in payloads:
        c = Cursor(payload)
        while not c.done():
            field, part = c.u32(2)
            first, count = c.u64(2)
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


class Step:
    """STEP with the chunks that it commits."""

    def __init__(self, head, number, payload, inputs, stats):
        c = Cursor(payload)
        self.number = number
        require(c.u32() == len(inputs), 'STEP claims another number of INPT chunks')
        require(c.u32() == len(stats), 'STEP claims another number of STAT chunks')
        count = (len(payload) - 8) // 8 - len(head.metrics)
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
        """(stage, substep or 0) in the order of a step."""
        runs = [(s, 0) for s in head.stages if s.phase == 0]
        for substep in range(self.substeps):
            runs += [(s, substep + 1) for s in head.stages if s.phase == 1]
        return runs + [(s, 0) for s in head.stages if s.phase == 2]


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
        require(c.done(), 'FAIL has bytes left over')


class Recording:
    """All of a complete recording: head, made, keyframe (the first), steps, failure, blessings, state_hash."""

    def __init__(self, path):
        with open(path, 'rb') as f:
            self.bytes = f.read()
        require(self.bytes[:8] == MAGIC, 'this is not a recording')
        self.head = self.made = self.keyframe = self.failure = self.state_hash = None
        self.steps, self.blessings, self.index, self.starts = [], [], [], []
        waiting = {b'FILD': [], b'INPT': [], b'STAT': []}
        first_fild = None
        for kind, at, end, step, payload in self.chunks():
            if kind in waiting:
                first_fild = at if kind == b'FILD' and not waiting[kind] else first_fild
                waiting[kind].append(payload)
                continue
            if kind == b'KEYF':
                self.starts.append((step, first_fild if waiting[b'FILD'] else at, end))
            self.take(kind, step, payload, waiting)
            for committed in {b'KEYF': [b'FILD'], b'STEP': [b'INPT', b'STAT'], b'FAIL': [b'INPT']}.get(kind, []):
                waiting[committed] = []
        require(self.state_hash is not None, 'the recording is not complete')
        require(self.index == self.starts, 'INDX does not agree with the file')

    def chunks(self):
        """Chunks. A payload that is stored as a zlib stream is inflated."""
        at = len(MAGIC)
        while at < len(self.bytes):
            require(at + 32 <= len(self.bytes), 'the file ends in a chunk')
            kind, flags, step, stored, raw = struct.unpack_from('<4sIQQQ', self.bytes, at)
            end = at + 36 + stored
            require(end <= len(self.bytes), 'the file ends in a chunk')
            require(zlib.crc32(self.bytes[at:end - 4]) == struct.unpack_from('<I', self.bytes, end - 4)[0],
                    f'the CRC of the chunk at byte {at} is wrong')
            payload = self.bytes[at + 32:end - 4]
            payload = zlib.decompress(payload) if flags & 2 else payload
            require(flags < 4 and len(payload) == raw, f'the chunk at byte {at} has a wrong size')
            if kind == b'MADE' or not flags & 1:
                yield kind, at, end, step, payload
            at = end

    def take(self, kind, step, payload, waiting):
        require((kind == b'HEAD') == (self.head is None), 'HEAD is not the first chunk')
        require(self.state_hash is None, 'there are chunks after DONE')
        if kind == b'HEAD':
            self.head = Head(payload)
        elif kind == b'KEYF':
            frame = Keyframe(self.head, step, payload, waiting[b'FILD'])
            if self.keyframe is None:
                self.keyframe = frame
            else:
                require(step == self.last_step(), 'a keyframe is not of the last step')
                self.steps[-1].keyframe = frame
        elif kind == b'STEP':
            require(step == self.last_step() + 1, f'step {self.last_step() + 1} is missing')
            self.steps.append(Step(self.head, step, payload, waiting[b'INPT'], waiting[b'STAT']))
        elif kind == b'FAIL':
            self.failure = Failure(self.head, step, payload, waiting[b'INPT'])
        elif kind == b'MADE':
            require(self.keyframe is None, 'MADE is behind the first keyframe')
            c = Cursor(payload)
            self.made = [c.take(c.u32()).decode() for _ in range(2)]
            require(c.done() and '\0' not in ''.join(self.made), 'MADE holds other texts')
        elif kind == b'BLES':
            c = Cursor(payload)
            self.blessings.append((c.text(), c.text()))
        elif kind == b'INDX':
            c = Cursor(payload)
            while not c.done():
                self.index.append(tuple(c.u64(3)))
        elif kind == b'DONE':
            c = Cursor(payload)
            first, last, self.state_hash = c.u64(3)
            self.state_hash = self.state_hash if c.u32() else 0
            require((first, last) == (self.keyframe.step, self.last_step()), 'DONE has other steps')
        else:
            raise Damaged(f'there is no chunk type {kind}')

    def last_step(self):
        return self.steps[-1].number if self.steps else self.keyframe.step


def unfold(expected, folded):
    """The reals at these folded differences from the expected ones (STAT). All integers are modulo 2^32 or 2^64."""
    unsigned = folded.dtype.type
    one, top = unsigned(1), unsigned(1 << 8 * folded.dtype.itemsize - 1)
    bits = np.ascontiguousarray(expected).view(folded.dtype)
    a = np.where(bits & top, ~bits, bits | top)
    b = a + ((folded >> one) ^ (~(folded & one) + one))
    return np.where(b & top, b & ~top, ~b).view(expected.dtype)


def state_after(head, step, before):
    """
    The state at the end of a step of a full recording (STAT): flat fields and springs, by name. before: those of the old state.
    """
    names = {i: f for i, f in enumerate(head.fields)}

    def read(c, field, part, count):
        dtype = np.dtype('<u8') if field == 65536 else np.dtype('<u4') if names[field].name == 'spring_ends' else names[field].dtype
        return c.packed(count, dtype)
    arrays = join(pieces(step.stats, read))
    counts = arrays[65536, 0]
    particles, bodies, vibrators = counts[:3].tolist()
    dt = head.real(counts[5:6].view('<f8')[0])
    after = {}
    for index, field in sorted(names.items(), key=lambda e: e[1].name != 'velocity'):
        items = [1, particles, 0, bodies, vibrators][field.location]
        stored = arrays.get((index, 0), np.zeros(0, f'<u{field.dtype.itemsize}'))
        if field.storage == FLAT and field.location == PARTICLE and field.dtype == head.real:
            expected = np.zeros((items, field.components), field.dtype)
            expected[:len(before[field.name])] = before[field.name]
            if field.name == 'position':
                expected = expected + dt * after['velocity']
            after[field.name] = unfold(expected.reshape(-1), stored).reshape(items, field.components)
        elif field.storage == FLAT:
            after[field.name] = stored.view(field.dtype).reshape(items, field.components)
    if 'spring_ends' in before:
        springs(after, before, arrays, {f.name: i for i, f in names.items()}, counts)
    return after


def springs(after, before, arrays, index, counts):
    """The springs of a full recording (STAT, the last three arrays)."""
    none = np.zeros(0, '<u4')
    removed = set(arrays.get((index['spring_ends'], 0), none).tolist())
    new = arrays.get((index['spring_ends'], 1), none).reshape(-1, 2).tolist()
    require((len(removed), len(new)) == tuple(counts[3:5].tolist()), 'STAT has another number of springs')
    real = before['spring_rest_length'].dtype
    old = [(tuple(e), length) for n, (e, length) in enumerate(zip(before['spring_ends'].tolist(),
                                                                before['spring_rest_length'].reshape(-1))) if n not in removed]
    all_springs = sorted(old + [(tuple(e), real.type(0)) for e in new], key=lambda s: s[0])
    after['spring_ends'] = np.array([s[0] for s in all_springs], dtype='<u4').reshape(-1, 2)
    expected = np.array([s[1] for s in all_springs], dtype=real)
    folded = arrays.get((index['spring_rest_length'], 0), np.zeros(0, f'<u{real.itemsize}'))
    after['spring_rest_length'] = unfold(expected, folded).reshape(-1, 1)
