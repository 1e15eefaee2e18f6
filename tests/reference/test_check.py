#!/usr/bin/env python3
"""
Proves that check.py finds what differs: one bit of a file, of a hash, of a value or of a parameter.

    test_check.py PARAMETERS GOLDENS        GOLDENS: the folder of the golden recordings
"""
import copy
import os
import struct
import sys
import tempfile
import zlib

import numpy as np
import reader
import rheolog
from check import Check, Differs
from parameters import Parameters

np.seterr(all='ignore')


class Test:
    def __init__(self, page, folder):
        with open(page, encoding='utf-8') as f:
            self.parameters = Parameters(f.read())
        self.folder = folder

    def path(self, name):
        return os.path.join(self.folder, name + '.rlog')

    def golden(self, name, steps):
        """A golden recording with only its first steps."""
        recording = reader.Recording(self.path(name))
        if steps < len(recording.steps):
            del recording.steps[steps:]
            recording.state_hash, recording.failure = 0, None
        return recording

    def differs(self, recording, text):
        """A check must fail with a message that has this text."""
        try:
            Check(recording, self.parameters).run()
        except (Differs, rheolog.Damaged) as problem:
            if text not in str(problem):
                sys.exit(f'test_check: "{problem}" does not say "{text}"')
            return
        sys.exit(f'test_check: passes, but should say "{text}"')

    def refused(self, content, text):
        """A file must be refused with a message that has this text."""
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, 'changed.rlog')
            with open(path, 'wb') as f:
                f.write(content)
            try:
                self.differs(reader.Recording(path), text)
            except rheolog.Damaged as problem:
                if text not in str(problem):
                    sys.exit(f'test_check: "{problem}" does not say "{text}"')

    def unchanged_recordings_are_the_same(self):
        for name in ('incline', 'sequential', 'failure'):
            Check(self.golden(name, 4), self.parameters).run()

    def a_changed_hash_names_its_step_stage_and_field(self):
        for name, hash_index, text in (('incline', 0, 'step 2: spring_ends differs after stage neighbours'),
                                       ('incline', 7, 'step 2: substeps differs after stage substeps'),
                                       ('incline', 19, 'step 2: spring_rest_length differs after stage densities@2'),
                                       ('incline', -1, 'step 2: history_velocity differs after stage history'),
                                       ('sequential', 4, 'step 2: ball_velocity differs after stage ball_motion')):
            for bit in (0, 63):
                recording = self.golden(name, 2)
                recording.steps[1].hashes[hash_index] ^= 1 << bit
                self.differs(recording, text)

    def a_changed_value_names_its_particle(self):
        recording = self.golden('incline', 2)
        position = [i for i, f in enumerate(recording.head.fields) if f.name == 'position'][0]
        stat = bytearray(recording.steps[1].stats[0])
        at = stat.index(struct.pack('<IIQQ', position, 0, 0, 324)) + 24
        stat[at + 1] ^= 1  # the lowest bit of the first value of the first group
        recording.steps[1].stats[0] = bytes(stat)
        self.differs(recording, 'position differs from the recorded state: particle 0[0] is')

    def a_changed_keyframe_is_found(self):
        for field in ('velocity', 'spring_rest_length', 'list_margin', 'history_rows'):
            recording = self.golden('ball', 1)
            recording.keyframe.values[field].view(np.uint8)[-1, -1] ^= 1
            self.differs(recording, f'keyframe of step 0: {field} does not have the recorded hash')

    def a_changed_parameter_is_found_at_the_stage_that_uses_it(self):
        for path, text in (('fluid.stiffness', 'position differs after stage forces@1'),
                           ('springs.plasticity', 'spring_rest_length differs after stage densities@'),
                           ('fluid.linear_viscosity', 'velocity differs after stage viscosity'),
                           ('walls.sticking', 'differs after stage walls@'),
                           ('history.order', 'derivative differs after stage fractional_derivative')):
            recording = self.golden('ball', 8)
            recording.keyframe.parameters[path][0] *= 1.001
            self.differs(recording, text)

    def another_number_of_substeps_is_found(self):
        recording = self.golden('incline', 1)
        recording.keyframe.parameters['substeps'] = [3.0]
        self.differs(recording, 'substeps differs after stage substeps')

    def another_failure_is_found(self):
        recording = self.golden('failure', 4)
        recording.failure.id += 1
        self.differs(recording, 'step 45 fails at')

    def another_hash_at_the_end_is_found(self):
        recording = self.golden('failure', 4)
        recording.state_hash ^= 1
        self.differs(recording, 'the state at the end does not have the recorded hash')

    def a_changed_byte_of_a_file_is_refused(self):
        with open(self.path('incline'), 'rb') as f:
            content = f.read()
        for at in range(8, len(content), 9973):
            changed = bytearray(content)
            changed[at] ^= 16
            self.refused(bytes(changed), '')
        self.refused(content[:-5], 'the file ends in a chunk')

    def a_changed_hash_in_a_file_is_found(self):
        with open(self.path('incline'), 'rb') as f:
            content = bytearray(f.read())
        at = content.index(b'STEP')
        flags, _, stored, _ = struct.unpack_from('<IQQQ', content, at + 4)
        assert flags == 0, 'the chunk is not compressed'
        content[at + 32 + 8] ^= 1
        struct.pack_into('<I', content, at + 32 + stored, zlib.crc32(content[at:at + 32 + stored]))
        self.refused(bytes(content), 'step 1: spring_ends differs after stage neighbours')

    def the_vectors_of_the_page_hold(self):
        """docs/format.md, Test vectors."""
        three_seven, length = np.array([[3, 7]], dtype='<u4'), np.array([1.5], dtype=np.float32)
        for found, expected in ((rheolog.word(0, 0, 0), 0x4E17CF67001B3979),
                                (rheolog.hash_of_rows([np.array([[1, 2, 3]], dtype=np.float32)], 1), 0x8952EA0C6417AB75),
                                (rheolog.hash_of_rows([np.array([[7]], dtype='<u8')], 1), 0x6178FA89EAFC543B),
                                (int(rheolog.keys(np.array([3]))[0]), 0x4AE24EE7585B10B1),
                                (rheolog.hash_of_spring_ends(three_seven), 0x8B059C703B7FBCE4),
                                (rheolog.hash_of_rest_lengths(three_seven, length), 0xD36D7925BF36CDCE),
                                (rheolog.hash_of_rest_lengths(three_seven, length.astype(np.float64)), 0xAF824F4BDFFA0CB8),
                                (rheolog.finish_field(0, 1, 0), 0xCDC98B6BA68426C4)):
            if found != expected:
                sys.exit(f'test_check: {found:016X} is not {expected:016X}')
        packed = rheolog.Cursor(bytes.fromhex('03d1581f')).packed(7, np.dtype('<u4'))
        if packed.tolist() != [1, 2, 3, 4, 5, 6, 7]:
            sys.exit('test_check: packed values are read wrongly')

    def run(self):
        tests = [name for name in dir(self) if '_are_' in name or '_is_' in name or '_names_' in name or '_hold' in name]
        for name in tests:
            getattr(copy.copy(self), name)()
        print(f'test_check: {len(tests)} properties hold')


if __name__ == '__main__':
    if len(sys.argv) != 3:
        sys.exit(__doc__.strip())
    Test(*sys.argv[1:]).run()
