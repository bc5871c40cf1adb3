"""Elbow moment of one dumbbell-curl recording with scipy, for inverse_dynamics_test.cpp and smoothing_test.cpp.

Run: python3 inverse_dynamics_reference.py <folder of the recordings>
Everything is worked out from the definition of angular momentum about the elbow; nothing is shared with the C++ code.
"""
import glob
import sys

import numpy as np
from scipy.signal import butter, sosfiltfilt


def low_pass(x, cutoff, rate):
    design = np.arctan(np.tan(np.pi * cutoff / rate) * (np.sqrt(2) - 1) ** -0.25) * rate / np.pi
    pad = 2 * int(np.ceil(rate / cutoff))
    return sosfiltfilt(butter(2, design, fs=rate, output="sos"), x, axis=0, padtype="odd", padlen=pad)


def derivative(x, rate):
    d = np.empty_like(x)
    d[2:-2] = rate / 12 * (x[:-4] - 8 * x[1:-3] + 8 * x[3:-1] - x[4:])
    for i, c in ((0, [-25, 48, -36, 16, -3]), (1, [-3, -10, 18, -6, 1])):
        d[i] = rate / 12 * np.tensordot(c, x[:5], 1)
        d[-1 - i] = -rate / 12 * np.tensordot(c, x[-1:-6:-1], 1)
    return d


rate, cutoff, g = 200.0, 3.0, 9.80665
t = np.arange(1000) / rate
print("smoothing:", [float(v) for v in low_pass(np.sin(2 * np.pi * t) + 0.3 * np.cos(2 * np.pi * 7 * t) + t * t, cutoff, rate)[[0, 1, 137, 500, 999]]])

if len(sys.argv) > 1:
    folder = glob.glob(sys.argv[1] + "/elbow_curls_noraxon/IMU/*_2.75_T_1")[0]
    read = lambda name: np.loadtxt(f"{folder}/Noraxon MyoMotion-{name}.csv", delimiter=",", skiprows=4, encoding="utf-8-sig")[:, 1:]
    elbow = read("Trajectories-Elbow RT") / 1e3
    wrist = (read("Trajectories-Radial styloid process RT") + read("Trajectories-Ulnar styloid process RT")) / 2e3
    u = wrist - elbow
    u /= np.linalg.norm(u, axis=1)[:, None]
    u = low_pass(u, cutoff, rate)
    u /= np.linalg.norm(u, axis=1)[:, None]
    z = np.array([0, 0, 1.0])
    horizontal = u - np.outer(u @ z, z)
    mean = horizontal.sum(0) / np.linalg.norm(horizontal.sum(0))
    h = (horizontal @ mean)[:, None] * horizontal + 0.05 * mean
    h /= np.linalg.norm(h, axis=1)[:, None]
    n = np.cross(h, z)
    # forearm, hand (de Leva 1996, 75 kg) and the load, each as (mass, distance, inertia about its centre)
    bodies = [(75 * 0.0162, 0.4574 * 0.25, 75 * 0.0162 * (0.265 * 0.25) ** 2),
              (75 * 0.0061, 0.25 + 0.79 * 0.0862, 75 * 0.0061 * (0.513 * 0.0862) ** 2),
              (2.75 * 0.45359237, 0.318, 0.0)]
    udd = derivative(derivative(u, rate), rate)
    a = derivative(derivative(low_pass(elbow, cutoff, rate), rate), rate)
    moment = np.zeros(len(u))
    for m, d, inertia in bodies:
        # moment about the elbow of what moves this body: m r x (acceleration of its centre - g) + spin of its own
        moment += np.einsum("ij,ij->i", n, m * d * np.cross(u, a + d * udd + g * z) + inertia * np.cross(u, udd))
    print("moment:", [float(v) for v in moment[[0, 300, 1000, 2000, 4000, 5000]]], "mean", float(moment.mean()), "sd", float(moment.std()))
