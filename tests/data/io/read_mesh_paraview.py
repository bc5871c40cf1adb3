#!/usr/bin/env python3
"""By hand: opens NAME.xdmf with both XDMF readers of ParaView and static NAME.vtkhdf files with its VTKHDF reader.

Debian package python3-paraview; run with Debian's python3: read_mesh_paraview.py FILE... For every step it prints the cell
type, the largest distance of a node from where VTK's own node order puts it in straight-sided cells (0 but for rounding if
the order is right), and the first values of the first point array.
"""
import sys
from pathlib import Path

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline as Pipeline
from vtkmodules.vtkIOHDF import vtkHDFReader
from vtkmodules.vtkIOXdmf2 import vtkXdmfReader
from vtkmodules.vtkIOXdmf3 import vtkXdmf3Reader


def grid_of(data):
    while data is not None and data.IsA("vtkCompositeDataSet"):
        iterator = data.NewIterator()
        iterator.InitTraversal()
        data = iterator.GetCurrentDataObject()
    return data


def report(grid, label):
    points = vtk_to_numpy(grid.GetPoints().GetData())
    misfit = 0.0
    for c in range(grid.GetNumberOfCells()):
        cell = grid.GetCell(c)
        count = cell.GetNumberOfPoints()
        local = np.array([cell.GetParametricCoords()[i] for i in range(3 * count)]).reshape(-1, 3)
        x = points[[cell.GetPointId(i) for i in range(count)]]
        basis = np.c_[local, np.ones(count)]  # straight and parallel-sided: an affine map
        misfit = max(misfit, abs(basis @ np.linalg.lstsq(basis, x, rcond=None)[0] - x).max())
    array = grid.GetPointData().GetArray(0)
    values = None if array is None else vtk_to_numpy(array)[:2].tolist()
    print(f"{label}: VTK type {grid.GetCellType(0)}, {grid.GetNumberOfCells()} cells, misfit {misfit:.1e}, {values}")


for name in map(Path, sys.argv[1:]):
    if name.suffix == ".vtkhdf":
        reader = vtkHDFReader()
        reader.SetFileName(str(name))
        reader.Update()
        report(grid_of(reader.GetOutputDataObject(0)), name.name)
        continue
    for kind in (vtkXdmfReader, vtkXdmf3Reader):
        reader = kind()
        reader.SetFileName(str(name))
        reader.UpdateInformation()
        info = reader.GetExecutive().GetOutputInformation(0)
        for i in range(info.Length(Pipeline.TIME_STEPS())):
            time = info.Get(Pipeline.TIME_STEPS(), i)
            reader.UpdateTimeStep(time)
            report(grid_of(reader.GetOutputDataObject(0)), f"{name.name} {kind.__name__} t = {time:g}")
