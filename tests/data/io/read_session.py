"""Opens a session file as any user of h5py and xarray would, and prints what it found; exit code 77: packages absent."""
import sys

try:
    import h5py
    import numpy as np
    import xarray
    import h5netcdf  # noqa: F401  the engine
except ImportError as error:
    print(error)
    sys.exit(77)

path = sys.argv[1]
with h5py.File(path, "r") as file:
    assert file.attrs["format"] == "brachium-session"
    trial = file["trials/mvc-1"]
    emg = trial["z_last_by_name"]
    assert emg.attrs["unit"] == emg.attrs["units"] == "V"
    assert emg.attrs["rate_hz"] == 2000.0
    assert emg.dims[0].keys() == ["time_0"], emg.dims[0].keys()
    assert trial["elbow_flexion"].dims[0].keys() == ["time_1"]
    time = emg.dims[0]["time_0"]
    assert time.attrs["units"] == "s"
    np.testing.assert_allclose(time[:], np.arange(5000) / 2000.0, rtol=1e-15)
    np.testing.assert_allclose(emg[:], np.sin(0.37 * np.arange(5000)) / 3.0, rtol=1e-13, atol=1e-15)

data = xarray.open_dataset(path, group="trials/mvc-1", engine="h5netcdf")
assert data["z_last_by_name"].dims == ("time_0",)
assert data["elbow_flexion"].dims == ("time_1",)
assert data["elbow_flexion"].attrs["units"] == "rad"
assert data["time_1"].dtype == np.float64
assert abs(float(data["time_1"][0]) - 0.0123) < 1e-15
assert data["z_last_by_name"].sel(time_0=slice(0.1, 0.2)).size == 201
assert data.attrs["kind"] == "mvc" and abs(data.attrs["condition.load_mass_kg"] - 1.133980925) < 1e-12
if len(sys.argv) > 2:
    table = xarray.open_dataset(path, group="tables/fit", engine="h5netcdf")
    assert list(table["verdict"].values) == ["identified", "AT UPPER BOUND \u00e4"]
    assert table["fitted"].attrs["units"] == "m"
    assert list(table["row"].values) == [1, 2]
print("opened")
