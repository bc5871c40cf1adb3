#!/usr/bin/python3
"""Blemker's muscle material as FEBio states it (FEBioMech/FEMuscleMaterial.cpp, "muscle material"; Blemker, Pinsky and Delp
2005, doi:10.1016/j.jbiomech.2004.04.009), unit cube stretched by 1.2 along the fibre, sides free: numpy and scipy only.
Prints lateral stretch, axial Cauchy stress (Pa) and the norm of the free lateral displacements of a unit hexahedron."""
import numpy as np
from scipy.optimize import brentq

G1 = G2 = 500.0
P1, P2, LOFL, SMAX, LAM_MAX, K, ACTIVATION, STRETCH = 0.05, 6.6, 1.0, 3e5, 1.4, 1e7, 0.0, 1.2


def passive(x):
    if x <= LOFL:
        return 0.0
    if x < LAM_MAX:
        return P1 * np.expm1(P2 * (x / LOFL - 1))
    p3 = P1 * P2 * np.exp(P2 * (LAM_MAX / LOFL - 1))
    return p3 * (x - LAM_MAX) / LOFL + P1 * np.expm1(P2 * (LAM_MAX / LOFL - 1))


def active(x):
    x = x / LOFL
    if 0.4 < x <= 0.6:
        return 9 * (x - 0.4)**2
    if 0.6 < x < 1.4:
        return 1 - 4 * (1 - x)**2
    return 9 * (x - 1.6)**2 if 1.4 <= x < 1.6 else 0.0


def stress(axial, lateral, activation=ACTIVATION):
    """Cauchy stress (axial, lateral): sigma = dev(2/J sum W_i ...) + K ln J / J. Uniaxial: I5 = I4^2, so B1 = 0."""
    J = axial * lateral**2
    a, b = axial * J**(-1 / 3), lateral * J**(-1 / 3)
    i1, i4 = a * a + 2 * b * b, a * a
    w = (i1 * i4 - i4 * i4) / (2 * a)
    beta = np.arccosh(w) / np.sqrt(w * w - 1) if w > 1 + 1e-12 else 1.0
    force = SMAX * (passive(a) + activation * active(a)) / LOFL
    w1 = G2 * beta * a
    w4 = -2 * G1 / i4 + G2 * beta * (i1 * i4 + i4**2) / 2 * i4**-1.5 + force / (2 * a)
    w5 = G1 / i4**2 - G2 * beta / a
    t = np.array((w1 * a * a + w4 * i4 + 2 * w5 * i4 * a * a, w1 * b * b))
    mean = (t[0] + 2 * t[1]) / 3
    return 2 / J * (t - mean) + K * np.log(J) / J


def main():
    lateral = brentq(lambda x: stress(STRETCH, x)[1], 0.8, 1.0, xtol=1e-15)
    print(f"{lateral:.10f} {stress(STRETCH, lateral)[0]:.6f} {np.sqrt(8) * abs(lateral - 1):.12f}")


if __name__ == "__main__":
    main()
