#!/usr/bin/python3
"""Clamped active block, 40 x 10 x 10 mm, fibres along x, both ends held, right end moved to the stretch, then
activated: axial force (N) by consistent nodal reactions, Q2/Q1 hexahedra, exactly incompressible.

    python3 clamped_block.py [--cells 16x4x4] [--states 1.1:0,0.25,0.5,1 ...] [--quadrature 5] [--csv out.csv]
"""
import argparse
import csv

import numpy as np
from taylor_hood import BLOCK_MUSCLE, block, clamp_ends, cpu_s, fem, peak_mb, tissue_problem

LENGTH, WIDTH = 40.0, 10.0


def make(cells, muscle=BLOCK_MUSCLE, **options):
    domain = block((LENGTH, WIDTH, WIDTH), cells)
    alpha = fem.Constant(domain, 0.0)
    problem = tissue_problem(domain, muscle, (1.0, 0.0, 0.0), alpha, **options)
    return problem, alpha, clamp_ends(problem, LENGTH)


def axial_force(problem):
    return problem.reaction(lambda x: np.isclose(x[0], LENGTH))[0]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cells", default="16x4x4")
    parser.add_argument("--states", nargs="+", default=["1.1:0,0.25,0.5,1"])
    parser.add_argument("--quadrature", type=int, default=5)
    parser.add_argument("--csv")
    args = parser.parse_args()
    cells = tuple(map(int, args.cells.split("x")))
    rows = []
    for spec in args.states:
        stretch, alphas = spec.split(":")
        start = cpu_s()
        problem, alpha, moved = make(cells, quadrature_degree=args.quadrature)
        target = (float(stretch) - 1) * LENGTH
        steps = max(1, round((float(stretch) - 1) / 0.025))
        for k in range(1, steps + 1):
            moved[0].value = target * k / steps
            problem.step()
        for a in map(float, alphas.split(",")):
            before = float(alpha.value)
            count = int(np.ceil(abs(a - before) / 0.125 - 1e-9))
            for k in range(1, count + 1):
                alpha.value = before + (a - before) * k / count
                problem.step()
            force, modes = axial_force(problem), problem.negative_modes()
            rows.append((args.cells, problem.unknowns, args.quadrature, float(stretch), a, f"{force:.7f}", modes,
                         f"{problem.volume_ratio() - 1:.1e}", f"{cpu_s() - start:.1f}", f"{peak_mb():.0f}"))
            print(*rows[-1], flush=True)
    if args.csv:
        with open(args.csv, "a", newline="") as file:
            out = csv.writer(file, lineterminator="\n")
            if file.tell() == 0:
                out.writerow(("cells", "unknowns", "quadrature_degree", "stretch", "alpha", "force_n",
                              "negative_modes", "volume_change", "cpu_s", "peak_mb"))
            out.writerows(rows)


if __name__ == "__main__":
    main()
