#!/usr/bin/python3
"""Problem 1 of Land et al. 2015 (doi:10.1098/rspa.2015.0641): beam 10 x 1 x 1 mm, x = 0 held, pressure 4 Pa on z = 0 that
follows the deformed normal, incompressible, Psi = C/2 (exp Q - 1), fibres along x. Prints the deformed place of
(10, 0.5, 1). Units: mm, kPa. The follower pressure makes the tangent unsymmetric: LU.

    python3 land_beam.py [--cells 20x4x4] [--increments 20] [--csv out.csv]

Cells are those of the whole beam; half of it, y in [0, 0.5], is computed with u_y = 0 on y = 0.5 (the problem is
symmetric). Cells may be graded towards the clamp: --grade r makes the last cell about r times as long as the first.
"""
import argparse
import csv

import numpy as np
import ufl
from taylor_hood import Problem, block, cpu_s, fem, mesh, peak_mb

C, BF, BT, BFS, PRESSURE = 2.0, 8.0, 2.0, 4.0, 0.004


def solve(cells, increments, grade):
    nx, ny, nz = cells
    assert ny % 2 == 0
    domain = block((10.0, 0.5, 1.0), (nx, ny // 2, nz))
    if grade != 1:
        s = domain.geometry.x[:, 0] / 10
        rate = np.log(grade)
        domain.geometry.x[:, 0] = 10 * np.expm1(rate * s) / np.expm1(rate)
    bottom = mesh.locate_entities_boundary(domain, 2, lambda x: np.isclose(x[2], 0))
    tags = mesh.meshtags(domain, 2, np.sort(bottom), np.ones(len(bottom), dtype=np.int32))
    pressure = fem.Constant(domain, 0.0)
    normal = ufl.FacetNormal(domain)

    def residual(u, p, v, q, dx, ds):
        F = ufl.variable(ufl.Identity(3) + ufl.grad(u))
        J = ufl.det(F)
        E = (F.T * F - ufl.Identity(3)) / 2
        Q = BF * E[0, 0]**2 + BT * (E[1, 1]**2 + E[2, 2]**2 + E[1, 2]**2 + E[2, 1]**2) + BFS * (
            E[0, 1]**2 + E[1, 0]**2 + E[0, 2]**2 + E[2, 0]**2)
        P = ufl.diff(C / 2 * (ufl.exp(Q) - 1) + p * (J - 1), F)
        follower = pressure * ufl.inner(J * ufl.inv(F).T * normal, v) * ds(1)
        return ufl.inner(P, ufl.grad(v)) * dx + q * (J - 1) * dx + follower

    problem = Problem(domain, residual, facet_tags=tags, symmetric=False)
    for i in range(3):
        problem.fix(lambda x: np.isclose(x[0], 0), i, problem.constant())
    problem.fix(lambda x: np.isclose(x[1], 0.5), 1, problem.constant())
    for k in range(1, increments + 1):
        pressure.value = PRESSURE * k / increments
        problem.step()
    place = np.array((10, 0.5, 1.0))
    return place + problem.displacement_at(place), problem


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cells", default="20x4x4")
    parser.add_argument("--increments", type=int, default=20)
    parser.add_argument("--grade", type=float, default=1.0)
    parser.add_argument("--csv")
    args = parser.parse_args()
    start = cpu_s()
    place, problem = solve(tuple(map(int, args.cells.split("x"))), args.increments, args.grade)
    row = (args.cells, args.grade, problem.unknowns, *(f"{x:.7f}" for x in place), f"{problem.volume_ratio() - 1:.1e}",
           problem.iterations, f"{cpu_s() - start:.1f}", f"{peak_mb():.0f}")
    print(*row)
    if args.csv:
        with open(args.csv, "a", newline="") as file:
            out = csv.writer(file, lineterminator="\n")
            if file.tell() == 0:
                out.writerow(("cells", "grade", "unknowns", "x_mm", "y_mm", "z_mm", "volume_change",
                              "newton_iterations", "cpu_s", "peak_mb"))
            out.writerow(row)


if __name__ == "__main__":
    main()
