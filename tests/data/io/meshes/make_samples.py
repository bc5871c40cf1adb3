#!/usr/bin/env python3
"""Writes the sample meshes of this folder with other programs than ours: gmsh 4.8 (.msh) and VTK 9.1 (.vtu, .vtk); FEBio's
(.feb) are placed by the natural coordinates of FEBio's shape functions.

Debian packages: gmsh, python3-vtk9. Run in this folder with Debian's python3; `vtk` as argument leaves gmsh out. The body:
[0, 20] x [0, 10] x [0, 10] mm, region `tendon` for x < 10, `muscle` beyond; surfaces `origin` (x = 0) and `insertion`
(x = 20); all edges straight. In VTK's files regions are called 1 and 2, surfaces 7 and 8.
"""
import itertools
import subprocess
import sys
from pathlib import Path

GEO = """
SetFactory("Built-in");
Point(1) = {0, 0, 0}; Point(2) = {0, 10, 0}; Point(3) = {0, 10, 10}; Point(4) = {0, 0, 10};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4}; Plane Surface(1) = {1};
Transfinite Curve {1, 2, 3, 4} = 2; Transfinite Surface {1};
%(recombine)s
a[] = Extrude {10, 0, 0} { Surface{1}; Layers{1}; %(layer)s };
b[] = Extrude {10, 0, 0} { Surface{a[0]}; Layers{1}; %(layer)s };
Physical Surface("origin") = {1};
Physical Surface("insertion") = {b[0]};
Physical Volume("tendon") = {a[1]};
Physical Volume("muscle") = {b[1]};
"""


def gmsh():
    kinds = {
        "hex8": dict(recombine="Recombine Surface {1};", layer="Recombine;", options=["-order", "1"]),
        "hex20": dict(recombine="Recombine Surface {1};", layer="Recombine;",
                      options=["-order", "2", "-setnumber", "Mesh.SecondOrderIncomplete", "1"]),
        "hex27": dict(recombine="Recombine Surface {1};", layer="Recombine;", options=["-order", "2"]),
        "tet4": dict(recombine="", layer="", options=["-order", "1"]),
        "tet10": dict(recombine="", layer="", options=["-order", "2"]),
    }
    formats = [("22", "msh22"), ("41", "msh41")]
    for kind, k in kinds.items():
        geo = Path("sample.geo")
        geo.write_text(GEO % k)
        for suffix, name in formats:
            for binary in (0, 1):
                out = f"{kind}_{suffix}{'_binary' if binary else ''}.msh"
                subprocess.run(["gmsh", str(geo), "-3", "-format", name, "-setnumber", "Mesh.Binary", str(binary), "-o", out,
                                "-v", "1"] + k["options"], check=True)
        geo.unlink()


def tetrahedra():
    """(region, corners) of six tetrahedra a block: those along the paths over its edges from its lowest to its highest corner."""
    for block in range(2):
        for path in itertools.permutations(range(3)):
            corners = [[10.0 * block, 0.0, 0.0]]
            for axis in path:
                corners.append([x + 10.0 * (k == axis) for k, x in enumerate(corners[-1])])
            if path not in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):  # an odd permutation: a negative volume
                corners[2], corners[3] = corners[3], corners[2]
            yield block + 1, corners


def triangles():
    """(surface, corners) of those tetrahedra's faces at x = 0 (7) and x = 20 (8)."""
    for _, corners in tetrahedra():
        for x, number in ((0.0, 7), (20.0, 8)):
            face = [c for c in corners if c[0] == x]
            if len(face) == 3:
                yield number, face


def vtk_files():
    import vtk

    def grid(cell_type):
        points = vtk.vtkPoints()
        points.SetDataTypeToDouble()
        g = vtk.vtkUnstructuredGrid()
        names = vtk.vtkIntArray()
        names.SetName("region")
        fibre = vtk.vtkDoubleArray()
        fibre.SetName("fibre")
        fibre.SetNumberOfComponents(3)
        index = {}

        def point(x):
            key = tuple(x)
            if key not in index:
                index[key] = points.InsertNextPoint(key)
            return index[key]

        # The cells' own parametric coordinates place the nodes: VTK's order, not ours.
        cell = {12: vtk.vtkHexahedron, 25: vtk.vtkQuadraticHexahedron, 29: vtk.vtkTriQuadraticHexahedron}[cell_type]()
        pc = cell.GetParametricCoords()
        for block in range(2):
            ids = [point((10 * (block + pc[3 * i]), 10 * pc[3 * i + 1], 10 * pc[3 * i + 2]))
                   for i in range(cell.GetNumberOfPoints())]
            g.InsertNextCell(cell_type, len(ids), ids)
            names.InsertNextValue(block + 1)
            fibre.InsertNextTuple((1, 0, 0))
        face = {12: vtk.vtkQuad, 25: vtk.vtkQuadraticQuad, 29: vtk.vtkBiQuadraticQuad}[cell_type]()
        pc = face.GetParametricCoords()
        for x, tag in ((0, 7), (20, 8)):
            ids = [point((x, 10 * pc[3 * i], 10 * pc[3 * i + 1])) for i in range(face.GetNumberOfPoints())]
            g.InsertNextCell(face.GetCellType(), len(ids), ids)
            names.InsertNextValue(tag)
            fibre.InsertNextTuple((0, 0, 0))
        g.SetPoints(points)
        g.GetCellData().AddArray(names)
        g.GetCellData().AddArray(fibre)
        height = vtk.vtkFloatArray()
        height.SetName("height")
        for i in range(points.GetNumberOfPoints()):
            height.InsertNextValue(points.GetPoint(i)[2])
        g.GetPointData().AddArray(height)
        return g

    def tetrahedra_grid():
        points = vtk.vtkPoints()
        points.SetDataTypeToDouble()
        g = vtk.vtkUnstructuredGrid()
        names = vtk.vtkIntArray()
        names.SetName("region")
        index = {}

        def point(x):
            if x not in index:
                index[x] = points.InsertNextPoint(x)
            return index[x]

        for cell_type, kind, cells in ((24, vtk.vtkQuadraticTetra, tetrahedra()), (22, vtk.vtkQuadraticTriangle, triangles())):
            pc = kind().GetParametricCoords()
            for number, corners in cells:
                ids = []
                for i in range(kind().GetNumberOfPoints()):
                    local = pc[3 * i:3 * i + len(corners) - 1]
                    weights = (1 - sum(local), *local)
                    ids.append(point(tuple(sum(w * c[k] for w, c in zip(weights, corners)) for k in range(3))))
                g.InsertNextCell(cell_type, len(ids), ids)
                names.InsertNextValue(number)
        g.SetPoints(points)
        g.GetCellData().AddArray(names)
        return g

    g = grid(29)
    for name, mode, compressor in (("ascii", 0, None), ("inline", 1, None), ("inline_zlib", 1, "zlib"),
                                   ("appended", 2, None), ("appended_zlib", 2, "zlib"), ("raw", 3, None),
                                   ("raw_zlib", 3, "zlib"), ("raw_lz4", 3, "lz4"), ("raw_big", 4, None)):
        w = vtk.vtkXMLUnstructuredGridWriter()
        w.SetFileName(f"hex27_{name}.vtu")
        w.SetInputData(g)
        w.SetDataMode({0: 0, 1: 1, 2: 2, 3: 2, 4: 2}[mode])
        w.SetEncodeAppendedData(1 if mode == 2 else 0)
        if name == "raw_big":
            w.SetByteOrderToBigEndian()
        if name in ("raw_zlib", "inline"):
            w.SetHeaderTypeToUInt32()
        else:
            w.SetHeaderTypeToUInt64()
        if compressor is None:
            w.SetCompressorTypeToNone()
        elif compressor == "zlib":
            w.SetCompressorTypeToZLib()
            w.SetBlockSize(256)
        else:
            w.SetCompressorTypeToLZ4()
        w.Write()
    w = vtk.vtkXMLUnstructuredGridWriter()
    w.SetFileName("tet10_raw.vtu")
    w.SetInputData(tetrahedra_grid())
    w.SetDataModeToAppended()
    w.EncodeAppendedDataOff()
    w.Write()
    for kind, cell_type in (("hex8", 12), ("hex20", 25), ("hex27", 29), ("tet10", 24)):
        for binary in (0, 1):
            for version in (42, 51) if kind == "hex27" else (51,):
                w = vtk.vtkUnstructuredGridWriter()
                w.SetFileName(f"{kind}_{version}{'_binary' if binary else ''}.vtk")
                w.SetInputData(tetrahedra_grid() if kind == "tet10" else grid(cell_type))
                w.SetFileVersion(version)
                (w.SetFileTypeToBinary if binary else w.SetFileTypeToASCII)()
                w.Write()


# Nodes of FEBio's hex27 along r, s, t: 0 at -1, 1 at 1, 2 in the middle (FEHex27).
FEBIO_HEX27 = ("000 100 110 010 001 101 111 011 200 120 210 020 201 121 211 021 002 102 112 012 "
               "202 122 212 022 220 221 222").split()


def febio():
    for version, count, kind in (("2.5", 8, "hex8"), ("3.0", 20, "hex20"), ("4.0", 27, "hex27")):
        ids, cells = {}, []
        for block in range(2):
            cell = []
            for node in FEBIO_HEX27[:count]:
                r, s, t = ({"0": 0.0, "1": 1.0, "2": 0.5}[c] for c in node)
                cell.append(ids.setdefault((10 * (block + r), 10 * s, 10 * t), len(ids) + 101))
            cells.append(cell)
        text = ['<?xml version="1.0" encoding="ISO-8859-1"?>', f'<febio_spec version="{version}">',
                '  <Geometry>' if version == "2.5" else '  <Mesh>', '    <Nodes name="all">']
        text += [f'      <node id="{i}">{x:g},{y:g},{z:g}</node>' for (x, y, z), i in ids.items()]
        text.append('    </Nodes>')
        for name, cell, number in (("tendon", cells[0], 1), ("muscle", cells[1], 2)):
            text += [f'    <Elements type="{kind}" name="{name}"' + (f' mat="{number}">' if version == "2.5" else '>'),
                     f'      <elem id="{number}">' + ",".join(map(str, cell)) + '</elem>', '    </Elements>']
        for name, cell, corners in (("origin", cells[0], (0, 4, 7, 3)), ("insertion", cells[1], (1, 2, 6, 5))):
            text += [f'    <Surface name="{name}">',
                     '      <quad4 id="1">' + ",".join(str(cell[i]) for i in corners) + '</quad4>', '    </Surface>']
        corner_ids = [cells[0][i] for i in (0, 4, 7, 3)]
        text.append('    <NodeSet name="held">' + (",".join(map(str, corner_ids)) if version == "4.0" else
                    "".join(f'<n id="{i}"/>' if version == "3.0" else f'<node id="{i}"/>' for i in corner_ids)) + '</NodeSet>')
        text.append('    <ElementSet name="distal">' + ("2" if version == "4.0" else '<e id="2"/>') + '</ElementSet>')
        text.append('  </Geometry>' if version == "2.5" else '  </Mesh>')
        if version != "2.5":
            text += ['  <MeshDomains>', '    <SolidDomain name="tendon" mat="a"/>', '    <SolidDomain name="muscle" mat="b"/>',
                     '  </MeshDomains>']
        text.append('</febio_spec>')
        Path(f"{kind}_{version.replace('.', '')}.feb").write_text("\n".join(text) + "\n")


def febio_tetrahedra():
    """FEBio's tet10: corners, then the middles of the edges 01 12 20 03 13 23 (FETet10)."""
    ids = {}

    def number(x):
        return str(ids.setdefault(tuple(x), len(ids) + 101))

    def middle(a, b):
        return number((p + q) / 2 for p, q in zip(a, b))

    parts = {"tendon": [], "muscle": []}
    for region, c in tetrahedra():
        nodes = [number(x) for x in c] + [middle(c[a], c[b]) for a, b in ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))]
        parts["tendon" if region == 1 else "muscle"].append(",".join(nodes))
    surfaces = {"origin": [], "insertion": []}
    for surface, c in triangles():
        nodes = [number(x) for x in c] + [middle(c[a], c[b]) for a, b in ((0, 1), (1, 2), (2, 0))]
        surfaces["origin" if surface == 7 else "insertion"].append(",".join(nodes))
    text = ['<?xml version="1.0" encoding="ISO-8859-1"?>', '<febio_spec version="4.0">', '  <Mesh>', '    <Nodes name="all">']
    text += [f'      <node id="{i}">{x:g},{y:g},{z:g}</node>' for (x, y, z), i in ids.items()]
    text.append('    </Nodes>')
    count = itertools.count(1)
    for name, cells in parts.items():
        text += [f'    <Elements type="tet10" name="{name}">', *(f'      <elem id="{next(count)}">{c}</elem>' for c in cells),
                 '    </Elements>']
    for name, faces in surfaces.items():
        text += [f'    <Surface name="{name}">', *(f'      <tri6 id="{i}">{f}</tri6>' for i, f in enumerate(faces, 1)),
                 '    </Surface>']
    text += ['  </Mesh>', '  <MeshDomains>', '    <SolidDomain name="tendon" mat="a"/>', '    <SolidDomain name="muscle" mat="b"/>',
             '  </MeshDomains>', '</febio_spec>']
    Path("tet10_40.feb").write_text("\n".join(text) + "\n")


if __name__ == "__main__":
    febio()
    febio_tetrahedra()
    if "vtk" not in sys.argv:
        gmsh()
    vtk_files()
