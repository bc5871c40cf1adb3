#!/usr/bin/python3
"""Compressed block: quarter model, cube of side 50, dead traction (0, 0, -9) on the quarter patch x, y <= 25 of the top.
Energy mu/2 (J^(-2/3) I1 - 3) + kappa/2 (J - 1)^2, as p (J - 1) - p^2 / (2 kappa) in mixed form; mu 1.61148,
lambda 499.92568, kappa = lambda + 2 mu/3. Prints the largest displacement component.

    python3 compressed_block.py [--cells 2] [--element q1p0|q2q1|q2p1disc|q2q1disc] [--volumetric j1|lnj|j2lnj]
"""
import argparse

import numpy as np
import ufl
from taylor_hood import Problem, block, mesh

SIDE, MU, LAMBDA, TRACTION = 50.0, 1.61148, 499.92568, 9.0
KAPPA = LAMBDA + 2 * MU / 3
ELEMENTS = {"q1p0": ((1, 0), "DG", 3), "q2q1": ((2, 1), "Lagrange", 5), "q2p1disc": ((2, 1), "DPC", 5),
            "q2q1disc": ((2, 1), "DQ", 5)}
# U(J) with U(1) = U'(1) = 0, U''(1) = 1, given by its derivative
PRESSURE = {"j1": lambda J: J - 1, "lnj": lambda J: ufl.ln(J) / J, "j2lnj": lambda J: (J - 1 / J) / 2}


def solve(cells, element, volumetric="j1", increments=12):
    domain = block((SIDE,) * 3, (cells,) * 3)
    patch = mesh.locate_entities_boundary(
        domain, 2, lambda x: np.isclose(x[2], SIDE) & (x[0] < SIDE / 2 + 1e-6) & (x[1] < SIDE / 2 + 1e-6))
    tags = mesh.meshtags(domain, 2, np.sort(patch), np.ones(len(patch), dtype=np.int32))
    orders, pressure, degree = ELEMENTS[element]
    from taylor_hood import fem
    load = fem.Constant(domain, 0.0)

    def residual(u, p, v, q, dx, ds):
        F = ufl.variable(ufl.Identity(3) + ufl.grad(u))
        J = ufl.det(F)
        shear = ufl.diff(MU / 2 * (J ** (-2 / 3) * ufl.tr(F.T * F) - 3), F)
        P = shear + p * J * ufl.inv(F).T
        return (ufl.inner(P, ufl.grad(v)) + q * (PRESSURE[volumetric](J) - p / KAPPA)) * dx + load * v[2] * ds(1)

    # the tangent is symmetric for U = (J - 1)^2 / 2 only
    problem = Problem(domain, residual, orders, pressure, degree, tags, symmetric=volumetric == "j1")
    zero = problem.constant()
    for i, where in enumerate((lambda x: np.isclose(x[2], SIDE) | np.isclose(x[0], 0),
                               lambda x: np.isclose(x[2], SIDE) | np.isclose(x[1], 0),
                               lambda x: np.isclose(x[2], 0))):
        problem.fix(where, i, zero)
    for k in range(1, increments + 1):
        load.value = TRACTION * k / increments
        problem.step()
    modes = problem.negative_modes() if problem.symmetric else None
    return max(np.abs(problem.w.vector.array[numbers]).max() for numbers, _ in problem.component), modes


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cells", type=int, default=2)
    parser.add_argument("--element", choices=ELEMENTS, default="q2q1")
    parser.add_argument("--volumetric", choices=PRESSURE, default="j1")
    args = parser.parse_args()
    largest, modes = solve(args.cells, args.element, args.volumetric)
    print(args.element, args.cells, args.volumetric, f"{largest:.8f}", "negative modes", modes)


if __name__ == "__main__":
    main()
