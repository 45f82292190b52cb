"""The picture an FMU carries: a small drawing of its model, the same bytes each time it is made."""

from __future__ import annotations

import io
import math
from collections.abc import Callable, Mapping

from fmu_src.interface import Interface

WIDTH, HEIGHT, FINER, COLOURS = 480, 270, 4, 48
SKY, STAR, EARTH, AIR = "#0f1b2d", "#8fa3bd", "#2a6f97", "#61a5c2"
BODY, PANEL, LINE, FLAME, GREY = "#e9ecef", "#4895ef", "#ffd166", "#f3722c", "#adb5bd"
Point = tuple[float, float]


class Canvas:
    """Draws in picture points, finer than they are shown."""

    def __init__(self) -> None:
        from PIL import Image, ImageDraw  # here, since an FMU of the cache has its picture

        self.image = Image.new("RGB", (WIDTH * FINER, HEIGHT * FINER), SKY)
        self._draw = ImageDraw.Draw(self.image)

    def line(self, points: list[Point], colour: str = LINE, width: float = 1.0) -> None:
        self._draw.line(_fine(points), fill=colour, width=round(width * FINER), joint="curve")

    def shape(self, points: list[Point], colour: str) -> None:
        self._draw.polygon(_fine(points), fill=colour)

    def disc(self, centre: Point, radius: float, colour: str) -> None:
        (x, y), r = centre, radius
        self._draw.ellipse(_fine([(x - r, y - r), (x + r, y + r)]), fill=colour)

    def box(self, centre: Point, size: Point, colour: str, turn: float = 0.0) -> None:
        """A rectangle turned by `turn` [rad] about its centre."""
        c, s = math.cos(turn), math.sin(turn)
        corners = [(a * size[0] / 2, b * size[1] / 2) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        self.shape([(centre[0] + c * x - s * y, centre[1] + s * x + c * y) for x, y in corners], colour)

    def stars(self, seed: int, count: int = 60) -> None:
        """Dots by a linear congruential generator, so that they are the same everywhere."""
        for _ in range(count):
            seed = (1103515245 * seed + 12345) % 2**31
            x, y = seed % 4801 / 10, seed // 4801 % 2701 / 10
            self.disc((x, y), 0.4 + seed % 5 / 8, STAR)


def _fine(points: list[Point]) -> list[Point]:
    return [(x * FINER, y * FINER) for x, y in points]


def _satellite(canvas: Canvas, centre: Point, size: float, turn: float) -> None:
    """A box between two panels."""
    c, s = math.cos(turn), math.sin(turn)
    for side in (-1, 1):
        middle = (centre[0] + side * 1.25 * size * c, centre[1] + side * 1.25 * size * s)
        canvas.box(middle, (1.3 * size, 0.62 * size), PANEL, turn)
        canvas.line([(middle[0] - 0.6 * size * c, middle[1] - 0.6 * size * s),
                     (middle[0] + 0.6 * size * c, middle[1] + 0.6 * size * s)], SKY, 1.0)  # fmt: skip
    canvas.box(centre, (0.9 * size, 0.9 * size), BODY, turn)


def _net(canvas: Canvas, mouth: tuple[Point, Point], vertex: Point, meshes: int = 9) -> None:
    """A bag of square meshes seen from the side: threads from the mouth to the vertex, and hoops across them."""
    (top, bottom) = mouth

    def point(across: float, along: float) -> Point:
        edge = (top[0] + across * (bottom[0] - top[0]), top[1] + across * (bottom[1] - top[1]))
        slack = (1.0 - along) ** 1.7
        x = vertex[0] + (edge[0] - vertex[0]) * along**0.8
        return x, vertex[1] + (edge[1] - vertex[1]) * (1.0 - slack)

    for i in range(meshes + 1):
        canvas.line([point(i / meshes, k / 24) for k in range(25)], LINE, 0.8)
        canvas.line([point(k / 24, i / meshes) for k in range(25)], LINE, 0.8)
    for bullet in mouth:
        canvas.disc(bullet, 6.0, FLAME)


def _net_capture(canvas: Canvas) -> None:
    canvas.stars(7)
    _satellite(canvas, (372.0, 130.0), 46.0, 1.15)
    _net(canvas, ((322.0, 34.0), (330.0, 232.0)), (196.0, 140.0))
    canvas.line([(70.0, 162.0), (112.0, 166.0), (154.0, 156.0), (196.0, 140.0)], GREY, 1.2)
    _satellite(canvas, (52.0, 160.0), 30.0, 1.5)


def _tethered_deorbit(canvas: Canvas) -> None:
    canvas.stars(11)
    canvas.disc((240.0, 830.0), 640.0, AIR)
    canvas.disc((240.0, 830.0), 630.0, EARTH)
    chaser, target = (124.0, 112.0), (366.0, 104.0)
    canvas.line([chaser, target], LINE, 1.6)
    canvas.shape([(60.0, 96.0), (98.0, 106.0), (98.0, 122.0), (60.0, 130.0), (34.0, 114.0)], FLAME)
    canvas.shape([(70.0, 105.0), (98.0, 109.0), (98.0, 119.0), (70.0, 122.0), (54.0, 114.0)], LINE)
    _satellite(canvas, chaser, 38.0, 1.57)
    _satellite(canvas, target, 30.0, 0.6)
    for k in range(-3, 4):
        canvas.line([(target[0] - 34.0, target[1]), (target[0] + 12.0, target[1] + 11.0 * k)], LINE, 0.8)
    canvas.line([(210.0, 170.0), (180.0, 174.0), (150.0, 184.0)], GREY, 2.0)
    canvas.shape([(138.0, 188.0), (154.0, 176.0), (157.0, 190.0)], GREY)


def _block(canvas: Canvas, inputs: int, outputs: int) -> None:
    """Any other model: a box with as many arrows as it has inputs and outputs, at most eight a side."""
    canvas.box((240.0, 135.0), (190.0, 190.0), PANEL)
    canvas.box((240.0, 135.0), (176.0, 176.0), SKY)
    canvas.line([(175.0, 190.0), (220.0, 182.0), (250.0, 140.0), (262.0, 92.0), (305.0, 84.0)], LINE, 3.0)
    for count, left in ((inputs, 40.0), (outputs, 345.0)):
        for k in range(min(count, 8)):
            y = 135.0 + 22.0 * (k - (min(count, 8) - 1) / 2)
            canvas.line([(left, y), (left + 80.0, y)], BODY, 2.0)
            canvas.shape([(left + 78.0, y - 6.0), (left + 92.0, y), (left + 78.0, y + 6.0)], BODY)


DRAWINGS: Mapping[str, Callable[[Canvas], None]] = {
    "net_capture": _net_capture,
    "tethered_deorbit": _tethered_deorbit,
}


def png(interface: Interface) -> bytes:
    """The picture as PNG, without a date or a version in it.

    Checked  tests/packaging/test_page_and_picture.py
    """
    from PIL import Image

    canvas = Canvas()
    draw = DRAWINGS.get(interface.model.name)
    if draw:
        draw(canvas)
    else:
        causality = [v.causality for v in interface.variables for _ in range(v.size)]
        _block(canvas, causality.count("input"), causality.count("output"))
    small = canvas.image.resize((WIDTH, HEIGHT), Image.Resampling.BOX)
    data = io.BytesIO()
    small.quantize(COLOURS, method=Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE).save(data, "PNG", optimize=True)
    return data.getvalue()
