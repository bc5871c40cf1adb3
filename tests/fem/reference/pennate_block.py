#!/usr/bin/python3
"""Pennate active block, 20 x 10 x 10 mm, fibres at 20 degrees to x in the x-y plane, SPRENGER_MUSCLE:
both ends held, right end moved to stretch 1.05 (two steps), then alpha 0.3 and 0.6. Force on the right end (N) by
consistent nodal reactions and its moment (N mm) about the deformed centre of that end.

    python3 pennate_block.py [--cells 8x4x4] [--half] [--tetrahedra] [--csv out.csv]

--half keeps z in [5, 10] with u_z = 0 on z = 5 (the problem is symmetric); forces and moments are those of the whole.
--tetrahedra cuts each cell into six P2/P1 tetrahedra.
"""
import argparse
import csv

import numpy as np
from taylor_hood import SPRENGER_MUSCLE, block, clamp_ends, cpu_s, fem, peak_mb, tissue_problem

LENGTH, WIDTH, PENNATION_DEG, STRETCH = 20.0, 10.0, 20.0, 1.05
STATES = (0.0, 0.3, 0.6)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cells", default="8x4x4", help="of the whole block")
    parser.add_argument("--half", action="store_true")
    parser.add_argument("--tetrahedra", action="store_true")
    parser.add_argument("--csv")
    args = parser.parse_args()
    nx, ny, nz = map(int, args.cells.split("x"))
    start = cpu_s()
    if args.half:
        assert nz % 2 == 0
        nz //= 2
    domain = block((LENGTH, WIDTH, WIDTH / 2 if args.half else WIDTH), (nx, ny, nz), args.tetrahedra)
    if args.half:
        domain.geometry.x[:, 2] += WIDTH / 2
    beta = np.radians(PENNATION_DEG)
    alpha = fem.Constant(domain, 0.0)
    problem = tissue_problem(domain, SPRENGER_MUSCLE, (np.cos(beta), np.sin(beta), 0.0), alpha)
    moved = clamp_ends(problem, LENGTH)
    if args.half:
        problem.fix(lambda x: np.isclose(x[2], WIDTH / 2), 2, problem.constant())
    for k in (1, 2):
        moved[0].value = (STRETCH - 1) * LENGTH * k / 2
        problem.step()
    rows, before = [], 0.0
    for a in STATES:
        steps = round((a - before) / 0.15)
        for k in range(1, steps + 1):
            alpha.value = before + (a - before) * k / steps
            problem.step()
        before = a
        centre = (STRETCH * LENGTH, WIDTH / 2, WIDTH / 2)
        force, moment = problem.reaction(lambda x: np.isclose(x[0], LENGTH), centre)
        if args.half:  # mirror image: F_z, M_x and M_y of the halves cancel
            force, moment = force * (2, 2, 0), moment * (0, 0, 2)
        family = "P2/P1 tetrahedra" if args.tetrahedra else "Q2/Q1 hexahedra"
        rows.append((args.cells, family, "half" if args.half else "whole", problem.unknowns, STRETCH, a,
                     *(f"{f:.7f}" for f in force), *(f"{m:.6f}" for m in moment), problem.negative_modes(),
                     f"{cpu_s() - start:.1f}", f"{peak_mb():.0f}"))
        print(*rows[-1], flush=True)
    if args.csv:
        with open(args.csv, "a", newline="") as file:
            out = csv.writer(file, lineterminator="\n")
            if file.tell() == 0:
                out.writerow(("cells", "element", "model", "unknowns", "stretch", "alpha", "force_x_n", "force_y_n",
                              "force_z_n", "moment_x_nmm", "moment_y_nmm", "moment_z_nmm", "negative_modes", "cpu_s",
                              "peak_mb"))
            out.writerows(rows)


if __name__ == "__main__":
    main()
