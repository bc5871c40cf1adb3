#!/usr/bin/env python3
"""Muscle-tendon lengths of the shipped elbow scenes, computed from the public OpenSim model arm26.

elbow_geometry.py ARM26.osim                        table of the fits, of the fibre lengths and of the published arms
elbow_geometry.py ARM26.osim --check SCENE...       compares the geometry of scenes; status 1 if it differs
elbow_geometry.py ARM26.osim --write SCENE...       replaces those blocks
elbow_geometry.py ARM26.osim --validate FOLDER      compares with OpenSim's own results (the OutputReference folder);
                                                    status 1 beyond 0.1 mm or 0.01 N m

| symbol | unit | meaning                                                                          |
|--------|------|----------------------------------------------------------------------------------|
| q      | rad  | elbow flexion, 0 = straight                                                      |
| L(q)   | m    | muscle-tendon length, shoulder at 0                                              |
| r(q)   | m    | moment arm, -dL/dq, positive for a flexor                                        |
| R      | m    | radius of a wrapping cylinder                                                    |

Paths. arm26 (Holzbaur, Murray & Delp 2005, doi:10.1007/s10439-005-3320-7; OpenSim, CC BY 3.0) gives points, joint
axis and wrapping surfaces; they are read from the file, none is kept here. A cylinder is a developable surface, so
the shortest path over it is a straight line once tangent, arc and tangent are unrolled:
L = sqrt((s_a + R phi + s_b)^2 + (z_b - z_a)^2). The muscle stays on one side of the bone: triceps behind, brachialis
in front. The surfaces at the shoulder (ellipsoids of the humeral head, the glenoid cylinder) do not move when only the
elbow does: they add a constant, found as the shortest chain of points that stays outside them.

Brachioradialis is not in arm26. Two levers and a pulley stand for it, in the plane of the hinge: an origin a from the
axis on the humerus, an insertion b from the axis on the radius, and a cylinder of radius p about the axis itself:
r(q) = max(p, a b sin q / sqrt(a^2 + b^2 + 2 a b cos q)). Its largest value is a, at cos q = -a / b.

Fit. A polynomial of degree 5 in q, by least squares in length and moment arm together, over -10 to 165 deg. arm26 is
meant for 0 to 130 deg: outside, the computed arm counts a tenth and is kept above `least_arm_m` in size, since
straight lines through a fully bent elbow would cut through the muscles that lie there; an end of the range where the
polynomial is still below `least_end_m` is pinned to it.
"""
import argparse
import functools
import re
import sys
import xml.etree.ElementTree as ElementTree
from decimal import Decimal
from pathlib import Path

import numpy as np
from scipy import optimize

muscles = ["TRIlong", "TRIlat", "TRImed", "BIClong", "BICshort", "BRA", "BRD"]
side = {"TRIlong": "back", "TRIlat": "back", "TRImed": "back", "BRA": "front"}  # of the elbow's cylinder
degree = np.pi / 180
scene_range = (-10 * degree, 165 * degree)
model_range = (0.0, 130 * degree)
outside_weight = 0.1
least_arm_m = 0.008
least_end_m = 0.006
arm_weight_rad = 0.5  # an error of the arm of 1 mm counts as much as one of the length of 0.5 mm

# Brachioradialis, forearm neutral.
brd_origin_m = 0.077     # largest moment arm, mean of 10 arms: Murray et al. 2000, doi:10.1016/S0021-9290(00)00051-8
brd_insertion_m = 0.24   # base of the radial styloid, 10 mm short of the scenes' forearm
brd_pulley_m = 0.020     # moment arm of the straight elbow: the regressions below
brd_optimal_deg = 80.0   # where fibres are at their optimum: moment arms leave the constant of the length free

# Parameters of the scenes (arm26; brachioradialis: Holzbaur et al. 2005), for the fibre lengths of a rigid tendon.
parameters = {  # optimal fibre length m, tendon slack length m, pennation at optimum deg, force N
    "TRIlong": (0.1340, 0.1430, 12, 798.52), "TRIlat": (0.1138, 0.0980, 9, 624.3), "TRImed": (0.1138, 0.0908, 9, 624.3),
    "BIClong": (0.1157, 0.2723, 0, 624.3), "BICshort": (0.1321, 0.1923, 0, 435.56), "BRA": (0.0858, 0.0535, 0, 987.26),
    "BRD": (0.1726, 0.1330, 0, 261.33)}

# Moment arms (mm) to compare with, at 10, 45, 90, 120 deg: regressions listed by the Institute of Biophysics and
# Biomedical Engineering, Sofia (biomed.bas.bg, MuscleArms.html). The brachioradialis starts there at 20.15 mm.
# Largest ones by Murray et al. 2000: long head of biceps 47, of triceps 23, brachioradialis 77 mm.
shown_deg = (10, 45, 90, 120)
listed_mm = {"TRI": (-24.9, -23.9, -19.2, -16.9), "BIC": (18.1, 26.8, 47.1, 45.9), "BRA": (15.3, 16.8, 27.8, 29.6),
             "BRD": (20.2, 30.7, 54.4, 68.4)}


def numbers(text):
    return np.array([float(x) for x in text.split()])


def rotation_about(axis, angle):
    x, y, z = axis / np.linalg.norm(axis)
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k


def body_fixed_xyz(angles):
    return (rotation_about(np.array([1.0, 0, 0]), angles[0]) @ rotation_about(np.array([0, 1.0, 0]), angles[1])
            @ rotation_about(np.array([0, 0, 1.0]), angles[2]))


class Arm:
    """arm26 with the shoulder at 0: everything in the humerus' frame, the forearm turned by q about the hinge."""

    def __init__(self, osim):
        root = ElementTree.parse(osim).getroot()
        self.joints = {j.get("name"): j for j in root.iter("CustomJoint")}
        self.shoulder = self.joint_centre("r_shoulder")
        self.hinge = self.joint_centre("r_elbow")
        self.axis = numbers(self.joints["r_elbow"].find(".//TransformAxis[@name='rotation1']/axis").text)
        self.axis /= np.linalg.norm(self.axis)
        self.surfaces, self.points = {}, {}
        for body in root.iter("Body"):
            for tag in ("WrapCylinder", "WrapEllipsoid"):
                for s in body.iter(tag):
                    self.surfaces[s.get("name")] = self.surface(body.get("name"), s, tag)
        for muscle in root.iter("Thelen2003Muscle"):
            self.points[muscle.get("name")] = [
                (p.find("socket_parent_frame").text.split("/")[-1], numbers(p.find("location").text))
                for p in muscle.iter("PathPoint")]

    def joint_centre(self, name):
        """The joint's frame in the parent body: the first of its two offset frames. Neither may be turned."""
        frames = list(self.joints[name].iter("PhysicalOffsetFrame"))
        if any(np.any(numbers(f.find("orientation").text)) for f in frames) or np.any(
                numbers(frames[1].find("translation").text)):
            raise SystemExit(f"{name}: turned or shifted child frames are not provided for")
        return numbers(frames[0].find("translation").text)

    def surface(self, body, s, tag):
        centre = numbers(s.find("translation").text) - (self.shoulder if body == "base" else 0.0)
        turn = body_fixed_xyz(numbers(s.find("xyz_body_rotation").text))
        if tag == "WrapCylinder":
            return {"centre": centre, "turn": turn, "radius": float(s.find("radius").text)}
        return {"centre": centre, "turn": turn, "axes": numbers(s.find("dimensions").text)}

    def place(self, point, q):
        body, x = point
        if body == "base":
            return x - self.shoulder
        if body == "r_humerus":
            return x
        return self.hinge + rotation_about(self.axis, q) @ x


def over_cylinder(a, b, cylinder, turning):
    """Shortest length from a to b past an endless cylinder, the unit vector along it at b and the arc of contact.

    turning = +1 or -1: sense in which the path goes round the cylinder's own z axis. Straight where it touches nothing.
    """
    a_local = cylinder["turn"].T @ (a - cylinder["centre"])
    b_local = cylinder["turn"].T @ (b - cylinder["centre"])
    radius = cylinder["radius"]
    da, db = np.hypot(*a_local[:2]), np.hypot(*b_local[:2])
    angle = (turning * (np.arctan2(b_local[1], b_local[0]) - np.arctan2(a_local[1], a_local[0]))) % (2 * np.pi)
    arc = angle - np.arccos(radius / da) - np.arccos(radius / db)
    if arc <= 0 or angle > 1.5 * np.pi:  # clear of the cylinder, or b lies before a in this sense
        d = b - a
        return np.linalg.norm(d), d / np.linalg.norm(d), 0.0
    sb = np.sqrt(db**2 - radius**2)
    planar = np.sqrt(da**2 - radius**2) + radius * arc + sb
    rise = b_local[2] - a_local[2]
    length = np.hypot(planar, rise)
    tangent_angle = np.arctan2(b_local[1], b_local[0]) - turning * np.arccos(radius / db)
    tangent = np.append(radius * np.array([np.cos(tangent_angle), np.sin(tangent_angle)]), 0.0)
    along = np.append(b_local[:2] - tangent[:2], 0.0) / sb * planar / length
    along[2] = rise / length
    return length, cylinder["turn"] @ along, arc


def shortest_outside(a, b, ellipsoid, past):
    """Length of the shortest chain of points from a to b outside an ellipsoid; `past`: a point on the wanted side.

    The points lie in planes spaced evenly along the straight line, so that none of them can slip past the surface.
    """
    count = 60
    t = np.linspace(0, 1, count + 2)[1:-1]
    straight = a + t[:, None] * (b - a)
    across = np.linalg.svd((b - a)[None, :])[2][1:]  # two directions normal to the line
    start = 4 * t[:, None] * (1 - t[:, None]) * (across @ (past - (a + b) / 2))

    def points(x):
        return straight + x.reshape(-1, 2) @ across

    def length(x):
        d = np.diff(np.vstack([a, points(x), b]), axis=0)
        n = np.linalg.norm(d, axis=1)
        u = d / n[:, None]
        return n.sum(), ((u[:-1] - u[1:]) @ across.T).ravel()

    def outside(x):
        return np.sum(((points(x) - ellipsoid["centre"]) @ ellipsoid["turn"] / ellipsoid["axes"])**2, axis=1) - 1

    def outside_slope(x):
        local = (points(x) - ellipsoid["centre"]) @ ellipsoid["turn"] / ellipsoid["axes"]
        gradient = 2 * (local / ellipsoid["axes"]) @ ellipsoid["turn"].T @ across.T
        slope = np.zeros((count, count, 2))
        slope[np.arange(count), np.arange(count)] = gradient
        return slope.reshape(count, -1)

    found = optimize.minimize(length, start.ravel(), jac=True, method="SLSQP", options={"maxiter": 500, "ftol": 1e-9},
                              constraints={"type": "ineq", "fun": outside, "jac": outside_slope})
    if not found.success or outside(found.x).min() < -1e-6:
        raise SystemExit(f"no shortest path at the shoulder: {found.message}")
    return found.fun


@functools.lru_cache(maxsize=None)
def shoulder_excess(arm, muscle):
    """What the surfaces at the shoulder add to the straight lines there, m: constant while only the elbow moves.

    With the shoulder at 0 the long head of the triceps runs clear of the humeral head and of the glenoid's edge.
    """
    if muscle != "BIClong":
        return 0.0
    a, b = (arm.place(arm.points[muscle][i], 0.0) for i in (1, 2))
    head = arm.surfaces["BIClonghh"]
    past = head["centre"] - head["turn"][:, 1] * head["axes"][1]  # quadrant -y
    return shortest_outside(a, b, head, past) - np.linalg.norm(b - a)


def path(arm, muscle, q):
    """Length, moment arm and contact (arc of the elbow's cylinder, rad) without what the shoulder adds."""
    points = [arm.place(p, q) for p in arm.points[muscle]]
    length = sum(np.linalg.norm(b - a) for a, b in zip(points[:-2], points[1:-1]))
    a, b = points[-2], points[-1]
    if muscle in side:
        cylinder = arm.surfaces["TRI"]
        turning = np.sign(cylinder["turn"][2, 2]) * (1 if side[muscle] == "back" else -1)
        last, along, contact = over_cylinder(a, b, cylinder, turning)
    else:
        last, contact = np.linalg.norm(b - a), 0.0
        along = (b - a) / last
    arm_m = -along @ np.cross(arm.axis, b - arm.hinge)  # -dL/dq: the last point turns about the hinge
    return length + last, arm_m, contact


def brachioradialis(q):
    a, b, p = brd_origin_m, brd_insertion_m, brd_pulley_m

    def straight(x):
        return np.sqrt(a * a + b * b + 2 * a * b * np.cos(x))

    leaves = optimize.brentq(lambda x: a * b * np.sin(x) / straight(x) - p, 0.0, 90 * degree)

    def length(x):
        return straight(x) if x > leaves else straight(leaves) + p * (leaves - x)

    l_opt, l_slack = parameters["BRD"][:2]
    shift = l_opt + l_slack - length(brd_optimal_deg * degree)
    return length(q) + shift, a * b * np.sin(q) / straight(q) if q > leaves else p, float(max(0.0, leaves - q))


def computed(arm, muscle, q):
    """Lengths and moment arms at the angles q."""
    if muscle == "BRD":
        rows = [brachioradialis(x) for x in q]
    else:
        excess = shoulder_excess(arm, muscle)
        rows = [(l + excess, r, c) for l, r, c in (path(arm, muscle, x) for x in q)]
    return (np.array(column) for column in zip(*rows))


def fit(muscle, q, length, arm_m):
    """Coefficients of L(q), constant first, rounded to 6 significant digits."""
    sign = -1.0 if muscle.startswith("TRI") else 1.0
    inside = (q >= model_range[0]) & (q <= model_range[1])
    target = np.where(inside, arm_m, sign * np.maximum(sign * arm_m, least_arm_m))
    # Where the arm is replaced, the length that belongs to it: integrated from the model's range outwards.
    steps = -0.5 * (target[1:] + target[:-1]) * np.diff(q)
    own = np.concatenate([[0.0], np.cumsum(steps)])
    first, last = np.flatnonzero(inside)[[0, -1]]
    wanted = length.copy()
    wanted[:first] = length[first] + own[:first] - own[first]
    wanted[last + 1:] = length[last] + own[last + 1:] - own[last]
    weight = np.where(inside, 1.0, outside_weight)
    powers = np.arange(6)
    basis = q[:, None] ** powers
    slope = np.hstack([np.zeros((len(q), 1)), -powers[1:] * q[:, None] ** (powers[1:] - 1)])
    rows = np.vstack([basis * weight[:, None], arm_weight_rad * slope * weight[:, None]])
    right = np.concatenate([wanted * weight, arm_weight_rad * target * weight])
    c = np.linalg.lstsq(rows, right, rcond=None)[0]
    short = [k for k in (0, -1) if sign * slope[k] @ c < least_end_m]
    if short:  # an end where the fit still falls short is pinned
        rows = np.vstack([rows, 1e4 * slope[short]])
        right = np.concatenate([right, np.full(len(short), 1e4 * sign * least_end_m)])
        c = np.linalg.lstsq(rows, right, rcond=None)[0]
    if not np.all(sign * slope @ c > 0.9 * least_end_m):
        raise SystemExit(f"{muscle}: moment arm of {1e3 * np.min(sign * slope @ c):.1f} mm inside the range")
    return [Decimal(f"{x:.6g}") for x in c]


def arm_coefficients(length_coefficients):
    return [-k * c for k, c in enumerate(length_coefficients)][1:]


def values(coefficients, q):
    return np.polynomial.polynomial.polyval(q, [float(c) for c in coefficients])


def geometry_block(coefficients):
    def row(cs):
        return "[" + ", ".join(f"{float(c):.10g}" for c in cs) + "]"

    return (f"[muscle.geometry]\nlength_polynomial_m = {row(coefficients)}\n"
            f"moment_arm_polynomial_m = {row(arm_coefficients(coefficients))}\n")


block = re.compile(r'(\[\[muscle\]\]\nname = "(\w+)".*?)\[muscle\.geometry\]\n'
                   r"length_polynomial_m = \[(.*?)\]\nmoment_arm_polynomial_m = \[(.*?)\]\n", re.S)


def write(scene, fits):
    text = Path(scene).read_text()
    Path(scene).write_text(block.sub(lambda m: m[1] + geometry_block(fits[m[2]]), text))


def check(scene, fits):
    """Largest difference (m) of length or moment arm between a scene's polynomials and the fits, over the range."""
    q = np.linspace(*scene_range, 200)
    found = {m[2]: [[float(x) for x in m[k].split(",")] for k in (3, 4)]
             for m in block.finditer(Path(scene).read_text())}
    if sorted(found) != sorted(muscles):
        raise SystemExit(f"{scene}: geometry found for {sorted(found)}")
    worst = 0.0
    for muscle, (length, arm_m) in found.items():
        worst = max(worst, np.abs(values(length, q) - values(fits[muscle], q)).max(),
                    np.abs(values(arm_m, q) - values(arm_coefficients(fits[muscle]), q)).max())
    return worst


def fibre_length(muscle, length):
    l_opt, l_slack, pennation, _ = parameters[muscle]
    return np.hypot(length - l_slack, l_opt * np.sin(pennation * degree)) / l_opt


def report(arm, fits):
    q = np.linspace(*scene_range, 701)
    inside = (q >= model_range[0]) & (q <= model_range[1])
    print("fit over 0 to 130 deg, and over -10 to 165 deg; fibre length: rigid tendon, over 0 to 150 deg")
    print(f"{'':9}{'L rms':>7}{'max':>6}{'r rms':>7}{'max mm':>7}{'|r| least':>11}{'largest mm':>11}"
          f"{'fibre/l_opt':>14}  {'r at ' + ', '.join(map(str, shown_deg)) + ' deg: fit (path; listed) mm'}")
    for muscle in muscles:
        length, arm_m, _ = computed(arm, muscle, q)
        dl = 1e3 * (values(fits[muscle], q) - length)[inside]
        r = values(arm_coefficients(fits[muscle]), q)
        dr = 1e3 * (r - arm_m)[inside]
        ends = fibre_length(muscle, values(fits[muscle], np.linspace(0, 150 * degree, 301)))
        shown = []
        for angle, published in zip(shown_deg, listed_mm[muscle[:3]]):
            at = np.array([angle * degree])
            _, exact, _ = computed(arm, muscle, at)
            ours = values(arm_coefficients(fits[muscle]), at)
            shown.append(f"{1e3 * ours[0]:6.1f} ({1e3 * exact[0]:.1f}; {published:.1f})")
        print(f"{muscle:9}{np.sqrt((dl**2).mean()):7.2f}{np.abs(dl).max():6.2f}{np.sqrt((dr**2).mean()):7.2f}"
              f"{np.abs(dr).max():7.2f}{1e3 * np.abs(r).min():11.1f}{1e3 * np.abs(r).max():11.1f}"
              f"{ends.min():8.2f}-{ends.max():.2f}  {'  '.join(shown)}")
    print(f"added to BIClong by the humeral head: {1e3 * shoulder_excess(arm, 'BIClong'):.2f} mm")


def storage(file):
    text = Path(file).read_text().split("endheader")[1].strip().splitlines()
    return dict(zip(text[0].split(), np.array([[float(x) for x in line.split()] for line in text[1:]]).T))


def validate(arm, folder):
    """Against OpenSim's own results: lengths from fibre length, pennation and tendon force (computed muscle control),
    moment arms from the sum over muscles of force times arm (static optimisation), which is the elbow's moment."""
    results = Path(folder) / "ComputedMuscleControl" / "Results"
    states, forces = storage(results / "arm26_states.sto"), storage(results / "arm26_Actuation_force.sto")
    q = states["r_elbow_flex"]
    worst = 0.0
    print(f"OpenSim, {q.min() / degree:.0f} to {q.max() / degree:.0f} deg, length computed here minus there, mm:")
    for muscle in muscles[:-1]:
        l_opt, l_slack, pennation, strength = parameters[muscle]
        fibre = states[muscle + ".fiber_length"]
        force = np.interp(states["time"], forces["time"], forces[muscle]) / strength
        # Tendon of Thelen 2003 (doi:10.1115/1.1531112) with the model's strain of 0.033: exponential toe, then a line.
        strain = np.where(force < 0.33, 0.609 * 0.033 / 3 * np.log1p(force / 0.33 * np.expm1(3.0)),
                          0.609 * 0.033 + (force - 0.33) * 0.033 / 1.712)
        across = l_opt * np.sin(pennation * degree)
        theirs = np.sqrt(fibre**2 - across**2) + l_slack * (1 + strain)
        ours, _, _ = computed(arm, muscle, q)
        d = 1e3 * (ours - theirs)
        worst = max(worst, np.abs(d).max() / 0.1)
        print(f"  {muscle:9} mean {d.mean():6.2f}  sd {d.std():5.2f}  range {d.min():6.2f} to {d.max():6.2f}")
    static = storage(Path(folder) / "StaticOptimization/PhysiologicalResults/arm26_StaticOptimization_force.sto")
    moment = storage(Path(folder) / "InverseDynamics/FilteredResults/arm26_InverseDynamics.sto")["r_elbow_flex_moment"]
    angle = storage(Path(folder) / "InverseKinematics/arm26_InverseKinematics.mot")["r_elbow_flex"] * degree
    total = np.zeros_like(moment)
    for muscle in muscles[:-1]:
        _, arm_m, _ = computed(arm, muscle, angle)
        total += arm_m * static[muscle]
    d = (total - moment)[3:-3]
    print(f"  elbow moment: sum of force x arm minus inverse dynamics, N m: rms {np.sqrt((d**2).mean()):.4f}, "
          f"largest {np.abs(d).max():.4f}, of at most {np.abs(moment).max():.2f}")
    return int(not max(worst, np.abs(d).max() / 0.01) < 1)


def main():
    options = argparse.ArgumentParser()
    options.add_argument("osim")
    options.add_argument("--check", nargs="+", default=[])
    options.add_argument("--write", nargs="+", default=[])
    options.add_argument("--validate")
    given = options.parse_args()
    arm = Arm(given.osim)
    if given.validate:
        return validate(arm, given.validate)
    q = np.linspace(*scene_range, 351)
    fits = {}
    for muscle in muscles:
        length, arm_m, _ = computed(arm, muscle, q)
        fits[muscle] = fit(muscle, q, length, arm_m)
    for scene in given.write:
        write(scene, fits)
    worst = [check(scene, fits) for scene in given.check]
    for scene, w in zip(given.check, worst):
        print(f"{Path(scene).name}: differs by at most {1e3 * w:.6f} mm")
    if not given.check and not given.write:
        report(arm, fits)
    return int(any(not w < 1e-5 for w in worst))


if __name__ == "__main__":
    sys.exit(main())
