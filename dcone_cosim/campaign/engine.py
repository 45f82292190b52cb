"""The loop of a campaign: from points to rows, nothing lost, nothing twice, in the order of case numbers.

What is in the store is not run again. What a campaign comes to hangs on the rows in the order of their numbers alone,
never on the order in which they came.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

from dcone_cosim.campaign import intervals
from dcone_cosim.campaign.cluster import Cluster, SchedulerGone
from dcone_cosim.campaign.inputs import Inputs, Point
from dcone_cosim.campaign.outcomes import outcome, succeeded
from dcone_cosim.campaign.shots import Ground, Shot, run_shot
from dcone_cosim.campaign.spec import RANDOM, Spec
from dcone_cosim.campaign.stopping import enough, looks, needed
from dcone_cosim.cases.case import digest
from dcone_cosim.cases.pace import Pace
from dcone_cosim.cases.rows import Row
from dcone_cosim.cases.runner import Rows, Runner
from dcone_cosim.errors import Interrupted
from dcone_cosim.progress import Progress

KEPT = "cases done; they are kept, and the same command goes on with the rest"
Work = Callable[[Shot], Row]


@dataclass(frozen=True)
class Made:
    """A case that has been run: its number, the values it had, SI, its row, and its point of the unit cube."""

    number: int
    values: tuple[float, ...]
    row: Row
    point: Point | None = field(default=None, repr=False, compare=False)


def key_of(identity: Any, settings: Sequence[str]) -> str:
    """The hash under which a case's row is kept.

    identity    of all that settles its numbers beside its settings, plain data
    """
    return digest("campaign", identity, list(settings))


class Tally:
    """What has come so far, for whoever waits."""

    def __init__(self, spec: Spec, total: int) -> None:
        self.pace, self._spec = Pace(total), spec
        self.good = self.answered = 0
        self.words: Counter[str] = Counter()

    def count(self, row: Row, before: bool) -> None:
        good = succeeded(row, self._spec.success)
        self.pace.count(good is not None, before)
        self.good += good is True
        self.answered += good is not None
        self.words[outcome(row, self._spec.success.judged)] += 1

    def told(self) -> str:
        """ "412 of 1825, 1.3 per s, 18 min to go; 391 captured, 21 missed; 0.949 (0.923 to 0.966)"."""
        parts = [self.pace.told(), ", ".join(f"{count} {word}" for word, count in self.words.most_common(4))]
        if self.answered and self._spec.sampler in RANDOM:
            found = intervals.of_share(self._spec, self.good, self.answered)
            parts.append(f"{found.share:.4g}{intervals.bounds(found)}")
        return "; ".join(filter(None, parts))


class Engine:
    """Runs the cases of a campaign.

    identity    of all that settles the numbers of a case beside its settings, plain data
    """

    def __init__(
        self,
        spec: Spec,
        inputs: Inputs,
        ground: Ground,
        identity: Any,
        store: Rows,
        cluster: Cluster,
        progress: Progress,
        work: Work = run_shot,
    ) -> None:
        self.spec, self.inputs, self._ground, self._identity = spec, inputs, ground, identity
        self._store, self._cluster, self._progress, self._work = store, cluster, progress, work
        self.made: list[Made] = []
        self.tally = Tally(spec, 0)
        self._cost = 0.0

    def shot(self, number: int, values: Sequence[float]) -> Shot:
        """A case by its number and values."""
        settings = self.inputs.settings(values) if number else ()
        return Shot(key_of(self._identity, settings), number, settings, self._ground)

    def nominal(self) -> Row:
        """The scene as it is, with all figures."""
        shot = Shot(digest("nominal", self._identity), 0, (), self._ground)
        row = self._runner().row(shot)
        self._cost = row.timings.get("cpu", 0.0)
        return row

    def _runner(self) -> Runner:
        cluster = self._cluster
        return Runner(self._store, cluster.executor, cluster.ahead, self._work, self._idle, self._cost)

    def _idle(self) -> None:
        self._cluster.check()
        pace = self.tally.pace
        if pace.total:
            self._progress.count("cases", pace.done, max(pace.total, pace.done), self.tally.told())

    def run(self, points: Iterator[Point], count: int | None) -> list[Made]:
        """Cases from the first on: `count` of them, or until the interval is narrow enough."""
        spec, most = self.spec, self.spec.most if count is None else count
        self.tally.pace.total = most if count is not None else min(most, 1000)
        numbers_of: dict[str, list[int]] = {}
        values_of: dict[int, tuple[float, ...]] = {}
        point_of: dict[int, Point] = {}
        rows: dict[int, Row] = {}
        stop = _Stop(spec, most)

        def shots() -> Iterator[Shot]:
            for number in range(1, most + 1):
                if stop.at is not None:
                    return
                point = next(points, None)
                if point is None:
                    return
                values = tuple(self.inputs.values(point))
                shot = self.shot(number, values)
                values_of[number], point_of[number] = values, point
                if shot.key in numbers_of and numbers_of[shot.key][0] in rows:  # the same values once more
                    rows[number] = rows[numbers_of[shot.key][0]]
                numbers_of.setdefault(shot.key, []).append(number)
                yield shot

        for row, before in self._rows(shots()):
            for number in numbers_of[row.key]:
                if number not in rows:
                    self.tally.count(row, before)
                rows[number] = row
            stop.look(rows)
            if count is None:
                self.tally.pace.total = stop.at or needed(stop.good, stop.answered, spec.until, most)  # type: ignore[arg-type]
        stop.look(rows)
        last = stop.at or len(values_of)
        self.made = [Made(n, values_of[n], rows[n], point_of[n]) for n in range(1, last + 1)]
        return self.made

    def batch(self, points: Sequence[Point]) -> list[Made]:
        """More cases after those that there are, all of them before this returns."""
        first = len(self.made) + 1
        wanted = [tuple(self.inputs.values(point)) for point in points]
        shots = [self.shot(number, values) for number, values in enumerate(wanted, first)]
        self.tally.pace.total = max(self.tally.pace.total, len(self.made) + len(points))
        found = {}
        for row, before in self._rows(iter(shots)):
            found[row.key] = row
            self.tally.count(row, before)
        new = [
            Made(shot.number, values, found[shot.key], point)
            for shot, values, point in zip(shots, wanted, points, strict=True)
        ]
        self.made += new
        return new

    def _rows(self, shots: Iterator[Shot]) -> Iterator[tuple[Row, bool]]:
        pace = self.tally.pace
        try:
            for row, before in self._runner().rows(shots):
                yield row, before
                self._idle()
        except (Interrupted, SchedulerGone) as error:
            raise type(error)(f"{error} with {pace.done} {KEPT}") from None
        except OSError as error:  # the disk is full, or gone
            raise OSError(error.errno, f"{error.strerror} with {pace.done} {KEPT}", error.filename) from None


class _Stop:
    """Looks at the rows from the first on, as far as they are all there."""

    def __init__(self, spec: Spec, most: int) -> None:
        self._spec, self._most, self._looks = spec, most, looks()
        self._next = next(self._looks)
        self._upto = self.good = self.answered = 0
        self.at: int | None = None

    def look(self, rows: dict[int, Row]) -> None:
        until = self._spec.until
        while until is not None and self.at is None and self._upto + 1 in rows:
            self._upto += 1
            good = succeeded(rows[self._upto], self._spec.success)
            self.good += good is True
            self.answered += good is not None
            if self._upto == self._next:
                self._next = next(self._looks)
                if not self.answered or enough(self.good, self.answered, until):  # none answers: more will not either
                    self.at = self._upto
