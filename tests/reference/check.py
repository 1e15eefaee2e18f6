#!/usr/bin/env python3
"""
Makes every step of recordings again and compares every hash. Names the first stage, field and particle that differ. Of
recordings of the melting model and of scheme positions it checks the keyframes and reads the states.

    check.py PARAMETERS RECORDING...        PARAMETERS: docs/parameters.md
"""
import os
import sys

import numpy as np
import reader
import rheolog
from parameters import Definition, Parameters
from world import World

MELTING = 256
OBSTACLES = 16384


class Differs(Exception):
    pass


def run_name(stage, substep):
    return f'{stage.name}@{substep}' if substep else stage.name


def where(field, own, recorded):
    """The first item of a field that differs."""
    if own.shape != recorded.shape:
        return f'{len(own)} items here, {len(recorded)} in the recording'
    bits = f'<u{own.dtype.itemsize}'
    differs = np.argwhere(np.ascontiguousarray(own).view(bits) != np.ascontiguousarray(recorded).view(bits))
    if not len(differs):
        return None
    item, component = differs[0]
    kind = ['world', 'particle', 'spring', 'ball', 'vibrator'][field.location]
    return (f'{kind} {item}[{component}] is {own[item, component]!r} here, {recorded[item, component]!r} in the recording')


class Check:
    """Plays a recording. compared: number of hashes after stages that are the same."""

    def __init__(self, recording, parameters):
        self.recording, self.head, self.parameters = recording, recording.head, parameters
        self.compared = 0

    def run(self):
        """Returns what was done. Raises Differs at the first difference."""
        frame = self.recording.keyframe
        frame.check(self.head)
        if self.head.features & MELTING:
            self.read_states()
            return 'only read (melting)'
        if self.head.features & OBSTACLES:
            self.read_states()
            return 'only read (obstacles)'
        if Definition(self.parameters, frame.parameters)['scheme'] == 'positions':
            self.read_states()
            return 'only read (scheme positions)'
        if any(path.startswith('emitters.') for path in frame.parameters):
            self.read_states()
            return 'only read (emitters)'
        self.world, self.stored = World(self.head, frame, self.parameters), frame.values
        for step in self.recording.steps:
            self.step(step)
        if self.recording.state_hash not in (0, self.world.state.hash()):
            raise Differs('the state at the end does not have the recorded hash')
        if self.recording.failure:
            self.failing_step(self.recording.failure)
        return 'the same'

    def read_states(self):
        """The states and keyframes of a model or scheme that has no second implementation."""
        before = self.recording.keyframe.values
        for step in self.recording.steps:
            if self.head.full:
                before = rheolog.state_after(self.head, step, before)
            if step.keyframe:
                step.keyframe.check(self.head)

    def step(self, step):
        for command in step.commands:
            self.world.command(command)
        self.world.begin()
        expected = iter(step.hashes)
        stored = rheolog.state_after(self.head, step, self.stored) if self.head.full else None
        for stage, substep in step.stage_runs(self.head):
            if substep and int(self.world.state.f['substeps'][0, 0]) != step.substeps:
                raise Differs(f'step {step.number}: {step.substeps} substeps are recorded')
            self.world.run(stage.name)
            for index in stage.writes:
                field = self.head.fields[index]
                if self.world.state.hash_of(field, newest=True) != next(expected):
                    self.report(step, run_name(stage, substep), field, stored)
                self.compared += 1
        self.world.end()
        if stored:
            self.compare_stored(step, stored)
        if step.keyframe:
            step.keyframe.check(self.head)
            for field, expected_hash in zip(self.head.fields, step.keyframe.hashes):
                if self.world.state.hash_of(field) != expected_hash:
                    raise Differs(f'step {step.number}: {field.name} differs from the keyframe')
            self.world = World(self.head, step.keyframe, self.parameters)  # all state is in the keyframe

    def report(self, step, name, field, stored):
        text = f'step {step.number}: {field.name} differs after stage {name}'
        runs = [run_name(*r) for r in step.stage_runs(self.head)]
        if stored and field.name in stored:
            for later in runs[runs.index(name) + 1:]:
                self.world.run(later.split('@')[0])
            found = where(field, self.world.state.flat()[field.name], stored[field.name])
            text += f'; at the end of the step {found}' if found else '; the state after the step is the recorded one'
        raise Differs(text)

    def compare_stored(self, step, stored):
        """The state after a step of a full recording, bit for bit."""
        own = self.world.state.flat()
        for field in self.head.fields:
            if field.name in stored:
                found = where(field, own[field.name], stored[field.name])
                if found:
                    raise Differs(f'step {step.number}: {field.name} differs from the recorded state: {found}')
        self.stored = stored

    def failing_step(self, failure):
        """The step that failed: a value is not finite after the recorded stage, and none before."""
        for command in failure.commands:
            self.world.command(command)
        self.world.begin()
        recorded = (failure.stage, failure.field, failure.id, failure.component)
        for stage, substep in self.stage_runs():
            self.world.run(stage.name)
            for index in stage.writes:
                field = self.head.fields[index]
                values = self.world.state.f.get(field.name)
                if field.storage != rheolog.FLAT or values.dtype.kind != 'f':
                    continue
                bad = np.argwhere(~(np.abs(values) <= self.largest(field)))
                if len(bad):
                    found = (run_name(stage, substep), field.name, *bad[0].tolist())
                    if found != recorded:
                        raise Differs(f'step {failure.step} fails at {found} here, at {recorded} in the recording')
                    return
        raise Differs(f'step {failure.step} does not fail here; {failure.field} is recorded as not finite')

    def largest(self, field):
        """Values beyond it count as not finite (docs/format.md, FAIL)."""
        if field.name == 'velocity' and 'history_modes' in self.world.state.f:
            return 2.0 ** (90 if self.head.real_bytes == 4 else 960)
        return np.finfo(field.dtype).max

    def stage_runs(self):
        """Those of a step whose hashes are not recorded; the stages of phase 0 set the number of substeps."""
        yield from ((s, 0) for s in self.head.stages if s.phase == 0)
        repeated = [s for s in self.head.stages if s.phase == 1]
        for substep in range(int(self.world.state.f['substeps'][0, 0]) if repeated else 0):
            yield from ((s, substep + 1) for s in repeated)
        yield from ((s, 0) for s in self.head.stages if s.phase == 2)


def main(page, paths):
    np.seterr(all='ignore')  # a value that is not used may be infinite or NaN
    with open(page, encoding='utf-8') as f:
        parameters = Parameters(f.read())
    bad = 0
    for path in paths:
        name = os.path.basename(path)
        try:
            check = Check(reader.Recording(path), parameters)
            how = check.run()
            print(f'{name}: {how}, {len(check.recording.steps)} steps, {check.compared} hashes after stages', flush=True)
        except (Differs, rheolog.Damaged, OSError) as problem:
            bad += 1
            print(f'{name}: {problem}', flush=True)
    return 1 if bad else 0


if __name__ == '__main__':
    if len(sys.argv) < 3:
        sys.exit(__doc__.strip())
    sys.exit(main(sys.argv[1], sys.argv[2:]))
