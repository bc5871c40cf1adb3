#!/usr/bin/env python3
"""emg_conditioning_bench.py PROGRAM: the conditioning chain of Brachium and the same chain in scipy, one after the
other on the same 16 channels x 60 s x 2 kHz and one core each; compares results, prints both times and their ratio.
Fails when the ratio is below 5 or the results differ by more than 1e-9."""
import os
import subprocess
import sys
import tempfile
import time

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ[name] = "1"

import numpy as np
from scipy import signal


def chain(channels, high, low):
    out = np.empty_like(channels)
    for i, x in enumerate(channels):
        x = signal.sosfiltfilt(high, x - x.mean())
        out[i] = signal.sosfiltfilt(low, np.abs(x))
    return out


def main():
    with tempfile.TemporaryDirectory() as folder:
        raw, result = os.path.join(folder, "raw"), os.path.join(folder, "result")
        text = subprocess.run([sys.argv[1], raw, result], check=True, capture_output=True, text=True).stdout
        channels = np.fromfile(raw).reshape(16, -1)
        ours = np.fromfile(result).reshape(16, -1)
    ours_s = float(text.split(":")[1].split("s")[0])
    high = signal.butter(2, 30, "highpass", fs=2000, output="sos")
    low = signal.butter(2, 6, "lowpass", fs=2000, output="sos")
    best = np.inf
    for _ in range(5):
        start = time.process_time()
        reference = chain(channels, high, low)
        best = min(best, time.process_time() - start)
    print(text, end="")
    print(f"scipy, channel by channel: {best:.6f} s CPU (best of 5)")
    difference = np.abs(ours - reference).max() / reference.max()
    print(f"ratio {best / ours_s:.1f}; largest relative difference {difference:.1e}")
    return 0 if best / ours_s >= 5 and difference <= 1e-9 else 1


if __name__ == "__main__":
    sys.exit(main())
