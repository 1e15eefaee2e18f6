#!/usr/bin/env python3
"""
Tests of src/python/rheolog.py. What it reads is compared with what the program prints and what the library of this build computes.

    test_python.py SOURCE PROGRAM LIBRARY REAL RECORDER [--write]       --write: only makes docs/python.md and its plots again
"""
import csv
import glob
import io
import json
import os
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib

import numpy as np
import rheolog

SOURCE, PROGRAM, LIBRARY, REAL, RECORDER = map(os.path.abspath, sys.argv[1:6])
REAL = sys.argv[4]
EVERY = int(os.environ.get('RHEOLOG_TEST_EVERY', '1'))
FOLDER = tempfile.mkdtemp()
os.environ['RHEOLOG_LIBRARY'] = LIBRARY


def program(*arguments, codes=(0,)):
    """What the program prints."""
    done = subprocess.run([PROGRAM, *map(str, arguments)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False)
    if done.returncode not in codes:
        raise AssertionError(f'{arguments} ends with {done.returncode}: {done.stderr.decode()}')
    return done.stdout.decode()


def objects(*arguments):
    """The JSON objects that the program prints, one a line."""
    return [json.loads(line) for line in program(*arguments, '--json').splitlines()]


def path(name):
    return os.path.join(FOLDER, name)


def record(name, *arguments):
    program('run', *arguments, '--quiet', '-o', path(name))


def make_recordings():
    record('sparse.rlog', 'bowling-ball-small', '--set', 'particles=300', '--steps', 20, '--keyframes', 8)
    record('full.rlog', 'vibration', '--set', 'particles=300', '--steps', 20, '--keyframes', 8, '--full')
    record('modes.rlog', 'drop', '--set', 'resolution=0.4', '--set', 'history.kind=tempered', '--steps', 6, '--keyframes', 3)
    record('melting.rlog', 'melting-drop', '--set', 'resolution=0.4', '--steps', 6, '--full')
    record('later.rlog', '--from', path('sparse.rlog') + '@12', '--steps', 6, '--set', 'gravity=[0, -5, 1]')
    program('run', 'bowling-ball-small', '--set', 'particles=300', '--set', 'scheme=sequential', '--set', 'springs.stiffness=400',
            '--set', 'history.stiffness=40000', '--steps', 100, '--quiet', '-o', path('failing.rlog'), codes=(1,))
    program('checkpoint', path('sparse.rlog'), '--step', 12, '-o', path('checkpoint.rlog'))
    os.mkdir(path('made'))
    subprocess.run([RECORDER, path('made')], check=True, stdout=subprocess.DEVNULL)


def made():
    return sorted(glob.glob(path('made/*.rlog')))


def every_recording():
    own = ['sparse', 'full', 'modes', 'melting', 'later', 'failing', 'checkpoint']
    return [path(name + '.rlog') for name in own] + made()


def content(name):
    with open(path(name), 'rb') as f:
        return f.read()


def write(data):
    with open(path('changed.rlog'), 'wb') as f:
        f.write(data)
    return path('changed.rlog')


class Chunks:
    """A recording as a list of [kind, step, payload], to change and write again with right check sums and positions."""

    def __init__(self, name):
        with rheolog.open(path(name)) as r:
            self.list = [[c.kind, c.flags & 1, c.step, bytearray(r._read(c))] for c in r._chunks]

    def find(self, kind, nth=0):
        return [c for c in self.list if c[0] == kind][nth][3]

    def written(self):
        data, keyframes, start = bytearray(rheolog.MAGIC), [], None
        for kind, flags, step, payload in self.list:
            start = len(data) if start is None or kind not in (b'FILD', b'KEYF') else start
            if kind == b'INDX':
                payload = b''.join(struct.pack('<QQQ', *k) for k in keyframes)
            chunk = struct.pack('<4sIQQQ', kind, flags, step, len(payload), len(payload)) + payload
            data += chunk + struct.pack('<I', zlib.crc32(chunk))
            if kind == b'KEYF':
                keyframes.append((step, start, len(data)))
            start = start if kind == b'FILD' else None
        return write(data)


# The page. A block in Python may be followed by a block of text: what it prints.

PAGE = SOURCE + '/docs/python.md'
BLOCK = re.compile(r'^```python\n(.*?)^```\n(?:\n```text\n(.*?)^```\n)?', re.S | re.M)
RUN_BLOCKS = """
import contextlib, io, json, sys
names, printed = {}, []
for block in json.load(sys.stdin):
    with contextlib.redirect_stdout(io.StringIO()) as output:
        exec(block, names)
    printed.append(output.getvalue())
print(json.dumps(printed))
"""


def page():
    with open(PAGE, encoding='utf-8') as f:
        return f.read()


def page_blocks():
    return BLOCK.findall(page())


def page_plots():
    return re.findall(r'!\[.*?\]\((.*?)\)', page())


def run_page(blocks, folder):
    """What each block in Python prints, after the commands of the page have made the recordings."""
    os.mkdir(folder + '/bin')
    os.symlink(PROGRAM, folder + '/bin/rheolog')
    with open(folder + '/matplotlibrc', 'w', encoding='ascii') as f:
        f.write('backend: svg\nsvg.hashsalt: rheolog\n')  # the same bytes each time
    environment = dict(os.environ, PATH=folder + '/bin:' + os.environ['PATH'], MPLCONFIGDIR=folder, SOURCE_DATE_EPOCH='0')
    for commands in re.findall(r'^```sh\n(.*?)^```$', page(), re.S | re.M):
        subprocess.run(['sh', '-ec', commands], cwd=folder, env=environment, check=True, stdout=subprocess.DEVNULL,
                       stderr=subprocess.DEVNULL)
    done = subprocess.run([sys.executable, '-c', RUN_BLOCKS], input=json.dumps(blocks).encode(), cwd=folder, env=environment,
                          stdout=subprocess.PIPE, check=True)
    return json.loads(done.stdout)


def write_page():
    """Replaces what the page prints, and its plots, by what this build makes. Needs pandas and matplotlib."""
    printed = iter(run_page([text for text, _ in page_blocks()], FOLDER))

    def block(match):
        output = next(printed)
        return f'```python\n{match.group(1)}```\n' + (f'\n```text\n{output}```\n' if output else '')
    text = BLOCK.sub(block, page())
    with open(PAGE, 'w', encoding='utf-8') as f:
        f.write(text)
    for plot in page_plots():
        shutil.copy(os.path.join(FOLDER, os.path.basename(plot)), os.path.join(SOURCE, 'docs', plot))


class Tests(unittest.TestCase):

    def refused(self, text, call, kind=rheolog.Damaged):
        with self.assertRaises(kind) as problem:
            call()
        self.assertIn(text, str(problem.exception))

    def same(self, a, b, where):
        self.assertEqual((a.dtype.str, a.shape, a.tobytes()), (b.dtype.str, b.shape, b.tobytes()), where)

    # ---- States ----

    def test_every_field_of_every_stored_state_is_that_of_the_library(self):
        compared = 0
        for name in every_recording():
            with rheolog.open(name) as r:
                for step in r.stored:
                    stored, simulated = r[step - r.first_step], r.step(step)
                    self.assertIn(stored.source, ('keyframe', 'stored'))
                    self.assertEqual(set(simulated.fields), {f.name for f in r.head.fields})
                    for field in stored.fields:
                        self.same(stored[field], simulated[field], f'{name}: {field} of step {step}')
                        compared += 1
        self.assertGreater(compared, 1500)

    def test_fields_are_rows_in_the_number_type_of_the_recording(self):
        with rheolog.open(path('sparse.rlog')) as r:
            real = np.dtype({'float': '<f4', 'double': '<f8'}[REAL])
            for state in (r[0], r[1]):
                self.assertEqual(state.position.dtype, real)
                self.assertEqual(state.position.shape, (r.particles, 3))
                self.assertEqual(state.ball_orientation.shape, (1, 4))
                self.assertEqual((state.spring_ends.shape[1], state.spring_ends.dtype), (2, np.dtype('<u4')))
                self.assertEqual(state['step'].tolist(), [[state.step]])
            self.assertEqual(r[-1].history_velocity.shape, (r.step(20).history_rows[0, 0], r.particles, 3))

    def test_states_that_are_not_stored_are_simulated(self):
        with rheolog.open(path('sparse.rlog')) as r:
            self.assertEqual(r.stored, [0, 8, 16])
            self.assertEqual([s.source for s in r[7:10]], ['simulated', 'keyframe', 'simulated'])
            for step in (5, 8, 19):
                said = objects('inspect', r.path, '--step', step, '--particle', 17)[0]
                self.assertEqual(r[step].hash(), said['hash'])
                self.assertEqual(r[step].position[17].tolist(), said['particle']['position'])
                self.assertEqual(r[step].velocity[17].tolist(), said['particle']['velocity'])

    def test_hashes_of_keyframes_are_those_that_the_program_prints(self):
        for name in ('sparse', 'modes', 'melting', 'later', 'checkpoint'):
            with rheolog.open(path(name + '.rlog')) as r:
                self.assertEqual(r[0].hash(), objects('inspect', r.path, '--step', r.first_step)[0]['hash'])

    def test_fields_are_those_of_export_csv(self):
        program('export', path('full.rlog'), '-o', path('csv'), '--format', 'csv', '--step', 13)
        with open(path('csv/full_000013.csv'), encoding='ascii', newline='') as f:
            rows = list(csv.DictReader(f))
        with rheolog.open(path('full.rlog')) as r:
            state = r[13]
            self.assertEqual(state.source, 'stored')
            self.assertEqual(len(rows), len(state.position))
            for field, columns in (('position', ['x', 'y', 'z']), ('velocity', ['vx', 'vy', 'vz']),
                                   ('list_margin', ['list_margin'])):
                told = np.array([[row[c] for c in columns] for row in rows], dtype=float)
                np.testing.assert_allclose(told, state[field], rtol=1e-7, atol=0)

    def test_states_in_the_middle_of_a_step_have_the_hash_that_inspect_prints(self):
        for name, stages in (('sparse', ('neighbours', 'viscosity', 'forces', 'forces@2', 'history')), ('melting', ('momentum',))):
            with rheolog.open(path(name + '.rlog')) as r:
                hashes = [r.step(3).hash()]
                for stage in stages:
                    state = r.step(4, stage=stage)
                    self.assertEqual(state.stage, stage)
                    self.assertEqual(state.hash(), objects('inspect', r.path, '--step', 4, '--stage', stage)[0]['hash'])
                    hashes.append(state.hash())
                if name == 'sparse':  # after the last stage, which runs once, the step is done
                    self.assertEqual(hashes[-1], r.step(4).hash())
                self.assertGreater(len(set(hashes)), len(stages) / 2)
                self.refused('no stage', lambda: r.step(4, stage='nonsense'), rheolog.LibraryError)

    def test_arrays_are_copies(self):
        for name, index in (('full', 3), ('full', 8), ('sparse', 3)):
            with rheolog.open(path(name + '.rlog')) as r:
                first, second = r[index], r[index]
                kept = second.position.copy()
                self.assertFalse(np.shares_memory(first.position, second.position))
                first.position[:] = 7
                self.same(second.position, kept, name)
                self.same(r[index].position, kept, name)
                r.metrics['max_speed'][:] = 7
                self.assertFalse((r.metrics['max_speed'] == 7).all())
                self.same(r[index + 1].velocity, r.step(index + 1).velocity, name)

    def test_states_of_a_full_recording_are_the_same_in_any_order(self):
        with rheolog.open(path('full.rlog')) as r:
            forwards = [s.position for s in r]
            for i in (20, 3, 9, 8, 7, 15, 0, 19):
                self.same(r[i].position, forwards[i], i)

    def test_a_recording_is_a_sequence_of_states(self):
        with rheolog.open(path('later.rlog')) as r:
            self.assertEqual((len(r), r.first_step, r.last_step, list(r.steps)), (7, 12, 18, list(range(12, 19))))
            self.assertEqual([s.step for s in r], list(range(12, 19)))
            self.assertEqual((r[0].step, r[-1].step, r[-7].step, r[np.int64(2)].step), (12, 18, 12, 14))
            self.assertEqual([s.step for s in r[1:6:2]], [13, 15, 17])
            self.assertEqual((r[::-3].steps, len(r[2:]), r[2:][1:3].steps, r[2:][-1].step), ([18, 15, 12], 5, [15, 16], 18))
            for index in (7, -8):
                self.refused('has 7', lambda: r[index], IndexError)
            for number in (11, 19):
                self.refused('12 to 18', lambda: r.step(number), IndexError)
            with self.assertRaises(TypeError):
                r[1.5]

    def test_a_name_that_is_no_field_is_refused_with_those_that_are(self):
        with rheolog.open(path('sparse.rlog')) as r:
            self.refused('position', lambda: r[0]['positions'], KeyError)
            self.refused('position', lambda: r[0].positions, AttributeError)
            self.assertIn('position', r[0])
            self.assertNotIn('positions', r[0])

    def test_a_full_recording_has_the_history_in_keyframes_only(self):
        with rheolog.open(path('full.rlog')) as r:
            self.assertIn('history_velocity', r[8])
            self.assertNotIn('history_velocity', r[9])
            self.refused('step(9) simulates it', lambda: r[9].history_velocity, rheolog.NotStored)
            self.refused('step(9) simulates it', lambda: r[9].hash(), rheolog.NotStored)
            self.assertEqual(r.step(9).hash(), objects('inspect', r.path, '--step', 9)[0]['hash'])

    # ---- What is recorded beside states ----

    def test_metrics_are_those_of_the_program(self):
        for name in every_recording():
            rows = list(csv.reader(io.StringIO(program('metrics', name))))
            with rheolog.open(name) as r:
                metrics = r.metrics
            self.assertEqual(list(metrics), rows[0])
            told = np.array(rows[1:], dtype=float).reshape(-1, len(rows[0]))
            for column, values in enumerate(metrics.values()):
                np.testing.assert_array_equal(told[:, column], values)
            self.assertEqual(metrics['step'].dtype.kind, 'i')

    def test_frame_is_the_metrics_by_step(self):
        try:
            import pandas
        except ImportError:
            self.skipTest('no pandas here')
        with rheolog.open(path('later.rlog')) as r:
            frame = r.frame()
            self.assertIsInstance(frame, pandas.DataFrame)
            self.assertEqual(frame.index.tolist(), list(r.steps))
            np.testing.assert_array_equal(frame['max_speed'], r.metrics['max_speed'])

    def test_commands_are_those_of_log(self):
        kinds = set()
        for name in every_recording():
            told = [line for line in objects('log', name) if line['event'] == 'command']
            with rheolog.open(name) as r:
                commands = r.commands
            self.assertEqual(len(commands), len(told), name)
            for found, line in zip(commands, told):
                kinds.add(found['kind'])
                for known in ('step', 'kind', 'path', 'body', 'impulse', 'point', 'count', 'material', 'vibrator', 'x', 'z'):
                    self.assertEqual(found.get(known), line.get(known), (name, known))
                if found['kind'] == 'set':
                    value = line['value']
                    self.assertEqual(found['value'] if isinstance(value, str) else json.loads(found['value']), value)
                if found['kind'] == 'add_particles':
                    box = [found['position'].min(0).tolist(), found['position'].max(0).tolist()]
                    self.assertEqual(box, [line['min'], line['max']])
                    self.assertEqual(found['velocity'].shape, (found['count'], 3))
        self.assertEqual(kinds, set(rheolog.Command.KINDS.values()))

    def test_provenance_is_that_of_log(self):
        for name in every_recording() + sorted(glob.glob(SOURCE + '/replays/*.rlog')):
            told = objects('log', name)
            with rheolog.open(name) as r:
                found = r.provenance
                for known in ('scene', 'model', 'particles', 'made_by', 'build', 'format', 'real_bytes', 'first_step', 'blessed',
                              'blessings', 'made_refused'):
                    self.assertEqual(found[known], told[0][known], (name, known))
                self.assertEqual((found['ending'], r.last_step), (told[-1]['ending'], told[-1]['last_step']))
                for parameter, value in told[0]['parameters'].items():
                    window = parameter in ('history.window', 'history.lag')  # in the program, only the one that was given
                    if parameter in r.parameters and not window and not isinstance(value, str):
                        self.assertEqual(r.parameters[parameter], value, (name, parameter))
        with rheolog.open(path('sparse.rlog')) as r:
            self.assertIn('bowling-ball-small', r.provenance['made_by'])
            if r.provenance['scene_text']:
                self.assertEqual(r.provenance['scene_text'].strip(), program('log', r.path, '--scene').strip())
                self.assertEqual(json.loads(r.provenance['scene_text'])['scene'], 'bowling-ball-small')

    def test_the_verdict_of_a_blessing_is_that_of_log(self):
        program('bless', path('blessed.rlog'), path('sparse.rlog'), '--because', 'the first')
        for verdict, at_least in ((1, 1), (2, 1), (3, 2), (4, 3), (5, 5), (6, 1), (1, 9)):  # two of a later version
            c = Chunks('blessed.rlog')
            at = [chunk[0] for chunk in c.list].index(b'BLES') + 1
            c.list.insert(at, [b'SAME', 1, 20, bytearray(struct.pack('<IIH', verdict, at_least, 5) + b'words')])
            with rheolog.open(c.written()) as r:
                self.assertEqual(r.provenance['blessings'], objects('log', r.path)[0]['blessings'])
                self.assertEqual(r.provenance['blessings'][0]['same'], 'words' if max(verdict, at_least) < 6 else None)
                self.assertEqual(r.verify().steps, 20)
        del c.list[at - 1]
        self.refused('does not belong to a blessing', lambda: rheolog.open(c.written()))

    def test_a_failure_is_that_of_inspect(self):
        with rheolog.open(path('failing.rlog')) as r:
            told = objects('inspect', r.path, '--step', r.last_step)[0]['failure']
            for known in ('step', 'stage', 'field', 'item', 'id', 'component', 'reason'):
                self.assertEqual(r.failure[known], told[known], known)
            self.assertEqual(r.failure['metrics']['step'], r.failure['step'])
            self.assertEqual(r.step(r.failure['step'], stage=r.stages[0]).stage, r.stages[0])
            self.refused('went bad', lambda: r.step(r.failure['step'], stage=r.failure['stage']), rheolog.LibraryError)
        with rheolog.open(path('sparse.rlog')) as r:
            self.assertIsNone(r.failure)

    # ---- Torn and damaged files ----

    def test_a_torn_file_gives_what_it_holds(self):
        for name in ('full.rlog', 'sparse.rlog'):
            data = content(name)
            with rheolog.open(path(name)) as r:
                whole, positions = r.metrics, [s.position for s in r[:r.last_step + 1]]
                ends = {k.chunk.step: k.chunk.end for k in r._steps}
                first = r._keyframes[0].chunk.end
            cuts = sorted({first, len(data) - 1} | {e + d for e in ends.values() for d in (-1, 0, 20)} |
                          set(range(0, len(data), 9973)))
            opened = set()
            for cut in cuts[::1 + EVERY // 4]:
                changed = write(data[:cut])
                if cut < first:
                    self.refused('', lambda: rheolog.open(changed))
                    continue
                with rheolog.open(changed) as r:
                    held = max([s for s, end in ends.items() if end <= cut], default=0)
                    opened.add(held)
                    self.assertEqual((r.last_step, len(r), r.complete, r.ending), (held, held + 1, False, 'truncated'))
                    self.assertTrue(r.torn)
                    for column, values in r.metrics.items():
                        np.testing.assert_array_equal(values, whole[column][:held + 1])
                    checked = r.verify()
                    self.assertEqual((checked.steps, checked.complete), (held, False))
                    last = max(s for s in r.stored if s <= held)
                    self.same(r[last].position, positions[last], cut)
            self.assertGreater(len(opened), 4)
        said = json.loads(program('info', write(content('full.rlog')[:ends[5] + 50]), '--json', codes=(0, 2)).splitlines()[0])
        with rheolog.open(path('changed.rlog')) as r:
            self.assertEqual((r.last_step, r.complete), (said['last_step'], said['complete']))

    def test_zeros_after_a_power_failure_are_taken_off(self):
        data = content('full.rlog')
        with rheolog.open(path('full.rlog')) as r:
            end = r._steps[11].chunk.end
        for zeros in (16, 100000):
            with rheolog.open(write(data[:end] + bytes(zeros))) as r:
                self.assertEqual((r.last_step, r.complete, r.verify().steps), (12, False, 12))
        self.refused('', lambda: rheolog.open(write(data + bytes(16))))

    def test_a_recording_that_is_being_written_says_so(self):
        if rheolog.fcntl is None:
            self.skipTest('no locks here')
        changed = write(content('full.rlog')[:-1])
        with io.open(changed, 'rb') as f, rheolog.open(changed) as r:
            rheolog.fcntl.flock(f, rheolog.fcntl.LOCK_EX)
            self.assertEqual(r.ending, 'being_written')
            rheolog.fcntl.flock(f, rheolog.fcntl.LOCK_UN)
            self.assertEqual(r.ending, 'truncated')

    def test_every_changed_byte_is_found(self):
        for name in ('sparse.rlog', 'full.rlog'):
            data = content(name)
            with rheolog.open(path(name)) as r:
                headers = [c.at + i for c in r._chunks[:4] + r._chunks[-3:] for i in range(36)]
            for at in headers + list(range(0, len(data), 1499 * (1 + EVERY // 4))):
                changed = bytearray(data)
                changed[at] ^= 4
                try:
                    with rheolog.open(write(changed)) as r:
                        self.assertFalse(r.verify().complete, f'the change of byte {at} of {name} is not found')
                except rheolog.Error:
                    pass

    def test_what_is_no_recording_is_refused(self):
        self.refused('this is not a recording', lambda: rheolog.open(write(b'')))
        self.refused('this is not a recording', lambda: rheolog.open(write(b'{"scene": 1}')))
        self.refused('git lfs pull', lambda: rheolog.open(write(b'version https://git-lfs.github.com/spec/v1\n')))
        with self.assertRaises(FileNotFoundError):
            rheolog.open(path('missing.rlog'))

    def test_right_check_sums_of_wrong_contents_are_not_enough(self):
        """Changes contents and makes check sums and positions again, so that only hashes and rules can tell."""
        chunks = Chunks('full.rlog')
        with rheolog.open(chunks.written()) as r:
            self.assertEqual(r.verify().states, 20)  # nothing was changed, and nothing is found
        head = content('full.rlog')

        def changed(kind, nth, at, name='full.rlog'):
            c = Chunks(name)
            c.find(kind, nth)[at] ^= 1
            return c.written()
        self.refused('does not have the recorded hash', lambda: rheolog.open(changed(b'FILD', 0, -1)).verify())
        self.refused('does not have the recorded hash', lambda: rheolog.open(changed(b'FILD', 0, -1))[0])
        self.refused('keyframe of step 0: step does not have the recorded hash',
                     lambda: rheolog.open(changed(b'KEYF', 0, 48)).verify())
        self.refused('keyframe of step 8: step does not have the recorded hash',
                     lambda: rheolog.open(changed(b'KEYF', 1, 48)).verify())
        self.refused('does not have the recorded hash', lambda: rheolog.open(changed(b'KEYF', 1, 48, 'sparse.rlog')).verify())
        with rheolog.open(path('full.rlog')) as r:
            step = r.read_step(3)
            writes = [r.head.fields[i].name for stage, _ in step.stage_runs(r.head) for i in stage.writes]
        last = max(i for i, name in enumerate(writes) if name == 'position')
        self.refused('step 3: position does not have the recorded hash',
                     lambda: rheolog.open(changed(b'STEP', 2, 8 + 8 * last)).verify())
        self.refused('has other steps', lambda: rheolog.open(changed(b'DONE', 0, 8)))
        self.assertNotEqual(head, content('changed.rlog'))
        c = Chunks('full.rlog')
        stat = c.find(b'STAT', 4)
        stat[len(stat) // 2] ^= 1
        self.refused('', lambda: rheolog.open(c.written()).verify())
        c = Chunks('full.rlog')
        del c.list[[i for i, chunk in enumerate(c.list) if chunk[0] == b'STEP'][4]]
        self.refused('step 5 is missing', lambda: rheolog.open(c.written()))
        c = Chunks('full.rlog')
        c.find(b'HEAD')[0] = 7
        self.refused('this reads versions 5 and 6 of the format, not 7', lambda: rheolog.open(c.written()))
        c = Chunks('full.rlog')
        c.list.insert(2, [b'NEWS', 0, 0, bytearray(b'1')])
        self.refused('no chunk type NEWS', lambda: rheolog.open(c.written()))
        c.list[2][1] = 1  # optional
        self.assertEqual(rheolog.open(c.written()).verify().steps, 20)
        data = bytearray(content('sparse.rlog'))
        with rheolog.open(path('sparse.rlog')) as r:
            index = [k for k in r._chunks if k.kind == b'INDX'][0]
        data[index.at + 40] ^= 1
        struct.pack_into('<I', data, index.end - 4, zlib.crc32(data[index.at:index.end - 4]))
        self.refused('INDX does not agree', lambda: rheolog.open(write(data)))

    def test_verify_counts_what_it_compared(self):
        for name in every_recording():
            with rheolog.open(name) as r:
                checked = r.verify()
                self.assertEqual((checked.steps, checked.keyframes, checked.complete), (len(r) - 1, len(r.keyframes), True))
                self.assertEqual(checked.states, len(r) - 1 if r.head.full else 0)
                self.assertGreaterEqual(checked.hashes, checked.keyframes * len(r.head.fields))

    def test_verify_can_simulate(self):
        with rheolog.open(path('sparse.rlog')) as r:
            self.assertEqual(r.verify(simulate=True).steps, 20)
        c = Chunks('sparse.rlog')
        c.find(b'STEP', 2)[8] ^= 1
        with rheolog.open(c.written()) as r:
            self.assertEqual(r.verify().steps, 20)  # no state is stored that could tell
            self.refused('step 3', lambda: r.verify(simulate=True), rheolog.LibraryError)
            self.refused('step 3', lambda: r[4], rheolog.LibraryError)
        with rheolog.open(write(content('sparse.rlog')[:-1])) as r:
            self.refused('truncated', lambda: r.verify(simulate=True), rheolog.LibraryError)

    # ---- Without the library, and with another one ----

    def test_without_the_library_states_that_are_not_stored_are_refused(self):
        os.environ['RHEOLOG_LIBRARY'] = path('no-library.so')
        try:
            with rheolog.open(path('sparse.rlog')) as r:
                self.assertEqual([r[i].step for i in (0, 8, 16)], [0, 8, 16])
                self.assertEqual(len(r.metrics['step']), 21)
                for text in ('step 3 is not stored', 'RHEOLOG_LIBRARY', 'steps 0, 8, 16'):
                    self.refused(text, lambda: r[3], rheolog.NotStored)
                self.refused('cannot be loaded', lambda: r.step(3), rheolog.LibraryError)
                self.refused('cannot be loaded', lambda: r.verify(simulate=True), rheolog.LibraryError)
                self.assertEqual(r.verify().steps, 20)
            with rheolog.open(path('full.rlog')) as r:
                self.assertEqual([s.source for s in r[7:10]], ['stored', 'keyframe', 'stored'])
        finally:
            os.environ['RHEOLOG_LIBRARY'] = LIBRARY

    def test_a_library_of_the_other_number_type_is_refused(self):
        c = Chunks('sparse.rlog')
        struct.pack_into('<I', c.find(b'HEAD'), 4, {'float': 8, 'double': 4}[REAL])
        other = {'float': 'double', 'double': 'float'}[REAL]
        with rheolog.open(c.written()) as r:
            self.refused(f'is a library for {REAL}, and the recording is of {other}', lambda: r.step(3), rheolog.LibraryError)
            self.refused(f'is a library for {REAL}', lambda: r[3], rheolog.NotStored)
        os.environ['RHEOLOG_LIBRARY'] = 'libc.so.6'
        try:
            with rheolog.open(path('sparse.rlog')) as r:
                self.refused('is no librheolog', lambda: r.step(3), rheolog.LibraryError)
        finally:
            os.environ['RHEOLOG_LIBRARY'] = LIBRARY

    def test_golden_recordings_of_float_are_read_by_any_build(self):
        for name in sorted(glob.glob(SOURCE + '/replays/*.rlog'))[::1 + EVERY // 4]:
            with rheolog.open(name) as r:
                self.assertEqual(r.verify().states, len(r) - 1)

    # ---- The page ----

    def test_the_page_prints_what_it_says(self):
        have = {m: subprocess.run([sys.executable, '-c', f'import {m}'], stderr=subprocess.DEVNULL, check=False).returncode == 0
                for m in ('pandas', 'matplotlib')}
        blocks = page_blocks()
        chosen = [(text, said) for text, said in blocks
                  if (have['matplotlib'] or 'plt' not in text) and (have['pandas'] or 'frame()' not in text)]
        os.mkdir(path('page'))
        printed = run_page([text for text, _ in chosen], path('page'))
        for (text, said), output in zip(chosen, printed):
            if REAL == 'float':
                self.assertEqual(output, said, text)
            self.assertEqual(bool(output), bool(said), text)
        self.assertGreater(sum(bool(said) for _, said in chosen), 6)
        plots = page_plots()
        self.assertEqual(len(plots), 2)
        for plot in plots:
            self.assertTrue(os.path.exists(os.path.join(SOURCE, 'docs', plot)), plot)
            if have['matplotlib']:
                self.assertGreater(os.path.getsize(path('page/' + os.path.basename(plot))), 5000)
        if len(chosen) < len(blocks):
            print(f'test_python: {len(blocks) - len(chosen)} blocks of the page need pandas or matplotlib, and were left out')


if __name__ == '__main__':
    if len(sys.argv) != 6 and sys.argv[6:] != ['--write']:
        sys.exit(__doc__.strip())
    try:
        if sys.argv[6:]:
            sys.exit(write_page())
        make_recordings()
        result = unittest.main(argv=sys.argv[:1], exit=False, warnings='ignore').result
    finally:
        shutil.rmtree(FOLDER)
    sys.exit(0 if result.wasSuccessful() else 1)
