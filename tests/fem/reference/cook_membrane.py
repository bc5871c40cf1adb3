#!/usr/bin/python3
"""Cook's membrane, plane strain (two-dimensional elements, F_zz = 1), corners (0,0), (48,44), (48,60), (0,44) mm, left edge
held, vertical dead load 100 N per mm of thickness (6.25 N/mm2) on the right edge. Energy G/2 (J^(-2/3) tr F F' - 3) +
K/2 (J - 1)^2, mixed form, Q2/Q1. Prints the displacement of the corner (48, 60).

    python3 cook_membrane.py [--cells 8 16 32 64] [--bulk 40.0942e4] [--csv out.csv]
"""
import argparse
import csv

import numpy as np
import ufl
from taylor_hood import MPI, Problem, cpu_s, fem, mesh

SHEAR, TOTAL_LOAD = 80.1938, 100.0


def solve(cells, bulk, increments=4):
    domain = mesh.create_rectangle(MPI.COMM_SELF, [[0.0, 0.0], [1.0, 1.0]], [cells, cells],
                                   cell_type=mesh.CellType.quadrilateral)
    x = domain.geometry.x
    s, t = x[:, 0].copy(), x[:, 1].copy()
    x[:, 0], x[:, 1] = 48 * s, 44 * s * (1 - t) + (44 + 16 * s) * t
    right = mesh.locate_entities_boundary(domain, 1, lambda x: np.isclose(x[0], 48))
    tags = mesh.meshtags(domain, 1, np.sort(right), np.ones(len(right), dtype=np.int32))
    load = fem.Constant(domain, 0.0)

    def residual(u, p, v, q, dx, ds):
        F = ufl.variable(ufl.Identity(2) + ufl.grad(u))
        J = ufl.det(F)
        P = ufl.diff(SHEAR / 2 * (J ** (-2 / 3) * (ufl.tr(F.T * F) + 1) - 3), F) + p * J * ufl.inv(F).T
        return (ufl.inner(P, ufl.grad(v)) + q * (J - 1 - p / bulk)) * dx - load * v[1] * ds(1)

    problem = Problem(domain, residual, facet_tags=tags)
    for i in range(2):
        problem.fix(lambda x: np.isclose(x[0], 0), i, problem.constant())
    for k in range(1, increments + 1):
        load.value = TOTAL_LOAD / 16 * k / increments
        problem.step()
    return problem.displacement_at((48, 60, 0)), problem.negative_modes(), problem.unknowns


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cells", type=int, nargs="+", default=[8, 16, 32, 64])
    parser.add_argument("--bulk", type=float, default=40.0942e4)
    parser.add_argument("--csv")
    args = parser.parse_args()
    rows = []
    for n in args.cells:
        start = cpu_s()
        u, modes, unknowns = solve(n, args.bulk)
        rows.append((n, unknowns, args.bulk, f"{u[0]:.7f}", f"{u[1]:.7f}", modes, f"{cpu_s() - start:.1f}"))
        print(*rows[-1], flush=True)
    if args.csv:
        with open(args.csv, "a", newline="") as file:
            out = csv.writer(file, lineterminator="\n")
            if file.tell() == 0:
                out.writerow(("cells_per_side", "unknowns", "bulk_mpa", "corner_u_x_mm", "corner_u_y_mm",
                              "negative_modes", "cpu_s"))
            out.writerows(rows)


if __name__ == "__main__":
    main()
