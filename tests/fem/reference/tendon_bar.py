#!/usr/bin/python3
"""Muscle-tendon-muscle bar, 30 x 6 x 6 mm, fibres along x, tendon in 10 <= x <= 20 (sharp interfaces between elements),
both ends held, right end moved by 1.5 mm (stretch 1.05 of the whole) in two steps, then alpha 0.3 and 0.6 in the muscle.
SPRENGER_MUSCLE and SPRENGER_TENDON. Prints the axial force (N) on the right end and the displacement u_x of the bar's axis
at both interfaces (mm).

    python3 tendon_bar.py [--cells 12x4x4] [--quarter] [--pressure Lagrange|DPC] [--csv out.csv]

--quarter keeps y, z in [0, 3] with symmetry planes; cells are those of the whole bar. The continuous pressure (Lagrange)
cannot follow its jump at the interfaces and converges to the same force from another side than the discontinuous
linear one (DPC).
"""
import argparse
import csv

import numpy as np
import ufl
from taylor_hood import (SPRENGER_MUSCLE, SPRENGER_TENDON, Problem, block, clamp_ends, cpu_s, fem, mesh, peak_mb,
                         tissue_stress)

LENGTH, WIDTH, PULL = 30.0, 6.0, 1.5
STATES = (0.0, 0.3, 0.6)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cells", default="12x4x4")
    parser.add_argument("--quarter", action="store_true")
    parser.add_argument("--pressure", default="Lagrange", choices=("Lagrange", "DPC"))
    parser.add_argument("--csv")
    args = parser.parse_args()
    nx, ny, nz = map(int, args.cells.split("x"))
    assert nx % 3 == 0
    start = cpu_s()
    share = 4 if args.quarter else 1
    if args.quarter:
        ny, nz = ny // 2, nz // 2
    side = WIDTH / 2 if args.quarter else WIDTH
    domain = block((LENGTH, side, side), (nx, ny, nz))
    if args.quarter:
        domain.geometry.x[:, 1:] += WIDTH / 2
    cells = np.arange(domain.topology.index_map(3).size_local, dtype=np.int32)
    middle = mesh.compute_midpoints(domain, 3, cells)[:, 0]
    tags = mesh.meshtags(domain, 3, cells, np.where((middle > 10) & (middle < 20), 2, 1).astype(np.int32))
    alpha = fem.Constant(domain, 0.0)
    a0 = ufl.as_vector((1.0, 0.0, 0.0))

    def residual(u, p, v, q, dx, ds):
        F = ufl.Identity(3) + ufl.grad(u)
        regions = ufl.Measure("dx", domain=domain, subdomain_data=tags, metadata=dx.metadata())
        muscle = ufl.inner(tissue_stress(F, p, SPRENGER_MUSCLE, a0, alpha), ufl.grad(v)) * regions(1)
        tendon = ufl.inner(tissue_stress(F, p, SPRENGER_TENDON, a0), ufl.grad(v)) * regions(2)
        return muscle + tendon + q * (ufl.det(F) - 1) * regions(1) + q * (ufl.det(F) - 1) * regions(2)

    problem = Problem(domain, residual, pressure=args.pressure)
    moved = clamp_ends(problem, LENGTH)
    if args.quarter:
        for i in (1, 2):
            problem.fix(lambda x, i=i: np.isclose(x[i], WIDTH / 2), i, problem.constant())
    for k in (1, 2):
        moved[0].value = PULL * k / 2
        problem.step()
    rows, before = [], 0.0
    for a in STATES:
        steps = round((a - before) / 0.15)
        for k in range(1, steps + 1):
            alpha.value = before + (a - before) * k / steps
            problem.step()
        before = a
        force = share * problem.reaction(lambda x: np.isclose(x[0], LENGTH))[0]
        axis = [problem.displacement_at((x, WIDTH / 2, WIDTH / 2))[0] for x in (10.0, 20.0)]
        rows.append((args.cells, "Q2/Q1" if args.pressure == "Lagrange" else "Q2/P1 discontinuous",
                     "quarter" if args.quarter else "whole", problem.unknowns, PULL, a, f"{force:.7f}",
                     *(f"{u:.7f}" for u in axis), problem.negative_modes(), f"{cpu_s() - start:.1f}",
                     f"{peak_mb():.0f}"))
        print(*rows[-1], flush=True)
    if args.csv:
        with open(args.csv, "a", newline="") as file:
            out = csv.writer(file, lineterminator="\n")
            if file.tell() == 0:
                out.writerow(("cells", "element", "model", "unknowns", "pull_mm", "alpha", "force_x_n",
                              "interface_1_u_x_mm", "interface_2_u_x_mm", "negative_modes", "cpu_s", "peak_mb"))
            out.writerows(rows)


if __name__ == "__main__":
    main()
