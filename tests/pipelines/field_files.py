"""Whether the field files of a stretched block (20 x 10 x 10 mm, incompressible neo-Hooke of 20 kPa, free across) hold its
uniform state at every step, read with h5py as VTKHDF and through the references of the XDMF file.

    python3 field_files.py FOLDER/NAME        (NAME.vtkhdf, NAME.xdmf)
"""
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import h5py
import numpy as np

MODULUS, LENGTH = 2e4, 0.02
name = Path(sys.argv[1])
folder, stretches = name.parent, []


def check(points, displacement, stress):
    stretch = 1 + displacement[:, 0].max() / LENGTH
    across = 1 / np.sqrt(stretch) - 1
    expected = points * [stretch - 1, across, across]
    assert np.abs(displacement - expected).max() < 1e-8, "displacement"
    assert np.abs(stress - MODULUS * (stretch**2 - 1 / stretch)).max() < 1e-2, "von Mises stress"
    return stretch


with h5py.File(name.with_suffix(".vtkhdf")) as file:
    root = file["VTKHDF"]
    assert root.attrs["Type"] == b"UnstructuredGrid" and list(root.attrs["Version"]) == [2, 0]
    steps = root["Steps"]
    count = steps.attrs["NSteps"]
    points = root["Points"][()]
    assert np.all(root["Types"][()] == 29), "27-node hexahedra"
    assert root["Connectivity"][()].max() == len(points) - 1 and root["Offsets"][-1] == len(root["Connectivity"])
    for k in range(count):
        at = {field: steps[f"PointDataOffsets/{field}"][k] for field in ("displacement", "von_mises")}
        data = [root[f"PointData/{field}"][first:first + len(points)] for field, first in at.items()]
        stretches.append(check(points, *data))


def item(element):
    file, path = element.find("DataItem").text.strip().split(":")
    with h5py.File(folder / file) as data:
        return data[path][()]


grids = ElementTree.parse(name.with_suffix(".xdmf")).findall(".//Grid[@GridType='Uniform']")
assert len(grids) == count
for grid, stretch in zip(grids, stretches):
    fields = {attribute.get("Name"): item(attribute) for attribute in grid.findall("Attribute")}
    assert abs(check(item(grid.find("Geometry")), fields["displacement"], fields["von_mises"]) - stretch) < 1e-12
assert abs(max(stretches) - 1.5) < 1e-9, stretches
print(count, "states")
