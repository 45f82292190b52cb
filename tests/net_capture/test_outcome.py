"""When a shot counts as captured and when a capture is taken back, for shares inside that are told, not simulated."""

import numpy as np
import pytest

from fmu_src.net_capture import outcome
from fmu_src.net_capture.composition import Composition
from fmu_src.net_capture.interface import MODEL, OUTCOMES
from fmu_src.net_capture.quality import make_quality
from orbital.kernel import kernel
from tests.conftest import CAPTURE

TERMS = {name: term for name, term in CAPTURE.items() if name not in ("settling", "tether")}
LOOK = 0.01


@kernel
def told(p, work):
    """In place of the share inside: what the test says it is."""
    return work[0]


@pytest.fixture(scope="module")
def judge():
    """The model's own, but for the share inside."""
    composition = Composition(MODEL, MODEL.interface(TERMS).terms)
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(outcome, "make_share", lambda _: told)
        return outcome.make_judge(composition, make_quality(composition))


@pytest.fixture
def make_shot(judge):
    return lambda **values: Shot(judge, **values)


class Shot:
    """A shot whose cord is short of the girth by a metre, judged with the shares inside that it is told."""

    def __init__(self, judge, **values):
        self.judge = judge
        self.record = MODEL.interface(TERMS).make_record().view(np.recarray)[0]
        outcome.start_enclosure(self.record)
        self.record.girth = 16.0
        self.record.t_capture = -1.0
        self.record.measure_every = 1
        self.record.closing_t_start = self.record.trigger_time = 11.2
        self.record.mouth_cord_length = 15.0
        self.record.contact_first_time = 10.0
        self.record.grid = 0  # a look of its own, whatever the time
        self.looks = 1200
        for name, value in values.items():
            self.record[name] = value

    @property
    def time(self):
        return self.looks * LOOK

    def tell(self, share, seconds):
        """Look on for some time with this share inside; return the outcome."""
        for _ in range(round(seconds / LOOK)):
            self.looks += 1
            self.judge(self.record, np.array([share]), self.time)
        return OUTCOMES[int(self.record.outcome)]


@pytest.mark.parametrize("share", [24 / 27, 1.0])
def test_captured_once_all_but_an_edge_has_been_inside_for_a_quarter_of_a_second(make_shot, share):
    """The twins: nearly so much for longer, and so much for less long."""
    shot = make_shot()
    assert shot.tell(23 / 27, 3.0) == "flying"
    assert shot.tell(share, 0.24) == "flying"
    assert shot.tell(23 / 27, LOOK) == "flying"
    assert (shot.record.captured, shot.record.t_capture, shot.record.enclosure_at_capture) == (0, -1.0, -1.0)
    assert shot.tell(share, 0.24) == "flying"
    assert shot.tell(share, 2 * LOOK) == "captured"
    assert shot.record.captured == 1
    assert shot.record.t_capture == pytest.approx(15.5, abs=1.01 * LOOK)
    assert shot.record.enclosure_at_capture == share
    assert shot.record.mouth_margin_at_capture == pytest.approx(1.0)


@pytest.mark.parametrize("values", [{"mouth_cord_length": 16.1}, {"closing_t_start": -1.0}])
def test_not_captured_before_the_mouth_is_narrower_than_the_target(make_shot, values):
    shot = make_shot(**values)
    assert shot.tell(1.0, 3.0) == "flying"
    assert shot.record.enclosure_share == -1.0
    assert shot.tell(0.0, 3.0) == "flying"


@pytest.mark.parametrize(("touched", "name"), [(10.0, "slipped_off"), (-1.0, "missed")])
def test_a_target_outside_for_a_second_is_out(make_shot, touched, name):
    shot = make_shot(contact_first_time=touched)
    assert shot.tell(0.0, 0.99) == "flying"
    assert shot.tell(1 / 27, 3.0) == "flying"
    assert shot.tell(0.0, 0.99) == "flying"
    assert shot.tell(0.0, 0.02) == name
    assert shot.tell(1.0, 5.0) == name
    assert (shot.record.captured, shot.record.t_lost) == (0, -1.0)


def test_what_stands_in_the_mouth_till_the_time_is_up_was_not_closed(make_shot):
    shot = make_shot()
    assert shot.tell(0.7, 11.2 + 20.0 - 12.0) == "flying"
    assert shot.tell(0.7, 2 * LOOK) == "not_closed"


def test_a_momentary_flip_takes_no_capture_back(make_shot):
    shot = make_shot()
    shot.tell(1.0, 0.3)
    for _ in range(5):
        assert shot.tell(0.2, 0.9) == "captured"
        assert shot.tell(14 / 27, LOOK) == "captured"
    assert shot.record.enclosure_least == 0.2
    assert shot.record.enclosure_at_capture == 1.0


def test_a_capture_is_taken_back_when_the_target_has_been_out_for_a_second(make_shot):
    shot = make_shot()
    shot.tell(0.9, 1.0)
    last = shot.time
    assert shot.tell(13 / 27, 0.99) == "captured"
    assert shot.tell(13 / 27, 0.02) == "slipped_off"
    assert shot.record.captured == 0
    assert shot.record.t_lost == pytest.approx(last + 1.0, abs=0.011)
    assert shot.record.t_capture == pytest.approx(12.26)
    assert shot.tell(1.0, 3.0) == "slipped_off"
