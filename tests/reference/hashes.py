"""Hashes of fields and states (docs/format.md, Hashes)."""
import numpy as np

MASK = (1 << 64) - 1
FIELDS = ['step', 'step_origin', 'time_origin', 'position', 'velocity', 'spring_ends', 'spring_rest_length', 'ball_position',
          'ball_velocity', 'ball_spin', 'ball_orientation', 'vibrator_position', 'vibrator_phase', 'vibrator_frequency', 'random',
          'history_rows', 'history_velocity', 'history_modes', 'density', 'temperature', 'start_position', 'substeps', 'iterations',
          'derivative', 'list_position', 'list_margin', 'predicted_acceleration', 'material', 'ball_push_phase',
          'history_position', 'plate', 'plate_displacement', 'plate_velocity', 'plate_phase']
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


KEYS = np.zeros(0, np.uint64)


def key(i):
    product = (0xA0761D6478BD642F ^ i) * 0xE7037ED1A0B428DB
    return ((product & MASK) ^ (product >> 64)) & ~3 | 1


def keys(ids):
    """key() of each id."""
    global KEYS
    most = int(ids.max()) + 1 if len(ids) else 0
    if most > len(KEYS):
        KEYS = np.concatenate([KEYS, np.array([key(i) for i in range(len(KEYS), most)], dtype=np.uint64)])
    return KEYS[ids]


def lengths(values):
    """length() of each rest length."""
    if values.dtype == np.float32:
        b = values.view(np.uint32).astype(np.uint64) + u64(0x2545F491)
        return b * b
    return finish_all(values.view(np.uint64))


def field(total_of_words, rows, items):
    return finish(total_of_words + word(rows, items, 0))


def words_of_row(values):
    data = np.ascontiguousarray(values).tobytes()
    return np.frombuffer(data + b'\0' * (-len(data) % 8), dtype='<u8').astype(np.uint64)


def of_rows(rows, items):
    """Hash of a field of rows; a flat field has one."""
    result = 0
    for row, values in enumerate(rows):
        w = words_of_row(values)
        places = (np.arange(len(w), dtype=np.uint64) + u64(1)) * u64(OF_WORD) + u64(row * OF_ROW)
        result += total(finish_all(w ^ places))
    return field(result, len(rows), items)


def of_spring_ends(ends):
    k = keys(ends.reshape(-1)).reshape(-1, 2)
    return field(total(k[:, 0] * k[:, 1]), 1, len(ends))


def of_rest_lengths(ends, values):
    k = keys(ends.reshape(-1)).reshape(-1, 2)
    return field(total((k[:, 0] + k[:, 1]) * lengths(values)), 1, len(ends))


def of_state(hash_of_field):
    """Hash of a state from the hashes of the fields that it has, by name."""
    return finish(sum(word(0, FIELDS.index(name), value) for name, value in hash_of_field.items()))
