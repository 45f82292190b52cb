"""What a page shows of a phase, as plain arrays: a clip that can be turned and scrubbed, and charts to zoom into."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy.typing as npt

Array = npt.NDArray[Any]

ORBITAL = ("radial", "along-track", "cross-track")
"""Axes of the orbital frame, in which all of a clip is told."""
LINE, STEMS = "line", "stems"
"""Kinds of a series: a curve, or a stem with a dot to each value."""


@dataclass(frozen=True)
class Series:
    """One curve of a chart.

    x, y     (n,), in the units of the chart
    kind     `LINE` or `STEMS`
    faint    it is there to compare with
    hue      which of the six colours; None: by its place in the chart
    """

    name: str
    x: Array
    y: Array
    kind: str = LINE
    faint: bool = False
    hue: int | None = None


@dataclass(frozen=True)
class Chart:
    """Curves over one axis.

    clock    what the times on it are counted from
    unit     of the values;  x_unit of the times
    marks    instants and what they are
    log      the values may be shown on a logarithmic axis, and are so at first
    """

    key: str
    title: str
    clock: str
    unit: str
    series: Sequence[Series]
    x_unit: str = "s"
    marks: Sequence[tuple[float, str]] = ()
    log: bool = False


@dataclass(frozen=True)
class Net:
    """A net in a clip.

    nodes      (frames, nodes, 3) [m]
    threads    (threads, 2) numbers of nodes, from 0
    tensions   (frames, threads) [N]; None where they are not known
    rim        numbers of the nodes round the mouth, closed; empty where that is not known
    """

    nodes: Array
    threads: Array
    tensions: Array | None = None
    rim: Sequence[int] = ()


@dataclass(frozen=True)
class Swing:
    """How a part of the target swings about a hinge. Its corners are drawn at angle 0, from the centre of mass then.

    angle     of the hinge (frames,) [rad]
    corners   whether each corner of the surface swings (corners,)
    hinge     a point of the axis (3,) [m];  axis  its direction, a unit vector (3,); both in body axes
    lag       way from the hinge to the part's centre of mass at angle 0, times its share of the mass (3,) [m]: by as
              much as that turns the common centre of mass moves
    """

    angle: Array
    corners: Array
    hinge: Array
    axis: Array
    lag: Array


@dataclass(frozen=True)
class Clip:
    """What moved in a phase.

    clock      what its times are counted from
    times      (frames,) [s]
    target     centre of mass (frames, 3) [m]; None where there is none;  attitude (frames, 4), scalar first
    surface    corners (n, 3) [m] in body axes and faces, as numbers of corners
    chaser     (frames, 3) [m]
    line_end   where the line ends at the target or net (frames, 3) [m]; None: there is no line
    tension    of that line (frames,) [N], told by `tension_is`
    held       whether the rest, from the end of the line to a target that is a point, is drawn
    taut       whether it is (frames,)
    bullets    (frames, bullets, 3) [m]
    swing      how a part of the surface swings; None: it is one rigid body
    marks      instants and what they are
    notes      what a reader should know of the clip
    """

    key: str
    title: str
    clock: str
    times: Array
    chaser: Array
    target: Array | None = None
    attitude: Array | None = None
    surface: tuple[Array, list[list[int]]] | None = None
    line_end: Array | None = None
    tension: Array | None = None
    taut: Array | None = None
    held: bool = False
    bullets: Array | None = None
    net: Net | None = None
    swing: Swing | None = None
    marks: Sequence[tuple[float, str]] = ()
    notes: Sequence[str] = field(default_factory=list)
