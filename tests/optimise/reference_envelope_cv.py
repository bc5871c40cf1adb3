"""Monte Carlo check of the envelope's coefficient of variation. Run: /usr/bin/python3 reference_envelope_cv.py"""
import numpy as np
from scipy.signal import butter, sosfiltfilt

fs, n = 2000.0, 4_000_000
rng = np.random.default_rng(1)
x = sosfiltfilt(butter(8, [20.0, 450.0], "band", fs=fs, output="sos"), rng.standard_normal(n))
for cutoff in (3.0, 6.0, 12.0):
    c = (np.sqrt(2.0) - 1.0) ** 0.25
    f = np.arctan(np.tan(np.pi * cutoff / fs) / c) / np.pi * fs
    e = sosfiltfilt(butter(2, f, fs=fs, output="sos"), np.abs(x))[20000:-20000]
    print(cutoff, e.std() / e.mean())
