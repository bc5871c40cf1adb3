#!/usr/bin/env python3
"""Reference results by scipy and h5py for the tests of emg. Signals are files of native doubles.

scipy_reference.py filter IN OUT RATE KIND ORDER EDGE [EDGE]     sosfiltfilt of a Butterworth filter
scipy_reference.py notch IN OUT RATE EDGE WIDTH                  sosfiltfilt of iirnotch
scipy_reference.py envelope IN OUT RATE HIGHPASS LOWPASS ORDER   offset, high-pass, rectify, low-pass, each zero-lag
scipy_reference.py welch IN OUT RATE SEGMENT                     power spectral density
scipy_reference.py hdf5 FILE OUT                                 the raw channel of an OpenSignals HDF5 file
scipy_reference.py numbers                                       prints the numbers pinned in the tests
"""
import sys

import numpy as np
from scipy import signal, special


def zero_lag(x, rate, kind, order, edges):
    return signal.sosfiltfilt(signal.butter(order, edges, kind, fs=rate, output="sos"), x)


def notch(x, rate, edge, width):
    b, a = signal.iirnotch(edge, edge / width, fs=rate)
    return signal.sosfiltfilt(signal.tf2sos(b, a), x)


def envelope(x, rate, highpass, lowpass, order):
    x = zero_lag(x - x.mean(), rate, "highpass", order, highpass)
    return zero_lag(np.abs(x), rate, "lowpass", order, lowpass)


def hdf5(path):
    import h5py

    found = []

    def visit(name, node):
        if isinstance(node, h5py.Dataset) and "/raw/channel_" in name:
            found.append(np.asarray(node, dtype=float).ravel())

    with h5py.File(path) as file:
        file.visititems(visit)
    return found[0]


def chirp(n=2000):
    """The deterministic signal of biquad_test.cpp."""
    k = np.arange(n)
    return np.sin(0.02 * k) + 0.4 * np.sin(0.0004 * k * k) + 0.3 * np.cos(1.1 * k) + 0.2


def numbers():
    x = chirp()
    at = [0, 1, 7, 500, 1234, 1999]
    print("low_pass 6 Hz order 2, 1 kHz", [repr(v) for v in zero_lag(x, 1000, "lowpass", 2, 6)[at]])
    print("high_pass 30 Hz order 3, 1 kHz", [repr(v) for v in zero_lag(x, 1000, "highpass", 3, 30)[at]])
    print("band_pass 20-200 Hz order 4, 1 kHz", [repr(v) for v in zero_lag(x, 1000, "bandpass", 4, [20, 200])[at]])
    print("notch 50 Hz, width 2 Hz, 1 kHz", [repr(v) for v in notch(x, 1000, 50, 2)[at]])
    b = signal.butter(2, 6, fs=1000, output="sos")
    zi = signal.sosfilt_zi(b)
    y, _ = signal.sosfilt(b, x, zi=zi * x[0])
    print("causal low_pass 6 Hz order 2", [repr(v) for v in y[at]])
    print("group delay at 0 Hz [ms]", repr(signal.group_delay(signal.butter(2, 6, fs=1000), w=[1e-9], fs=1000)[1][0]))
    print("normal quantiles", [repr(v) for v in special.ndtri([1e-300, 1e-9, 0.01, 0.2, 0.5, 0.6, 0.975])])
    f, p = signal.welch(x, 1000, nperseg=256)
    print("welch 256", [repr(v) for v in p[[0, 1, 3, 45, 128]]])


def main(arguments):
    mode = arguments[0]
    if mode == "numbers":
        return numbers()
    if mode == "hdf5":
        hdf5(arguments[1]).tofile(arguments[2])
        return None
    x = np.fromfile(arguments[1])
    rest = arguments[3:]
    if mode == "filter":
        edges = [float(v) for v in rest[3:]]
        y = zero_lag(x, float(rest[0]), rest[1], int(rest[2]), edges if len(edges) > 1 else edges[0])
    elif mode == "notch":
        y = notch(x, *(float(v) for v in rest))
    elif mode == "envelope":
        y = envelope(x, float(rest[0]), float(rest[1]), float(rest[2]), int(rest[3]))
    elif mode == "welch":
        y = signal.welch(x, float(rest[0]), nperseg=int(rest[1]))[1]
    else:
        raise SystemExit(__doc__)
    y.tofile(arguments[2])
    return None


if __name__ == "__main__":
    main(sys.argv[1:])
