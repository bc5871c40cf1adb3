#!/usr/bin/env python3
"""Reads what the mesh writer wrote with h5py and an XML parser, and checks it: read_mesh_series.py FILE...

A file is called after its cells: hex27.vtkhdf, or hex27_static.vtkhdf. Code 77: h5py is missing.
"""
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

try:
    import h5py
    import numpy as np
except ImportError:
    sys.exit(77)

NODES = {"tet4": 4, "tet10": 10, "hex8": 8, "hex20": 20, "hex27": 27}
TYPES = {"tet4": 10, "tet10": 24, "hex8": 12, "hex20": 25, "hex27": 29}
XDMF = {"tet4": "Tetrahedron", "tet10": "Tetrahedron_10", "hex8": "Hexahedron", "hex20": "Hexahedron_20",
        "hex27": "Hexahedron_27"}


def check(file):
    kind, _, static = file.stem.partition("_")
    with h5py.File(file) as f:
        root = f["VTKHDF"]
        assert root.attrs["Type"] == b"UnstructuredGrid", root.attrs["Type"]
        assert list(root.attrs["Version"]) == ([1, 0] if static else [2, 0])
        points, cells = int(root["NumberOfPoints"][0]), int(root["NumberOfCells"][0])
        assert root["Points"].shape == (points, 3) and root["Points"].attrs["unit"] == "m"
        assert root["Connectivity"].shape == (cells * NODES[kind],) == (int(root["NumberOfConnectivityIds"][0]),)
        assert np.array_equal(root["Offsets"], np.arange(cells + 1) * NODES[kind])
        assert np.all(root["Types"][:] == TYPES[kind]) and root["Types"].dtype == np.uint8
        assert root["CellData/region"].attrs["names"] == '["tendon","muscle"]'
        x = root["Points"][:]
        u = root["PointData/displacement"]
        assert u.attrs["unit"] == "m" and root["PointData/pressure"].attrs["unit"] == "Pa"
        if static:
            assert "Steps" not in root and u.shape == (points, 3) and np.array_equal(u[:, 1], x[:, 0])
            return
        steps = root["Steps"]
        assert steps.attrs["NSteps"] == 3 and np.array_equal(steps["Values"], [0, 0.5, 1])
        for k in range(3):
            assert steps["NumberOfParts"][k] == 1 and steps["PartOffsets"][k] == 0 and steps["PointOffsets"][k] == 0
            assert steps["CellOffsets"][k, 0] == 0 and steps["ConnectivityIdOffsets"][k, 0] == 0
            at = steps["PointDataOffsets/displacement"][k]
            assert np.array_equal(u[at:at + points], np.column_stack([1000 * k + np.arange(points), x[:, 0], -x[:, 1]]))
            at = steps["CellDataOffsets/stretch"][k]
            assert np.allclose(root["CellData/stretch"][at:at + cells], 1 + 0.1 * k)
            assert steps["CellDataOffsets/fibre"][k] == 0 and steps["CellDataOffsets/region"][k] == 0

        grids = ET.parse(file.with_suffix(".xdmf")).findall("./Domain/Grid/Grid")
        assert [float(g.find("Time").get("Value")) for g in grids] == [0, 0.5, 1]

        def value(item):
            """A DataItem of HDF5."""
            shape = tuple(int(n) for n in item.get("Dimensions").split())
            name, path = item.text.split(":")
            assert name == file.name
            data = f[path]
            assert data.shape == shape, (path, data.shape, shape)
            assert data.dtype.itemsize == int(item.get("Precision"))
            return data[:]

        for k, grid in enumerate(grids):
            assert grid.find("Topology").get("TopologyType") == XDMF[kind]
            assert np.array_equal(value(grid.find("Topology/DataItem")), root["Connectivity"])
            assert np.array_equal(value(grid.find("Geometry/DataItem")), x)
            got = {a.get("Name"): (a.get("Center"), value(a[0])) for a in grid.findall("Attribute")}
            assert set(got) == {"displacement", "pressure", "stretch", "fibre", "region"}, set(got)
            assert np.array_equal(got["displacement"][1][:, 0], 1000 * k + np.arange(points))
            assert np.all(got["pressure"][1] == 7 + k) and got["stretch"][0] == "Cell"


for name in sys.argv[1:]:
    check(Path(name))
