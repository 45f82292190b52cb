"""Arrays as a page holds them, decoded by hand; and whether the colours of tensions are told apart by all."""

from __future__ import annotations

import base64
from typing import Any

import numpy as np
import pytest

from dcone_cosim.report import packing
from dcone_cosim.report.page import colours

KINDS = {"f4": "<f4", "f8": "<f8", "u1": "u1", "u2": "<u2", "u4": "<u4"}
PROTAN = np.array([[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]])
DEUTAN = np.array([[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]])
TRITAN = np.array([[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]])
"""Machado, Oliveira and Fernandes (2009), severity 1.0, of linear RGB."""
GROUND = (0x10, 0x15, 0x1B)


def decoded(packed: dict[str, Any]) -> np.ndarray:
    values = np.frombuffer(base64.b64decode(packed["data"]), dtype=KINDS[packed["type"]])
    return values.reshape(packed["shape"])


def newtons(packed: dict[str, Any]) -> np.ndarray:
    """Tensions of codes, by what the scale is: each code is a ratio of (1/floor)^(1/254) more than the one below."""
    ratio = (1.0 / packed["floor"]) ** (1.0 / 254.0)
    codes = decoded(packed).astype(float)
    return np.where(codes > 0, packed["most"] / ratio ** (255.0 - codes), 0.0)


def test_places_are_within_half_a_step() -> None:
    random = np.random.default_rng(1)
    places = random.uniform(-40.0, 60.0, (5, 7, 3)) * [1.0, 0.1, 0.0]
    packed = packing.places(places)
    again = np.array(packed["low"]) + np.array(packed["step"]) * decoded(packed)
    assert (np.abs(again - places) <= 0.5 * np.array(packed["step"]) + 1e-12).all()
    assert packed["step"][0] < 100.0 / 65000.0


def test_tensions_are_within_their_scale_and_what_is_slack_stays_slack() -> None:
    pull = np.array([[0.0, 1e-9, 0.0501, 0.3], [50.0, 12.0, 0.0499, 49.9]])
    packed = packing.tensions(pull, 50.0)
    told = newtons(packed)
    assert (told == 0.0).tolist() == [[True, True, False, False], [False, False, True, False]]
    shown = told > 0.0
    assert told[shown] == pytest.approx(pull[shown], rel=0.014)
    assert decoded(packed).max() == 255
    assert not decoded(packing.tensions(np.zeros(3), 0.0)).any()


def test_a_long_curve_keeps_its_extremes() -> None:
    x = np.linspace(0.0, 1.0, 100_001)
    y = np.sin(50.0 * x)
    y[77_777], y[3] = 9.0, -7.0
    thin_x, thin_y = packing.thinned(x, y)
    assert len(thin_x) <= packing.MOST_POINTS
    assert (thin_y.max(), thin_y.min()) == (9.0, -7.0)
    assert thin_x[np.argmax(thin_y)] == x[77_777]
    assert (thin_x[0], thin_x[-1]) == (0.0, 1.0)


def linear(rows: np.ndarray) -> np.ndarray:
    share = rows / 255.0
    return np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)


def luminance(rows: np.ndarray) -> np.ndarray:
    """Relative luminance of linear RGB (sRGB, IEC 61966-2-1)."""
    return rows @ [0.2126, 0.7152, 0.0722]


@pytest.mark.parametrize("eye", [np.eye(3), PROTAN, DEUTAN, TRITAN], ids=["all", "protan", "deutan", "tritan"])
def test_more_tension_is_lighter_to_every_eye(eye: np.ndarray) -> None:
    seen = luminance(np.clip(linear(np.array(colours()).reshape(-1, 3)) @ eye.T, 0.0, 1.0))
    light = np.cbrt(seen)
    steps = np.diff(light[::8])
    assert (steps > 0.0).all()
    assert steps.max() < 4.0 * steps.min(), "evenly enough to be read off"


def test_the_least_tension_stands_off_from_the_ground() -> None:
    """A contrast of 3:1 is what WCAG 2.1, 1.4.11 asks of graphics."""
    rows = luminance(linear(np.array([*np.array(colours()).reshape(-1, 3)[:1], GROUND], dtype=float)))
    assert (rows[0] + 0.05) / (rows[1] + 0.05) > 3.0
