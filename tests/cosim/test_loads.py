"""What lines bore, by hand: stress, strain, margin; and a run one of whose lines bore more than it can."""

from __future__ import annotations

import io
import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import pytest
from rich.console import Console

from dcone_cosim import loads
from dcone_cosim.errors import CAPTURE_FAILED, OVERLOADED, SUCCESS
from dcone_cosim.findings import Finding
from dcone_cosim.recorder import TugLog
from dcone_cosim.reports import summary
from dcone_cosim.reports.warnings import warnings
from dcone_cosim.results import RunResult
from dcone_cosim.scene.data import LineScene, Scene
from orbital.materials import MATERIALS, Material
from tests.cosim.conftest import Dcone
from tests.cosim.test_summary import removal_run

MakeScene = Callable[..., Scene]
LINE = {"tether.youngs_modulus": 60e9, "tether.diameter": 1e-3}
"""Of 0.785398 mm2: E A = 47,123.9 N, and Kevlar 29, 2920 MPa, breaks at 2293.36 N."""
KEVLAR = LineScene(MATERIALS["Kevlar 29"], 2.92e9)


def tow(
    make_scene: MakeScene,
    tension: Sequence[float],
    line: LineScene | None = KEVLAR,
    parameters: Mapping[str, float] = LINE,
    **more: Sequence[float],
) -> RunResult:
    scene = make_scene("removal")
    main = replace(scene.phases[0].main, lines={} if line is None else {"tether": line})
    scene = replace(scene, phases=(replace(scene.phases[0], main=main),))
    columns = {"tether.tension_peak": tension, **{name.replace("_", ".", 1): column for name, column in more.items()}}
    run = removal_run(scene, columns, [0.0, 50.0, 100.0], TugLog(1))
    run.parameters = {"removal": dict(parameters)}
    return run


def rows(run: RunResult) -> dict[str, Finding]:
    return {row.key: row for row in summary.findings(run)}


def test_stress_strain_and_margin_by_hand(make_scene: MakeScene) -> None:
    """1000 N over 0.785398 mm2: 1273.24 MPa, 2.12207 % of E A, and 2293.36 / 1000 - 1 to spare."""
    found = rows(tow(make_scene, [0.0, 1000.0, 1.0]))
    assert found["line.stress"].value == pytest.approx(1273.24e6, rel=1e-5)
    assert found["line.stress"].shown() == "1273.24 MPa"
    assert found["line.strain"].value == pytest.approx(0.0212207, rel=1e-5)
    assert found["line.strength"].value == pytest.approx(2.92e9, rel=1e-12)
    assert found["line.margin_of_safety"].value == pytest.approx(1.29336, rel=1e-5)
    assert found["line.material"].value == "Kevlar 29, yarn"


def test_a_tug_between_the_rows_counts(make_scene: MakeScene) -> None:
    run = tow(make_scene, [0.0, 10.0, 1.0])
    tugs = run.phases["removal"].tugs
    assert tugs is not None
    tugs.rows[1] = (20.0, 1000.0, 0.01)
    assert rows(run)["line.margin_of_safety"].value == pytest.approx(1.29336, rel=1e-5)


def test_without_a_strength_none_is_guessed(make_scene: MakeScene) -> None:
    found = rows(tow(make_scene, [0.0, 1000.0, 1.0], None))
    assert found["line.stress"].value == pytest.approx(1273.24e6, rel=1e-5)
    assert found["line.margin_of_safety"].value == "strength not known: name a material in [removal.tether]"
    assert "line.strength" not in found
    nothing = rows(tow(make_scene, [0.0, 1000.0, 1.0], None, {}))
    assert str(nothing["line.stress"].value).startswith("section not known")
    assert "line.strain" not in nothing
    thick = rows(tow(make_scene, [0.0, 1000.0, 1.0], KEVLAR, {}))
    assert thick["line.margin_of_safety"].value == "section not known: name a diameter in [removal.tether]"
    slack = rows(tow(make_scene, [0.0, 0.0, 0.0]))
    assert slack["line.margin_of_safety"].value == "it bore nothing"


def test_a_line_that_broke_has_no_margin_left(make_scene: MakeScene) -> None:
    """The instant of a break is found to a millionth of the strength: what is left beside it is no margin."""
    breaks_at = 2.92e9 * math.pi / 4.0 * 1e-6
    for share, expected in ((1.0 - 1e-8, 0.0), (1.0 + 1e-8, 0.0), (1.0 - 1e-4, 1.0e-4)):
        found = rows(tow(make_scene, [0.0, share * breaks_at, 0.0]))
        assert found["line.margin_of_safety"].value == pytest.approx(expected, rel=1e-3, abs=0.0)


@pytest.mark.parametrize(("share", "overloaded"), [(1.01, True), (0.99, False)])
def test_a_line_a_hundredth_beyond_its_strength(make_scene: MakeScene, share: float, overloaded: bool) -> None:
    """Told first, in the summary for machines, in the warnings; its twin a hundredth below is as any run."""
    run = tow(make_scene, [0.0, share * 2293.36, 1.0])
    loads.judge(run)
    assert (run.status, run.exit_code) == (("overloaded", OVERLOADED) if overloaded else ("completed", SUCCESS))
    margin = rows(run)["line.margin_of_safety"].value
    assert isinstance(margin, float)
    assert margin == pytest.approx(1 / share - 1, rel=1e-3)
    console = Console(file=io.StringIO(), width=300)
    summary.show(run, console)
    printed = console.file.getvalue()  # type: ignore[attr-defined]
    told = summary.as_dict(run)
    sentence = "OVERLOADED: removal: the tether (Kevlar 29, yarn) bore 2316 N, and breaks at 2293 N"
    assert printed.startswith(sentence) is overloaded
    assert (sentence in printed) is overloaded
    assert str(told["message"]).startswith(sentence) is overloaded
    assert any(row.startswith(sentence) for row in told["warnings"]) is overloaded
    assert told["status"] == run.status


def test_what_failed_otherwise_keeps_its_outcome(make_scene: MakeScene) -> None:
    run = tow(make_scene, [0.0, 3000.0, 1.0])
    run.fail("capture failed", "missed", CAPTURE_FAILED)
    loads.judge(run)
    assert (run.status, run.exit_code, run.message) == ("capture failed", CAPTURE_FAILED, "missed")
    assert loads.headlines(run)[0].startswith("OVERLOADED")


def test_a_line_that_may_break_is_not_overloaded(make_scene: MakeScene) -> None:
    """Where the model lets it break, its load counts and not the material's; what broke is told, and is no failure."""
    breaking = {**LINE, "break.strength": 900.0}
    held = tow(make_scene, [0.0, 899.0, 1.0], KEVLAR, breaking, break_broken=[0, 0, 0], break_time=[0, 0, 0])
    loads.judge(held)
    assert held.status == "completed"
    assert rows(held)["line.strength"].value == pytest.approx(900.0 / 0.785398e-6, rel=1e-6)
    broke = tow(make_scene, [0.0, 900.0, 0.0], KEVLAR, breaking, break_broken=[0, 1, 1], break_time=[0, 44.5, 44.5])
    loads.judge(broke)
    assert (broke.status, broke.exit_code) == ("broken", SUCCESS)
    assert broke.message == "BROKEN: removal: the tether (Kevlar 29, yarn) broke at 44.5 s, at 900 N"


def net(make_scene: MakeScene, lines: Mapping[str, LineScene], **columns: float) -> RunResult:
    """Table 1's net: 1200 m of thread weigh 0.33 kg, so A = 0.190972 mm2; the nylon cord has E A = 903 N."""
    scene = make_scene("capture")
    main = replace(scene.phases[0].main, terms={"net": "square", "closing": "winches"}, lines=lines)
    scene = replace(scene, phases=(replace(scene.phases[0], main=main),))
    tensions = {f"{name}.tension_max": [0.0, value] for name, value in columns.items()}
    run = removal_run(scene, tensions, [0.0, 1.0], TugLog(1))
    run.phases = {"capture": run.phases["removal"]}
    values = {"net.side": 24.0, "net.mesh": 1.0, "net.mass": 0.33, "net.density": 1440.0, "net.youngs_modulus": 70e9}
    values["net.damping_ratio"] = 0.106
    run.parameters = {"capture": values | {"closing.axial_stiffness": 903.0}}
    return run


def test_threads_and_cord_by_hand(make_scene: MakeScene) -> None:
    """60 N over 0.190972 mm2: 314.18 MPa; 150 N over 903 N / 4.56 GPa = 0.198026 mm2: 757.48 MPa, 16.611 %."""
    nylon = LineScene(MATERIALS["nylon 66"], MATERIALS["nylon 66"].strength)
    found = rows(net(make_scene, {"net": KEVLAR, "closing": nylon}, thread=60.0, cord=150.0))
    assert found["thread.stress"].value == pytest.approx(314.18e6, rel=1e-4)
    assert found["thread.margin_of_safety"].value == pytest.approx(2920 / 314.18 - 1, rel=1e-4)
    assert found["cord.stress"].value == pytest.approx(757.48e6, rel=1e-4)
    assert found["cord.strain"].value == pytest.approx(0.16611, rel=1e-4)
    assert found["cord.margin_of_safety"].value == pytest.approx(957.6 / 757.48 - 1, rel=1e-4)
    thin = replace(nylon, diameter=0.4e-3)
    found = rows(net(make_scene, {"closing": thin}, cord=150.0))
    assert found["cord.stress"].value == pytest.approx(150.0 / 0.1256637e-6, rel=1e-6)


def test_the_load_of_a_net_is_one_sample(make_scene: MakeScene) -> None:
    """A stress scatters as its tension; of a margin m by (1 + m)/m as much; near the strength others may break."""
    run = net(make_scene, {"net": KEVLAR}, thread=60.0)
    found = rows(run)
    spread = found["thread.stress"].spread
    assert spread > 0.1
    assert found["thread.strain"].spread == spread
    assert found["thread.margin_of_safety"].spread == pytest.approx(spread * 9.294 / 8.294, rel=1e-3)
    assert found["thread.stress"].shown().startswith("~")
    assert not [row for row in warnings(run) if "others may break it" in row]
    near = net(make_scene, {"net": KEVLAR}, thread=500.0)
    assert [row for row in warnings(near) if "others may break it" in row]
    beyond = net(make_scene, {"net": KEVLAR}, thread=563.0)
    loads.judge(beyond)
    assert beyond.status == "overloaded"
    assert "one sample of many" in beyond.message


def test_one_line_of_several(make_scene: MakeScene) -> None:
    nylon = LineScene(MATERIALS["nylon 66"], MATERIALS["nylon 66"].strength)
    run = net(make_scene, {"net": KEVLAR, "closing": nylon}, thread=600.0, cord=200.0)
    assert [line.partition(":")[2].split(" (")[0] for line in loads.headlines(run)] == [
        " capture: a thread of the net",
        " capture: the closing cord",
    ]


SCENE = """
[orbit]
altitude = "800 km"
inclination = "98 deg"
[materials.weak]
youngs_modulus = "60 GPa"
density = "1440 kg/m3"
strength = "3.74 MPa"
[removal]
macro_step = "60 s"
duration = "1140 s"
[removal.reel]
law = "locked"
[removal.tether]
material = "weak"
[removal.thrust]
direction = "along_track"
level = "-0.01 N"
specific_impulse = "3000 s"
"""


def test_by_the_program(dcone: Dcone) -> None:
    """The first tug of Table 2 is 2.96659 N (reference), over 0.785398 mm2 3.7772 MPa: 1 % over 3.74 MPa, 1 % under
    3.815 MPa. A sweep has either as the outcome of its case, with all figures."""
    Path("weak.toml").write_text(SCENE)
    code, out, err = dcone("run", "weak.toml", "--no-figures", "-o", "over")
    assert code == OVERLOADED == 8
    assert out.startswith("OVERLOADED: removal: the tether (weak, yarn) bore 2.967 N, and breaks at 2.937 N")
    assert (out + err).count("OVERLOADED") == 1
    told = json.loads(Path("over/summary.json").read_text())
    assert (told["status"], told["exit_code"]) == ("overloaded", 8)
    assert told["removal"]["line.margin_of_safety"]["value"] == pytest.approx(3.74 / 3.7772 - 1, rel=1e-2)
    assert told["removal"]["line.stress"] == {"value": pytest.approx(3.7772e6, rel=1e-4), "unit": "Pa"}
    code, out, _ = dcone(
        "run", "weak.toml", "--no-figures", "-o", "under", "--set", "materials.weak.strength=3.815 MPa"
    )
    assert code == SUCCESS
    assert "OVERLOADED" not in out
    vary = "materials.weak.strength=3.74 MPa,3.815 MPa"
    code, _, _ = dcone("sweep", "weak.toml", "--vary", vary, "-o", "both", "--jobs", "1")
    assert code == 7
    import pandas as pd

    table = pd.read_parquet("both/table.parquet")
    assert table["status"].tolist() == ["overloaded", "completed"]
    assert table["removal.line.stress"].nunique() == 1
    assert table["exit_code"].tolist() == [8, 0]


def test_a_material_that_is_not_known_is_no_other(make_scene: MakeScene) -> None:
    """A strength of the scene's own in place of the material's."""
    own = LineScene(MATERIALS["Kevlar 29"], 1e9)
    assert rows(tow(make_scene, [0.0, 700.0, 0.0], own))["line.margin_of_safety"].value == pytest.approx(
        785.398 / 700.0 - 1, rel=1e-5
    )
    unknown = LineScene(Material("mine", 60e9, 1000.0))
    told = rows(tow(make_scene, [0.0, 700.0, 0.0], unknown))["line.margin_of_safety"].value
    assert str(told).startswith("strength not known")
