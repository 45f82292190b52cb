"""A target with a hinged appendage for tests, and the same as two bodies with coordinates of their own."""

import numpy as np
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from fmu_src.net_capture.appendage import laying
from fmu_src.net_capture.shapes import pieces, solids, union
from orbital.kernel import kernel

TERMS = {"net": "square", "gravity": "none", "target": "union", "hinge": "plain"}
TURN = Rotation.from_rotvec([0.2, -0.3, 0.5])
WING = [
    {"shape": pieces.BOX, "size": [1.6, 1.8, 2.0], "mass": 300.0},
    {"shape": pieces.BOX, "size": [0.4, 0.4, 0.9], "mass": 40.0, "position": [0.7, 0.6, -0.9]},
    {"shape": pieces.BOX, "size": [1.5, 0.06, 1.8], "mass": 60.0, "position": [0.2, 0.3, 2.0], "hinged": True,
     "attitude": TURN.as_quat(scalar_first=True).tolist()},
    {"shape": pieces.BOX, "size": [0.1, 0.1, 0.8], "mass": 9.0, "position": [0.1, 0.1, 1.2], "hinged": True},
]  # fmt: skip
"""A body askew in its axes, and a wing askew on it."""
POINT, AXIS = np.array([0.1, 0.05, 0.95]), np.array([0.9, 0.3, -0.2])
FLAT = [
    {"shape": pieces.BOX, "size": [1.0, 1.0, 2.0], "mass": 200.0},
    {"shape": pieces.BOX, "size": [1.5, 0.05, 2.0], "mass": 50.0, "position": [0.0, 0.0, 2.1], "hinged": True},
]
"""A wing straight on a body, that swings about its edge."""
EDGE = np.array([0.0, 0.0, 1.1])


def tables_of(entries=WING, point=POINT, axis=AXIS, limit=1.2):
    rows = np.array(pieces.gather(entries))
    values = {"hinge.stiffness": 0.0, "hinge.limit": limit}
    values |= {f"hinge.position[{i + 1}]": float(x) for i, x in enumerate(point)}
    values |= {f"hinge.axis[{i + 1}]": float(x) for i, x in enumerate(axis)}
    made = union.lay(values, {union.PARTS: rows})
    return {**made.tables, **laying.lay(values, {union.PARTS: rows}).tables}, made.parameters["target.mass"]


def body_turn(tables):
    solid = tables["target.solid"]
    return Rotation.from_quat(solid[solids.TURN : solids.CENTER], scalar_first=True), solid[solids.CENTER : solids.HALF]


class TwoBodies:
    """Both bodies of boxes, each with place, velocity, attitude and rate of its own, and five constraints.

    State of each: place (3), attitude as a quaternion, scalar last (4), velocity (3), rate in the frame (3).
    """

    def __init__(self, entries, point, axis, stiffness=0.0, damping=0.0):
        self.stiffness, self.damping = stiffness, damping
        self.masses, self.centres, self.moments = [], [], []
        for swings in (False, True):
            of = [e for e in entries if e.get("hinged", False) == swings]
            mass = sum(e["mass"] for e in of)
            centre = sum(e["mass"] * np.array(e.get("position", [0.0, 0.0, 0.0])) for e in of) / mass
            moments = np.zeros((3, 3))
            for e in of:
                turn = Rotation.from_quat(e.get("attitude", [1.0, 0.0, 0.0, 0.0]), scalar_first=True).as_matrix()
                a, b, c = np.square(e["size"])
                d = np.array(e.get("position", [0.0, 0.0, 0.0])) - centre
                moments += e["mass"] * (turn @ np.diag([b + c, a + c, a + b]) @ turn.T / 12.0)
                moments += e["mass"] * (d @ d * np.eye(3) - np.outer(d, d))
            self.masses.append(mass), self.centres.append(centre), self.moments.append(moments)
        self.axis = axis / np.linalg.norm(axis)
        self.arms = [point - centre for centre in self.centres]
        self.across = np.linalg.svd(self.axis[None, :])[2][1:]

    def start(self, attitude, rate, angle, speed):
        """At rest as a whole, its centre of mass in the origin; rate in the frame."""
        swung = Rotation.from_rotvec(angle * self.axis)
        hinge = self.centres[0] + self.arms[0]
        first, second = self.centres[0], hinge - swung.apply(self.arms[1])
        total = (self.masses[0] * first + self.masses[1] * second) / sum(self.masses)
        turns = (attitude, attitude * swung)
        rates = (rate, rate + speed * attitude.apply(self.axis))
        places = [attitude.apply(x - total) for x in (first, second)]
        at_hinge = attitude.apply(hinge - total)
        speeds = [np.zeros(3), np.cross(rates[0], at_hinge - places[0]) - np.cross(rates[1], at_hinge - places[1])]
        mean = self.masses[1] * speeds[1] / sum(self.masses)
        return np.concatenate([
            np.concatenate([places[k], turns[k].as_quat(), speeds[k] - mean, rates[k]]) for k in (0, 1)
        ])  # fmt: skip

    def parts(self, y):
        return [(y[k : k + 3], Rotation.from_quat(y[k + 3 : k + 7]), y[k + 7 : k + 10], y[k + 10 : k + 13])
                for k in (0, 13)]  # fmt: skip

    def angle(self, y):
        (_, one, _, _), (_, two, _, _) = self.parts(y)
        return float((one.inv() * two).as_rotvec() @ self.axis)

    def constraints(self, y):
        """Jacobian (5, 12) for velocities and rates of both, and what it leaves over of accelerations (5,)."""
        jacobian, left = np.zeros((5, 12)), np.zeros(5)
        parts = self.parts(y)
        for k, (_, turn, _, w) in enumerate(parts):
            sign, arm = 1.0 - 2.0 * k, turn.apply(self.arms[k])
            jacobian[:3, 6 * k : 6 * k + 3] = sign * np.eye(3)
            for i in range(3):
                jacobian[:3, 6 * k + 3 + i] = sign * np.cross(np.eye(3)[i], arm)
            left[:3] += sign * np.cross(w, np.cross(w, arm))
        one, relative = parts[0][1], parts[0][3] - parts[1][3]
        for i, own in enumerate(self.across):
            way = one.apply(own)
            jacobian[3 + i, 3:6], jacobian[3 + i, 9:12] = way, -way
            left[3 + i] = np.cross(parts[0][3], way) @ relative
        return jacobian, left

    def solve(self, y, forces, jacobian, left):
        masses = np.zeros((12, 12))
        for k, (_, turn, _, _) in enumerate(self.parts(y)):
            masses[6 * k : 6 * k + 3, 6 * k : 6 * k + 3] = self.masses[k] * np.eye(3)
            masses[6 * k + 3 : 6 * k + 6, 6 * k + 3 : 6 * k + 6] = (
                turn.as_matrix() @ self.moments[k] @ turn.as_matrix().T
            )
        whole = np.block([[masses, jacobian.T], [jacobian, np.zeros((5, 5))]])
        return np.linalg.solve(whole, np.concatenate([forces, -left]))[:12]

    def rates(self, _, y):
        forces, parts = np.zeros(12), self.parts(y)
        along = parts[0][1].apply(self.axis)
        torque = -self.stiffness * self.angle(y) - self.damping * (parts[1][3] - parts[0][3]) @ along
        out = np.zeros(26)
        for k, (_, turn, v, w) in enumerate(parts):
            moments = turn.as_matrix() @ self.moments[k] @ turn.as_matrix().T
            forces[6 * k + 3 : 6 * k + 6] = (2.0 * k - 1.0) * torque * along - np.cross(w, moments @ w)
            x, z = y[13 * k + 3 : 13 * k + 6], y[13 * k + 6]
            out[13 * k : 13 * k + 3] = v
            out[13 * k + 3 : 13 * k + 6] = 0.5 * (z * w + np.cross(w, x))
            out[13 * k + 6] = -0.5 * w @ x
        gained = self.solve(y, forces, *self.constraints(y))
        for k in (0, 1):
            out[13 * k + 7 : 13 * k + 13] = gained[6 * k : 6 * k + 6]
        return out

    def fly(self, y, time):
        return solve_ivp(self.rates, (0.0, time), y, method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1]


def moving(law, entries=WING, point=POINT, axis=AXIS, limit=1.2, rate=(0.0, 0.0, 0.0), **hinge):
    """Such a target; rate of the rest in design axes, start attitude 0.3 rad about an askew axis."""
    tables, mass = tables_of(entries, point, axis, limit)
    attitude = Rotation.from_rotvec([0.1, -0.2, 0.2])
    values = {
        "target_mass": mass,
        "target_start_rate": rate,
        "target_start_attitude": attitude.as_quat(scalar_first=True),
    }
    values |= {name if name.startswith("contact") else f"hinge_{name}": value for name, value in hinge.items()}
    return law.place(tables, **values), tables, attitude


def free_motion(law):
    """Kernels of such a target without contact: `tell(record)`, and `fly(record, frame_rate, step, steps)`."""
    target = law.bench.parts.target
    measure, drift = target.measure, target.drift

    @kernel
    def tell(record):
        measure(record[0])

    @kernel
    def fly(record, frame_rate, step, steps):
        for _ in range(steps):
            drift(record[0], frame_rate, step)

    return tell, fly


def design_attitude(scene, tables):
    return Rotation.from_quat(scene.p["target_pose"], scalar_first=True) * body_turn(tables)[0].inv()


def boxes(posed):
    """Place, turn and half size of each box of `WING` as it is posed [m], and whether it swings."""
    for entry, first in zip(posed, WING, strict=True):
        own = Rotation.from_quat(entry["attitude"], scalar_first=True)
        yield np.array(entry["position"]), own, 0.5 * np.array(entry["size"]), first.get("hinged", False)
