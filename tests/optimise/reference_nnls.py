"""Numbers of nnls_test.cpp, by scipy.optimize.nnls and lsq_linear. Run: /usr/bin/python3 reference_nnls.py"""
import numpy as np
from scipy.optimize import lsq_linear, nnls

i = np.arange(12)[:, None]
j = np.arange(5)[None, :]
A = np.cos(1.3 * i * (j + 1) + 0.7 * j) + 0.1 * j
b = np.sin(0.9 * np.arange(12)) - 0.4 * np.cos(1.3 * np.arange(12)) + 0.1
x, norm = nnls(A, b)
print("nnls", [repr(float(v)) for v in x], repr(float(norm)))
fit = lsq_linear(A, b, bounds=(-0.1, 0.15), method="bvls", tol=1e-14)
print("bvls", [repr(float(v)) for v in fit.x], repr(float(np.linalg.norm(A @ fit.x - b))))
