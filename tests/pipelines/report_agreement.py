"""Figures of agreement by numpy, for report_build_test.cpp. Run: python3 report_agreement.py"""
import numpy as np

i = np.arange(1, 41)
measured = 5.0 * np.sin(0.3 * i) + 0.1 * i
modelled = 4.6 * np.sin(0.3 * i + 0.1) + 0.1 * i + 0.2
e = modelled - measured
print("rmse        %.15g" % np.sqrt(np.mean(e**2)))
print("mean abs    %.15g" % np.mean(np.abs(e)))
print("largest     %.15g" % np.max(np.abs(e)))
print("nrmse       %.15g" % (np.sqrt(np.mean(e**2)) / np.ptp(measured)))
print("r squared   %.15g" % (1 - np.sum(e**2) / np.sum((measured - measured.mean()) ** 2)))
print("bias        %.15g" % e.mean())
print("deviation   %.15g" % e.std(ddof=1))
