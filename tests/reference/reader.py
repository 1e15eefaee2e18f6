"""All of a complete recording at once, as check.py needs it. The chunks are read by src/python/rheolog.py."""
import rheolog


class Recording:
    """head, keyframe (the first), steps, failure, state_hash (0: not known)."""

    def __init__(self, path):
        with rheolog.open(path) as r:
            rheolog.require(r.complete, r.torn)
            r.check_sums()
            self.head = r.head
            self.keyframe = r.read_keyframe(r.first_step)
            self.steps = [r.read_step(number) for number in r.steps[1:]]
            for step in self.steps:
                if step.number in r.keyframes:
                    step.keyframe = r.read_keyframe(step.number)
            self.failure = r.read_failure()
            self.state_hash = int(r.state_hash or '0', 16)
