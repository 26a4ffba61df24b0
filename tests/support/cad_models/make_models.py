"""Make the CAD models beside this file, and their volumes in mm³, by OpenCASCADE.

Run it with a folder, where cadquery-ocp-novtk 8.0 is installed.
"""

import json
import math
import sys
from pathlib import Path

from OCP.BRepAdaptor import BRepAdaptor_Curve
from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut, BRepAlgoAPI_Fuse
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakePolygon, BRepBuilderAPI_MakeWire
from OCP.BRepFilletAPI import BRepFilletAPI_MakeFillet
from OCP.BRepGProp import BRepGProp
from OCP.BRepLib import BRepLib
from OCP.BRepOffsetAPI import BRepOffsetAPI_MakePipeShell
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeCylinder
from OCP.Geom import Geom_CylindricalSurface
from OCP.Geom2d import Geom2d_Line
from OCP.GeomAbs import GeomAbs_Circle
from OCP.gp import gp_Ax1, gp_Ax2, gp_Ax3, gp_Dir, gp_Dir2d, gp_Pnt, gp_Pnt2d, gp_Trsf, gp_Vec
from OCP.GProp import GProp_GProps
from OCP.Quantity import Quantity_Color, Quantity_TOC_sRGB
from OCP.STEPCAFControl import STEPCAFControl_Writer
from OCP.STEPControl import STEPControl_AsIs
from OCP.TCollection import TCollection_ExtendedString
from OCP.TDataStd import TDataStd_Name
from OCP.TDocStd import TDocStd_Document
from OCP.TopAbs import TopAbs_EDGE
from OCP.TopExp import TopExp_Explorer
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS
from OCP.XCAFApp import XCAFApp_Application
from OCP.XCAFDoc import XCAFDoc_ColorSurf, XCAFDoc_DocumentTool


def edges(shape):
    seen, found = TopExp_Explorer(shape, TopAbs_EDGE), []
    while seen.More():
        edge = TopoDS.Edge(seen.Current())
        if not any(edge.IsSame(other) for other in found):
            found.append(edge)
        seen.Next()
    return found


def filleted(shape, radius, chosen=None):
    fillet = BRepFilletAPI_MakeFillet(shape)
    for edge in edges(shape):
        if chosen is None or chosen(edge):
            fillet.Add(radius, edge)
    return fillet.Shape()


def cylinder(radius, height, z=0.0):
    return BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(0, 0, z), gp_Dir(0, 0, 1)), radius, height).Shape()


def circle_at(radius, z):
    def chosen(edge):
        curve = BRepAdaptor_Curve(edge)
        if curve.GetType() != GeomAbs_Circle:
            return False
        circle = curve.Circle()
        return abs(circle.Radius() - radius) < 1e-6 and abs(circle.Location().Z() - z) < 1e-6

    return chosen


def filleted_box():
    return filleted(BRepPrimAPI_MakeBox(60.0, 40.0, 30.0).Shape(), 4.0)


def vessel(radius, height, wall, fillet):
    """Cup about Z that stands on z = 0."""
    solid = filleted(cylinder(radius, height), fillet, circle_at(radius, 0))
    hole = filleted(cylinder(radius - wall, height, wall), fillet - wall, circle_at(radius - wall, wall))
    return BRepAlgoAPI_Cut(solid, hole).Shape()


def threaded_cap():
    """Screw cap with an inner thread of two turns; its opening is at the top."""
    body = vessel(15.0, 16.0, 1.5, 2.5)
    pitch, turns, inner, sunk = 3.2, 2.0, 13.5, 0.3
    surface = Geom_CylindricalSurface(gp_Ax3(gp_Pnt(0, 0, 4.5), gp_Dir(0, 0, 1), gp_Dir(1, 0, 0)), inner)
    slope = math.hypot(2 * math.pi, pitch)
    line = Geom2d_Line(gp_Pnt2d(0, 0), gp_Dir2d(2 * math.pi, pitch))
    helix = BRepBuilderAPI_MakeEdge(line, surface, 0.0, turns * slope).Edge()
    BRepLib.BuildCurves3d_s(helix)
    spine = BRepBuilderAPI_MakeWire(helix).Wire()
    section = BRepBuilderAPI_MakePolygon()
    for x, z in ((inner + sunk, -0.9), (inner - 1.0, -0.25), (inner - 1.0, 0.25), (inner + sunk, 0.9)):
        section.Add(gp_Pnt(x, 0, 4.5 + z))
    section.Close()
    pipe = BRepOffsetAPI_MakePipeShell(spine)
    pipe.SetMode(gp_Dir(0, 0, 1))
    pipe.Add(section.Wire())
    pipe.Build()
    pipe.MakeSolid()
    return BRepAlgoAPI_Fuse(body, pipe.Shape()).Shape()


def volume(shape):
    found = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, found, 1e-6)
    return found.Mass()


def write(path, parts):
    """STEP file of parts: name, shape, colour in sRGB or None, and shift."""
    app = XCAFApp_Application.GetApplication_s()
    document = TDocStd_Document(TCollection_ExtendedString("XmlXCAF"))
    app.InitDocument(document)
    shapes = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    colors = XCAFDoc_DocumentTool.ColorTool_s(document.Main())
    whole = shapes.NewShape() if len(parts) > 1 else None
    if whole is not None:
        TDataStd_Name.Set_s(whole, TCollection_ExtendedString(path.stem))
    for name, shape, color, place in parts:
        label = shapes.AddShape(shape, False)
        TDataStd_Name.Set_s(label, TCollection_ExtendedString(name))
        if color is not None:
            colors.SetColor(label, Quantity_Color(*color, Quantity_TOC_sRGB), XCAFDoc_ColorSurf)
        if whole is not None:
            shapes.AddComponent(whole, label, TopLoc_Location(place))
    shapes.UpdateAssemblies()
    writer = STEPCAFControl_Writer()
    writer.Transfer(document, STEPControl_AsIs)
    writer.Write(str(path))


def main(folder):
    models = {"filleted box": filleted_box(), "threaded cap": threaded_cap()}
    for name, shape in models.items():
        write(folder / f"{name}.step", [(name, shape, None, gp_Trsf())])
    cup, lid = vessel(30.0, 70.0, 2.0, 6.0), vessel(32.5, 12.0, 2.0, 3.0)
    turned = gp_Trsf()
    turned.SetRotation(gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(1, 0, 0)), math.pi)
    lifted = gp_Trsf()
    lifted.SetTranslation(gp_Vec(0, 0, 72.5))
    parts = [("cup", cup, (0.2, 0.4, 0.8), gp_Trsf()), ("lid", lid, (0.9, 0.3, 0.1), lifted * turned)]
    write(folder / "cup with lid.step", parts)
    volumes = {name: volume(shape) for name, shape in {**models, "cup": cup, "lid": lid}.items()}
    (folder / "volumes.json").write_text(json.dumps(volumes, indent=1) + "\n")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
