"""FMUs in the place of ours, as a user runs them: ours from a file give the same bits, faulty ones one clear error."""

from __future__ import annotations

import json
from pathlib import Path

import pyarrow.parquet
import pytest

from dcone_cosim.loading import find
from tests.cosim.conftest import Dcone
from tests.cosim.fmus.build import build

pytestmark = pytest.mark.slow

MESH, STEP = 'mesh = "0.5 m"', 'macro_step = "0.02 s"'
MISSION = find("mission").read_text()
assert (MISSION.count(MESH), MISSION.count(STEP)) == (1, 1)
COARSE = MISSION.replace(MESH, 'mesh = "2 m"').replace(STEP, 'macro_step = "0.05 s"')
"""As of `tests.runs`."""
FOREIGN = """[removal]
fmu = "{fmu}"
isolate = {isolate}
{more}
macro_step = "10 s"
duration = "100 s"

[removal.tether]
rest_length = "14 m"

"""


def towed_by(fmu: Path, isolate: bool, timeout: str = "") -> str:
    """The mission on coarse meshes with another removal; whoever wants its results needs nothing else."""
    more = f'timeout = "{timeout}"' if timeout else ""
    part = FOREIGN.format(fmu=fmu, isolate=str(isolate).lower(), more=more)
    begin, end = COARSE.index("[removal]"), COARSE.index("[handoff]")
    return COARSE[:begin] + part + COARSE[end:]


def test_ours_from_a_file_gives_the_same_bits(dcone: Dcone, tmp_path: Path) -> None:
    """Built, copied away and named in the scene: what comes out is what came out before, to the last bit."""
    (tmp_path / "mission.toml").write_text(COARSE)
    assert dcone("build", "mission.toml", "-o", "fmus")[0] == 0
    capture, removal = (Path(f"fmus/mission-{phase}.fmu") for phase in ("capture", "removal"))
    text = COARSE.replace("[capture]\n", f'[capture]\nfmu = "{capture}"\n')
    (tmp_path / "mine.toml").write_text(text.replace("[removal]\n", f'[removal]\nfmu = "{removal}"\n'))
    assert dcone("run", "mission.toml", "-o", "ours", "--no-figures")[0] == 0
    code, _, err = dcone("run", "mine.toml", "-o", "theirs", "--no-figures")
    assert code == 0, err
    for name in ("capture", "nodes", "removal", "tugs", "removal_without_recoil_tugs"):
        ours, theirs = ((tmp_path / run / f"{name}.parquet").read_bytes() for run in ("ours", "theirs"))
        assert ours == theirs, name
    facts = json.loads((tmp_path / "theirs" / "provenance.json").read_text())["phases"]
    assert [facts[phase]["fmu"]["ours"] for phase in ("capture", "removal")] == [False, False]
    other = dcone("run", "mine.toml", "-o", "other", "--no-figures", "--set", "capture.bullets.speed=3.1 m/s")
    assert other[0] == 0
    assert (tmp_path / "other" / "capture.parquet").read_bytes() != (tmp_path / "ours" / "capture.parquet").read_bytes()


def test_the_scene_kept_runs_again_to_the_same(dcone: Dcone, tmp_path: Path) -> None:
    """With changes of the command line and an FMU named relative to the scene, from another folder."""
    (tmp_path / "scenes").mkdir()
    fmu = build(tmp_path / "scenes")
    (tmp_path / "scenes" / "mine.toml").write_text(towed_by(Path(fmu.name), isolate=False))
    change = ("--set", "capture.bullets.speed=3.1 m/s", "--set", "removal.duration=60 s")
    code, _, err = dcone("run", "scenes/mine.toml", "-o", "first", "--no-figures", *change)
    assert code == 0, err
    assert dcone("run", "first/scene.toml", "-o", "second", "--no-figures")[0] == 0
    for name in ("capture", "removal"):
        assert (tmp_path / "first" / f"{name}.parquet").read_bytes() == (
            tmp_path / "second" / f"{name}.parquet"
        ).read_bytes()
    told = json.loads((tmp_path / "first" / "provenance.json").read_text())
    assert told["settings"] == ["capture.bullets.speed=3.1 m/s", "removal.duration=60 s"]
    assert pyarrow.parquet.read_table(tmp_path / "first" / "removal.parquet").num_rows == 7


@pytest.mark.parametrize(
    ("switch", "isolate", "timeout", "told"),
    [
        ("CRASH", True, "", "ended by SIGSEGV"),
        ("HANG", True, "2 s", "did not answer within 2 s and was killed"),
        ("EXIT=3", True, "", "ended itself with exit code 3"),
        ("NOT_A_NUMBER=SEPARATION", False, "", "its output separation is nan"),
        ("ERROR", False, "", "the winch jammed"),
        ("CRASH_AT_START", True, "", "ended by SIGSEGV"),
    ],
)
def test_a_faulty_one_is_one_error_and_costs_no_results(
    dcone: Dcone, tmp_path: Path, switch: str, isolate: bool, timeout: str, told: str
) -> None:
    """The capture before it is whole, and so are the rows of the removal up to the fault."""
    (tmp_path / "mine.toml").write_text(towed_by(build(tmp_path / "fmu", "removal", switch), isolate, timeout))
    code, out, err = dcone("run", "mine.toml", "-o", "out", "--no-figures")
    assert code == 5, err
    assert "Traceback" not in err
    assert err.count(told) == 1
    assert "my_removal.fmu" in err
    assert "results in out" in out
    captured = pyarrow.parquet.read_table(tmp_path / "out" / "capture.parquet")
    assert captured["captured"].to_pylist()[-1]
    facts = json.loads((tmp_path / "out" / "provenance.json").read_text())
    assert (facts["status"], facts["exit_code"]) == ("FMU failed", 5)
    assert told in facts["message"]
    if switch != "CRASH_AT_START":
        assert pyarrow.parquet.read_table(tmp_path / "out" / "removal.parquet").num_rows >= 4


def test_a_sound_one_is_towed(dcone: Dcone, tmp_path: Path) -> None:
    """The twin of all above."""
    (tmp_path / "mine.toml").write_text(towed_by(build(tmp_path / "fmu"), isolate=True))
    code, _, err = dcone("run", "mine.toml", "-o", "out", "--no-figures")
    assert code == 0, err
    assert pyarrow.parquet.read_table(tmp_path / "out" / "removal.parquet").num_rows == 11


@pytest.mark.parametrize(("switch", "code"), [("LIES=TETHER_PAID_OUT", 5), ("IGNORES_STATE", 5), ("", 0)])
def test_a_capture_that_lies_about_its_state(dcone: Dcone, tmp_path: Path, switch: str, code: int) -> None:
    fmu = build(tmp_path / "fmu", "capture", *([switch] if switch else []))
    text = f'[capture]\nfmu = "{fmu}"\nmacro_step = "0.5 s"\nduration = "20 s"\n'
    (tmp_path / "mine.toml").write_text(text)
    given, _, err = dcone("run", "mine.toml", "-o", "out", "--no-figures")
    assert given == code, err
    assert ("its state does not restore" in err) == bool(switch)
    assert pyarrow.parquet.read_table(tmp_path / "out" / "capture.parquet").num_rows >= 10


def test_a_controller_beside_the_removal(dcone: Dcone, tmp_path: Path) -> None:
    """Ours as a second component: told in the provenance with its connections and the steps it took."""
    (tmp_path / "mine.toml").write_text(
        find("table2-deorbit")
        .read_text()
        .split("[removal.reel]")[0]
        .replace('duration = "1 day"', 'duration = "20 min"')
        + """
[removal.reel]
law = "commanded"
[removal.components.controller]
model = "reel_control"
[removal.components.controller.gain]
proportional = "4e-3 N/m"
"""
    )
    wires = [
        "removal.tether.length -> controller.length",
        "removal.tether.length_rate -> controller.length_rate",
        "controller.tension -> removal.reel.tension",
    ]
    code, _, err = dcone(
        "run", "mine.toml", "-o", "out", "--no-figures", "--set", f"removal.connections={json.dumps(wires)}",
        "--set", "removal.coupling.step=5 s",
    )  # fmt: skip
    assert code == 0, err
    phase = json.loads((tmp_path / "out" / "provenance.json").read_text())["phases"]["removal"]
    assert phase["connections"] == wires
    assert phase["components"]["controller"]["parameters"]["gain.proportional"] == 4e-3
    assert phase["components"]["controller"]["fmu"]["model"] == "reel_control"
    assert phase["coupling"]["step"] == {"value": 5.0, "unit": "s"}
    assert phase["coupling"]["statistics"]["steps"] == 240
    columns = pyarrow.parquet.read_table(tmp_path / "out" / "removal.parquet").column_names
    assert "controller.tension" in columns
    code, out, err = dcone("inspect", "out/scene.toml")
    assert code == 0, err
    assert "removal, controller: reel_control" in out
    assert "controller.tension -> removal.reel.tension" in out


def test_what_an_fmu_prints_is_not_in_the_answer(dcone: Dcone, tmp_path: Path) -> None:
    """In this process its binary writes to our stdout; the answer for machines stays JSON."""
    fmu = build(tmp_path, "removal", "NOISE", when=-1.0)
    (tmp_path / "noisy.toml").write_text(FOREIGN.format(fmu=fmu, isolate="false", more=""))
    code, out, err = dcone("run", "noisy.toml", "-o", "noisy", "--no-figures", "--json")
    assert code == 0, err
    assert json.loads(out)["status"] == "completed"
    assert "noise" in err


@pytest.mark.parametrize("knows", [True, False])
def test_where_the_line_is_made_fast_is_handed_over_or_its_line_longer(
    dcone: Dcone, tmp_path: Path, knows: bool
) -> None:
    """An FMU that does not know the distance of the attachment keeps the slack by a longer line, and the scene's check,
    the ledger and the summary say so; one that knows it has the line of the scene."""

    def without(xml: str) -> str:
        return xml if knows else xml.replace('name="target.attachment_distance"', 'name="size.of_something"')

    (tmp_path / "mine.toml").write_text(towed_by(build(tmp_path / "theirs", change=without), isolate=False))
    told = "has no target.attachment_distance: its line is longer by as much"
    code, out, err = dcone("validate", "mine.toml")
    assert code == 0
    assert (told in " ".join((out + err).split())) is not knows
    code, _, err = dcone("run", "mine.toml", "-o", "out", "--no-figures")
    assert code == 0, err
    ledger = json.loads((tmp_path / "out" / "ledger.json").read_text())
    rows = {row["quantity"]: row for row in ledger["rows"] if row["unit"] == "m"}
    offset = rows["attachment to centre of mass"]
    assert offset["before"] == pytest.approx(1.98, abs=0.1)
    assert offset["after"] == (offset["before"] if knows else 0.0)
    line = rows["length of the line"]
    assert (line["before"], line["after"]) == (
        14.0,
        14.0 if knows else pytest.approx(14.0 + offset["before"], rel=1e-14),
    )
    assert (told in line["account"]) is not knows
    slack = rows["slack of the line"]
    assert 0.0 <= slack["after"] - slack["before"] < 2e-3
    assert ("target.attachment_distance" in ledger["set_in_removal"]) is knows
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())["hand-off"]
    assert (told in str(summary)) is not knows
