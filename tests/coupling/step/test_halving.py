"""Steps in parts: where they fail, and where their length adds too much of an error."""

import pytest

from coupling.ports import StepFailed
from coupling.step.halving import ErrorControl, Halving, HalvingSettings

TOLERANCE = 1e-3


class Impact:
    """A step whose error is dt^3 times ``strong`` within an impact, times ``weak`` elsewhere."""

    halvable = True

    def __init__(self, strong=1e3, weak=0.1, begin=0.5, end=0.6):
        self.strong, self.weak, self.begin, self.end = strong, weak, begin, end
        self.attempts, self.accepted = [], []
        self.error = 0.0

    def attempt(self, now, dt, load):
        self.attempts.append((now, dt))
        inside = now < self.end - 1e-9 and now + dt > self.begin + 1e-9
        self.error = dt**3 * (self.strong if inside else self.weak)
        return True

    def accept(self):
        self.accepted.append((self.attempts[-1], self.error))


def taken(step, control, steps=10, settings=None):
    halving = Halving(settings, control=control)
    for number in range(steps):
        halving.advance(step, 0.1 * number, 0.1, lambda start, end: None)
    return [dt for (_, dt), _ in step.accepted]


def controlled(step):
    return ErrorControl(error=lambda: step.error, tolerance=TOLERANCE)


def test_parts_are_short_in_an_impact_and_whole_elsewhere():
    step = Impact(strong=4e2)
    lengths = taken(step, controlled(step))
    assert sum(lengths) == pytest.approx(1.0)
    assert lengths[:5] == [0.1] * 5
    assert min(lengths) == pytest.approx(0.0125)
    assert lengths[-1] == pytest.approx(0.1)
    errors = [error for _, error in step.accepted]
    assert max(errors) <= TOLERANCE
    # Three tries find the depth; within the impact it is kept, and afterwards given up in turn.
    assert len(step.attempts) - len(step.accepted) <= 4


def test_the_last_halves_are_accepted_whatever_their_error():
    step = Impact(strong=1e6)
    lengths = taken(step, controlled(step), settings=HalvingSettings(halvings=2))
    assert min(lengths) == pytest.approx(0.025)
    assert max(error for _, error in step.accepted) > TOLERANCE


def test_without_control_steps_are_whole():
    step = Impact(strong=1e6)
    assert taken(step, None) == [0.1] * 10


def test_what_cannot_be_halved_is_taken_whole():
    step = Impact(strong=1e6)
    step.halvable = False
    assert taken(step, controlled(step)) == [0.1] * 10


def test_a_run_goes_on_as_short_as_it_was_saved():
    step, other = Impact(begin=0.0, end=1.0), Impact(begin=0.0, end=1.0)
    one, two = Halving(control=controlled(step)), Halving(control=controlled(other))
    one.advance(step, 0.0, 0.1, lambda start, end: None)
    two.restore(one.save())
    for halving, each in ((one, step), (two, other)):
        each.attempts.clear()
        halving.advance(each, 0.1, 0.1, lambda start, end: None)
    assert step.attempts == other.attempts
    assert step.attempts[0][1] == pytest.approx(0.0125)


def test_a_step_that_fails_is_halved_and_the_last_failure_is_raised():
    step = Impact()

    def failing(now, dt, load):
        raise StepFailed("no mesh")

    step.attempt = failing
    with pytest.raises(StepFailed, match="no mesh"):
        Halving().advance(step, 0.0, 0.1, lambda start, end: None)


def test_an_attempt_is_repeated_until_its_load_is_what_it_should_have_been():
    """And then accepted once; where it never is, the step is halved, and fails in the end."""
    step, loads = Impact(), [object(), object(), None]
    halving = Halving(again=lambda: loads.pop(0))
    assert halving.advance(step, 0.0, 0.1, lambda start, end: None) == 1
    assert (len(step.attempts), len(step.accepted)) == (3, 1)
    step = Impact()
    halving = Halving(HalvingSettings(halvings=1), again=object)
    with pytest.raises(ArithmeticError, match="its attitude is not found in"):
        halving.advance(step, 0.0, 0.1, lambda start, end: None)
    assert {dt for _, dt in step.attempts} == {0.1, 0.05}
    assert not step.accepted


def test_what_is_halved_all_the_same_is_not_repeated():
    class Unconverged(Impact):
        def attempt(self, now, dt, load):
            return super().attempt(now, dt, load) and dt < 0.1

    step, asked = Unconverged(), []
    halving = Halving(again=lambda: asked.append(len(step.attempts)))
    assert halving.advance(step, 0.0, 0.1, lambda start, end: None) == 2
    assert asked == [2, 3]  # after either half, not after the whole
