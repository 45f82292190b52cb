"""Shots and tows of everything that a scene may name and no shipped scene has, several at a time, small and short.

They are settings of two bare scenes, with the files that some of them read. What must come together is what claims
memory: planes, words and rows of one part lie behind those of others.
"""

from __future__ import annotations

import itertools
import math
from pathlib import Path

SHOT = """title = "A shot with what every scene must have"
phases = ["capture"]

[orbit]
altitude = "800 km"

[capture]
macro_step = "0.02 s"
duration = "6 s"
hand_over = "none"

[capture.net]
shape = "square"
side = "6 m"
mesh = "0.5 m"

[capture.gravity]
law = "none"

[capture.bullets]
mass = "0.26 kg"
speed = "3 m/s"
angle = "40 deg"

[capture.vertex]
mass = "0.05 kg"

[capture.chaser]
mass = "500 kg"
start_position = ["0 m", "-6 m", "0 m"]
"""
TOW = """title = "A tow with what every scene must have"
phases = ["removal"]

[orbit]
altitude = "800 km"
inclination = "98 deg"

[removal]
macro_step = "10 s"
duration = "2 h"

[removal.chaser]
mass = "2000 kg"

[removal.target]
mass = "1000 kg"

[removal.start]
condition = "same_orbit"
separation = "10 m"

[removal.tether]
diameter = "1 mm"
"""


def _ends() -> list[tuple[int, int]]:
    """Threads of sixteen meridians and three rings about a node in the middle."""
    spokes = [(0, 1 + k) for k in range(16)]
    rings = [(1 + 16 * ring + k, 1 + 16 * ring + (k + 1) % 16) for ring in range(3) for k in range(16)]
    return spokes + rings + [(1 + k, 17 + k) for k in range(32)]


def write(folder: Path) -> None:
    """Both scenes and the files that compositions of them name, into a folder: a net with eight bullets, a gravity that
    begins with a fall, and a closed mesh."""
    (folder / "shot.toml").write_text(SHOT)
    (folder / "tow.toml").write_text(TOW)
    ways = [(math.cos(math.tau * k / 16.0), math.sin(math.tau * k / 16.0)) for k in range(16)]
    places = [(0.0, 0.0), *((radius * x, radius * y) for radius in (1.0, 2.0, 3.0) for x, y in ways)]
    roles = ["vertex", *[""] * 32, *["mouth", "corner"] * 8]
    nodes = (f"{k}, {x:.9f}, {y:.9f}, 0, {its}" for k, ((x, y), its) in enumerate(zip(places, roles, strict=True), 1))
    (folder / "nodes.csv").write_text("\n".join(["node, x [m], y [m], z [m], role", *nodes, ""]))
    threads = (f"{a + 1}, {b + 1}, 0.5" for a, b in _ends())
    (folder / "threads.csv").write_text("\n".join(["from, to, diameter [mm]", *threads, ""]))
    (folder / "falls.csv").write_text("0, 0, 0, 0\n1, 0, 0, -9.81\n")
    corners = itertools.product((-0.6, 0.6), (-1.0, 1.0), (-0.6, 0.6))
    sides = (1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4)
    vertices = [f"v {x} {y} {z}" for x, y, z in corners]
    (folder / "box.obj").write_text("\n".join([*vertices, *(f"f {' '.join(map(str, side))}" for side in sides), ""]))


TURNING = 'mass="200 kg", start_rate=["0 deg/s", "0 deg/s", "2 deg/s"]'
SQUARE_BOX = f'capture.target={{shape="box", size=["1.2 m", "2 m", "1.2 m"], {TURNING}}}'
CYLINDER = f'capture.target={{shape="cylinder", radius="0.6 m", length="2 m", {TURNING}}}'
SPHERE = f'capture.target={{shape="sphere", radius="0.9 m", {TURNING}}}'
FRUSTUM = f'capture.target={{shape="frustum", radius_bottom="0.9 m", radius_top="0.3 m", length="2 m", {TURNING}}}'
MESH = f'capture.target={{shape="mesh", mesh="box.obj", mesh_unit="1 m", {TURNING}}}'
UNION = """capture.target={shape="union", start_rate=["0 deg/s", "1 deg/s", "1 deg/s"], parts=[
{shape="box", size=["1.2 m", "1.2 m", "1.2 m"], mass="150 kg"},
{shape="cylinder", radius="4 cm", length="0.84 m", mass="4 kg", position=["0 m", "0 m", "1 m"]},
{shape="frustum", radius_bottom="0.5 m", radius_top="0.2 m", length="0.5 m", mass="9 kg",
position=["0 m", "0.8 m", "0 m"]},
{shape="sphere", radius="0.3 m", mass="5 kg", position=["0.7 m", "0 m", "0 m"]}]}""".replace("\n", "")
HINGED = UNION.replace('position=["0 m", "0 m", "1 m"]', 'position=["0 m", "0 m", "1 m"], hinged=true')
HINGE = 'capture.hinge={position=["0 m", "0 m", "0.6 m"], stiffness="5 N m/rad", start_rate="40 deg/s"}'
HEXAGON, RADIAL = (f'capture.net={{shape="{shape}", radius="3 m", mesh="0.5 m"}}' for shape in ("hexagon", "radial"))
INELASTIC, PENALTY = "capture.contact.law=inelastic", "capture.contact.law=penalty"
WINCHES = 'capture.closing={drive="winches", time="2.2 s", rings=3}'
SPRINGS = 'capture.closing={drive="springs", time="2.2 s", force_rate="0.1 N/m", pulled="pays_out"}'
PULL = 'capture.pull_off={after="time", time="4 s", duration="1 s", ramp="0.3 s"}'
QUALITY = 'capture.quality={characteristic_length="1.4 m"}'
QUALITY_TOLD = 'capture.quality={characteristic_length="1.4 m", target_volume="2.9 m3", target_surface="12.5 m2"}'
EVERY = "capture.nodes={}", "capture.threads={}", "capture.tensions={}"
EDGE, KNOTS = "capture.edge.diameter=2 mm", 'capture.knots={mass="0.2 g", compliance="0.1 mm/N"}'
LEADS = 'capture.leads={length="0.5 m", segments=3}'
SLACK = 'capture.tether={state="slack", length="20 m"}'
DRAGGING = 'capture.tether={state="dragging", length="20 m", friction="0.1 N"}'
FALLING = 'capture.gravity={law="history", history="falls.csv", on_chaser=true}'
EJECTED = 'capture.ejection={delay=["0 s", "1 ms", "0 s", "2 ms"]}'
RUBBING = 'capture.wrap={bends="friction", friction=0.2}'
ACCORDION = 'capture.canister={width="0.2 m", depth="0.15 m"}', "capture.folding.pattern=accordion"
STAR = 'capture.canister={radius="0.1 m", depth="0.15 m"}', "capture.folding.pattern=star"
ROLLED = 'capture.canister={radius="0.1 m", depth="0.15 m"}', "capture.folding.pattern=rolled"
BENDING, WALL, TOUCHING = (
    *("capture.bending.rigidity=1e-6 N.m2", "capture.wall.friction=0.2", "capture.self_contact.thickness=1 cm"),
)
AIR, HILL, SPIN = "capture.air.drag=quadratic", "capture.gravity.law=hill", "capture.spin.rate=5 deg/s"
FOLLOWING, SINGLE = "capture.solver.substeps=following", "capture.solver.precision=single"
SHOTS: dict[str, tuple[str, ...]] = {
    "hexagon": (HEXAGON, 'capture.ejection.delay=["0 s", "1 ms", "0 s", "2 ms", "0 s", "0 s"]', EDGE, KNOTS, HILL,
                CYLINDER, PENALTY, "capture.force_map={}", SPRINGS, 'capture.jam={reel=2, time="2.5 s"}', SLACK,
                "capture.volume={}", QUALITY, PULL, *EVERY, TOUCHING),
    "radial": (RADIAL, SINGLE, FOLLOWING, LEADS, AIR, DRAGGING, SPHERE, INELASTIC, BENDING,
               'capture.settling={by="speed", time="1 s"}', "capture.nodes={}", "capture.threads={}"),
    "cone": ('capture.net={shape="cone", radius="3 m", depth="2 m", top_radius="1 m", mesh="0.5 m", floor="none"}',
             *ACCORDION, WALL, SQUARE_BOX, INELASTIC, "capture.force_map={}", WINCHES, DRAGGING, PULL, SINGLE),
    "table": ('capture.net={shape="table", node_file="nodes.csv", thread_file="threads.csv"}', KNOTS, EDGE, SPHERE,
              PENALTY, 'capture.ejection.delay=["0 s", "1 ms", "0 s", "2 ms", "0 s", "0 s", "1 ms", "0 s"]', SPRINGS,
              *EVERY, TOUCHING),
    "rectangle": ('capture.net={shape="rectangle", width="6 m", height="4 m", mesh="0.5 m"}', SINGLE, FOLLOWING,
                  CYLINDER, INELASTIC, HILL, QUALITY),
    "pieces": ("capture.net.segments=2", SINGLE, SQUARE_BOX, INELASTIC, QUALITY, *STAR, WALL, WINCHES, BENDING, EDGE,
               AIR, PULL, *EVERY),
    "rolled": ("capture.net.segments=2", FRUSTUM, PENALTY, QUALITY, *ROLLED, WALL, SPRINGS, BENDING, EDGE, TOUCHING,
               PULL),
    "led": (*STAR, WALL, LEADS, EDGE, TOUCHING, AIR, HILL, SLACK, EJECTED),
    "breaks": ("capture.break.strength=60 N", FOLLOWING, FRUSTUM, PENALTY, "capture.force_map={}", WINCHES,
               'capture.tether={state="slack", length="7 m"}', *EVERY, "capture.volume={}", QUALITY),
    "breaks, falling": ("capture.break.strength=60 N", SINGLE, EJECTED, CYLINDER, INELASTIC, SPRINGS, FALLING),
    "mesh": (SPIN, MESH, INELASTIC, FALLING, SPRINGS, TOUCHING, QUALITY_TOLD, "capture.volume={}"),
    "hinged": (HINGED, HINGE, PENALTY, FOLLOWING, HILL, "capture.gravity_gradient={}", WINCHES, SLACK, QUALITY_TOLD,
               "capture.volume={}", *EVERY),
    "hinged, held": (HINGED, HINGE, INELASTIC, SPRINGS, DRAGGING, PULL, SINGLE, "capture.nodes={}"),
    "wrap": (UNION, INELASTIC, RUBBING, WINCHES, KNOTS, SLACK, PULL),
    "wrap, following": (UNION, PENALTY, "capture.wrap={}", EDGE, FOLLOWING, "capture.force_map={}", SPRINGS,
                        QUALITY_TOLD),
    "wrap, rubbing": (CYLINDER, PENALTY, RUBBING, WINCHES, EDGE, FOLLOWING, AIR, HILL),
    "wrap, led": (FRUSTUM, INELASTIC, "capture.wrap={}", *STAR, WALL, LEADS, QUALITY),
    "rk4": ("capture.solver.scheme=rk4", EDGE, AIR, SLACK, HILL, SQUARE_BOX, SPIN, "capture.nodes={}", BENDING, SINGLE,
            QUALITY),
    "rk4, following": ("capture.solver.scheme=rk4", FOLLOWING, LEADS, SQUARE_BOX, QUALITY, BENDING),
    "ros2": ("capture.solver.scheme=ros2", SINGLE, LEADS, EDGE, 'capture.gravity={law="uniform", on_chaser=true}', AIR,
             SQUARE_BOX, QUALITY, SPIN, SLACK, "capture.threads={}"),
    "xpbd": ("capture.solver.scheme=xpbd", SINGLE, LEADS, EDGE, HILL, AIR, SQUARE_BOX, QUALITY, SPIN, SLACK,
             "capture.nodes={}", "capture.threads={}"),
    "sliding": (HEXAGON, SINGLE, "capture.table.coefficient=0.2", "capture.bullets.angle=90 deg", SPRINGS, EDGE),
}  # fmt: skip
"""Of the bare shot."""

BODY = (
    'mass="1000 kg", inertia=["6666.7 kg m2", "2666.7 kg m2", "6666.7 kg m2", "0 kg m2", "0 kg m2", "0 kg m2"], '
    'start_rate=["0 deg/s", "0 deg/s", "5 deg/s"]'
)
BOX = f'removal.target={{body="box", size=["4 m", "8 m", "4 m"], attachment=["0 m", "-4 m", "0 m"], {BODY}}}'
ROUND = (
    'removal.target={body="cylinder", cylinder_radius="1 m", cylinder_length="4 m", attachment=["0 m", "0 m", "2 m"], '
    f"{BODY}}}"
)
HULL = (
    'removal.target={body="hull", corner_x=["1 m", "-1 m", "1 m", "-1 m", "1 m", "-1 m"], '
    'corner_y=["-4 m", "-4 m", "4 m", "4 m", "0 m", "0 m"], corner_z=["1 m", "1 m", "-1 m", "-1 m", "2 m", "2 m"], '
    f'attachment=["0 m", "-4 m", "0 m"], {BODY}}}'
)
RIGID = f'removal.target={{body="rigid", attachment=["0 m", "-4 m", "0 m"], {BODY}}}'
CHASER = 'removal.chaser={body="rigid", mass="2000 kg", attachment=["0 m", "1 m", "0 m"]}'
ALONG, VELOCITY, ON_LINE = (f"removal.thrust.direction={way}" for way in ("along_track", "velocity", "tether"))
ELECTRIC, WHEELS, SERIES = "removal.engine.kind=electric", "removal.aocs={}", "removal.net.compliance=1 mm/N"
LOCKED, LATE = "removal.reel.law=locked", 'removal.release={when="time", at="6000 s"}'
PERTURBED = (
    "removal.oblateness={}",
    "removal.air={}",
    "removal.third_bodies={}",
    "removal.shadow={}",
    "removal.sunlight={}",
)
TOWS: dict[str, tuple[str, ...]] = {
    "hull": ("removal.reel.law=constant_tension", VELOCITY, "removal.burn.when=arcs", ELECTRIC, "removal.plume={}",
             HULL, "removal.oblateness.zonal=J4", "removal.air.law=nrlmsis", "orbit.altitude=400 km", CHASER, WHEELS,
             "removal.third_bodies.which=sun", "removal.shadow.shape=cylinder", "removal.sunlight={}",
             "removal.power={}", "removal.ends={}", "removal.break.strength=500 N", LATE),
    "round": ('removal.reel={law="brake", brake_force="0.01 N"}', ON_LINE, ROUND, CHASER,
              "removal.third_bodies.which=moon", 'removal.release={when="altitude", altitude="799.9 km"}'),
    "field": (LOCKED, "removal.electrodynamic.field=igrf", "removal.oblateness={}", "removal.air={}", SERIES),
    "schedule": ('removal.reel={law="schedule", schedule_time=["0 s", "900 s"], schedule_length=["12 m", "11 m"]}',
                 ALONG, BOX),
    "linear": ("removal.reel.law=linear", ALONG),
    "regulator": ("removal.reel.law=regulator", ALONG),
    "sampled": ("removal.reel.law=sampled_linear", ALONG, BOX, CHASER),
    "gauss": (LOCKED, ALONG, "removal.solver.scheme=gauss", "removal.duration=4 min", CHASER, WHEELS, HULL,
              ELECTRIC, SERIES),
    "radau": (LOCKED, ALONG, "removal.solver.scheme=radau", "removal.duration=4 min", CHASER, WHEELS, ROUND,
              ELECTRIC, SERIES),
    "nodes": (LOCKED, ALONG, 'removal.lumped={nodes=32, damped_as="node"}', "removal.duration=20 s", RIGID, CHASER,
              'removal.tether={rest_length="1 km", diameter="1 mm"}', "removal.start.separation=999 m",
              WHEELS, "removal.break.strength=0.3 N", "removal.oblateness.zonal=J4", "removal.air={}"),
    "event map": (LOCKED, ALONG, "removal.level.detail=event_map", "removal.duration=12 h", ELECTRIC, *PERTURBED,
                  SERIES, "removal.plume={}"),
    "averaged": (LOCKED, ALONG, "removal.level.detail=averaged", "removal.duration=300 d", ELECTRIC),
    "settled hull": (LOCKED, ALONG, "removal.level.detail=settled", HULL, CHASER, WHEELS, ELECTRIC, "removal.power={}",
                     "removal.shadow={}", "removal.oblateness={}"),
    "settled round": (LOCKED, ALONG, "removal.level.detail=settled", ROUND, "removal.break.strength=5 N", LATE, SERIES),
}  # fmt: skip
"""Of the bare tow."""
COMPOSITIONS = {
    **{f"shot: {name}": ("shot.toml", "capture", *settings) for name, settings in SHOTS.items()},
    **{f"tow: {name}": ("tow.toml", "removal", *settings) for name, settings in TOWS.items()},
}
"""Scene, phase and settings, by name."""
