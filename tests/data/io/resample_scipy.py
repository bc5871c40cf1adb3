"""Numbers for resample_test.cpp: scipy's polyphase resampling with our filter, made from its published design formulas.

Run: python3 tests/data/io/resample_scipy.py   (scipy 1.10)
"""
import numpy as np
from scipy import signal

# 2000 Hz -> 600 Hz (up 3, down 10), passband 0.9 * 300 Hz, 100 dB.
up, down, fs = 3, 10, 2000.0
stop, attenuation = 300.0, 100.0
passband = 0.9 * stop
beta = signal.kaiser_beta(attenuation)
half = 0.5 * (attenuation - 7.95) / (2.285 * 2 * np.pi * (stop - passband))  # [s]
n = int(np.floor(half * fs * up))
t = np.arange(-n, n + 1) / (fs * up)
fc = 0.5 * (passband + stop)
h = np.sinc(2 * fc * t) * np.i0(beta * np.sqrt(1 - (t / half) ** 2))
for phase in range(up):  # gain 1 for constants at each phase
    k = (np.arange(-n, n + 1) + phase) % up == 0
    h[k] /= h[k].sum()
i = np.arange(4000)
x = np.sin(0.05 * i) + 0.5 * np.cos(0.31 * i + 0.2) + 0.1 * ((i * 7919) % 101 - 50) / 50
padded = x  # compare in the middle only, away from the ends
up_x = np.zeros(len(x) * up)
up_x[::up] = padded
y = np.convolve(up_x, h)[n:n + len(up_x)][::down]
check = signal.resample_poly(x, up, down, window=h)  # scipy's own polyphase engine (it scales a given window by `up`)
assert np.allclose(check[200:-200] / up, y[200:-200], atol=1e-12) or np.allclose(check[200:-200], y[200:-200], atol=1e-12)
for j in (400, 401, 577, 700, 801):
    print(f"{{{j}, {y[j]!r}}},")
print("beta", repr(beta), "half", repr(half))
