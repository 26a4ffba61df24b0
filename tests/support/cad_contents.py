"""Small CAD models as text: polyhedra and a cylinder in STEP (AP214), a box of ruled surfaces in IGES."""

import numpy as np

BOX_FACES = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))
_HEAD = """ISO-10303-21;
HEADER;
FILE_DESCRIPTION((''),'2;1');
FILE_NAME('','',(''),(''),'','','');
FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'));
ENDSEC;
DATA;
"""


def box_corners(size, at=(0.0, 0.0, 0.0)):
    """Corners (8, 3) of a box in the order of BOX_FACES."""
    unit = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)])
    return unit * np.asarray(size, dtype=float) + at


def divided_into(V, names=("part",), colors=None):
    """Script of a process that divides any model into a triangle for each part."""
    V, n = np.asarray(V, dtype=float), len(names)
    colors = [[-1, -1, -1]] * n if colors is None else colors
    return f"""
import os, io, sys, numpy as np
packed, part = io.BytesIO(), np.arange({n})
V, F, style = {V.tolist()}, [[0, 1, 2]] + 3 * part[:, None], part
V = np.vstack([np.array(V) * (k + 1) for k in part])
np.savez(packed, V=V, F=F, style=style, names=np.array({list(names)}), part=part, colors={colors})
sys.stdout.buffer.write(packed.getvalue())
"""


class _Step:
    """Entities of a STEP file, numbered as they are added."""

    def __init__(self, unit):
        self.lines = []
        length = self.add(f"(LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT({unit},.METRE.))")
        angle = self.add("(NAMED_UNIT(*) PLANE_ANGLE_UNIT() SI_UNIT($,.RADIAN.))")
        solid = self.add("(NAMED_UNIT(*) SI_UNIT($,.STERADIAN.) SOLID_ANGLE_UNIT())")
        sure = self.add(f"UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-7),{length},'','')")
        self.context = self.add(
            "(GEOMETRIC_REPRESENTATION_CONTEXT(3) "
            f"GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT(({sure})) "
            f"GLOBAL_UNIT_ASSIGNED_CONTEXT(({length},{angle},{solid})) REPRESENTATION_CONTEXT('',''))"
        )

    def add(self, entity):
        self.lines.append(f"#{len(self.lines) + 1}={entity};\n")
        return f"#{len(self.lines)}"

    def triple(self, kind, numbers):
        said = ",".join(f"{float(x):.9E}" for x in numbers)
        return self.add(f"{kind}('',({said}))")

    def vertex(self, point):
        return self.add(f"VERTEX_POINT('',{self.triple('CARTESIAN_POINT', point)})")

    def axes(self, at, normal, along):
        at, normal, along = (
            self.triple("CARTESIAN_POINT", at),
            self.triple("DIRECTION", normal),
            self.triple("DIRECTION", along),
        )
        return self.add(f"AXIS2_PLACEMENT_3D('',{at},{normal},{along})")

    def line(self, a, b, start, end):
        length = np.linalg.norm(np.subtract(b, a))
        way = self.triple("DIRECTION", np.subtract(b, a) / length)
        vector = self.add(f"VECTOR('',{way},1.)")
        curve = self.add(f"LINE('',{self.triple('CARTESIAN_POINT', a)},{vector})")
        return self.add(f"EDGE_CURVE('',{start},{end},{curve},.T.)")

    def face(self, edges, surface):
        """A face within edges, each with whether it is passed forwards."""
        loop = [self.add(f"ORIENTED_EDGE('',*,*,{edge},.{'TF'[not way]}.)") for edge, way in edges]
        bound = self.add(f"FACE_OUTER_BOUND('',{self.add(f'''EDGE_LOOP('',({','.join(loop)}))''')},.T.)")
        return self.add(f"ADVANCED_FACE('',({bound}),{surface},.T.)")

    def solid(self, faces):
        return self.add(f"MANIFOLD_SOLID_BREP('',{self.add(f'''CLOSED_SHELL('',({','.join(faces)}))''')})")

    def text(self, solids):
        app = self.add("APPLICATION_CONTEXT('automotive design')")
        self.add(f"APPLICATION_PROTOCOL_DEFINITION('','automotive_design',2000,{app})")
        product = self.add(
            f"PRODUCT('part','part','',({self.add(f'''PRODUCT_CONTEXT('',{app},'mechanical')''')}))"
        )
        formation = self.add(f"PRODUCT_DEFINITION_FORMATION('','',{product})")
        context = self.add(f"PRODUCT_DEFINITION_CONTEXT('part definition',{app},'design')")
        definition = self.add(f"PRODUCT_DEFINITION('','',{formation},{context})")
        shape = self.add(f"PRODUCT_DEFINITION_SHAPE('','',{definition})")
        placed = [self.axes((0, 0, 0), (0, 0, 1), (1, 0, 0)), *solids]
        drawn = self.add(f"ADVANCED_BREP_SHAPE_REPRESENTATION('',({','.join(placed)}),{self.context})")
        self.add(f"SHAPE_DEFINITION_REPRESENTATION({shape},{drawn})")
        return f"{_HEAD}{''.join(self.lines)}ENDSEC;\nEND-ISO-10303-21;\n".encode()


def step_boxes(*corners, unit=".MILLI."):
    """STEP file of boxes, given by their corners (8, 3)."""
    step = _Step(unit)
    return step.text([_box(step, each) for each in corners])


def _box(step, corners):
    vertices = [step.vertex(point) for point in corners]
    edges, faces = {}, []
    for face in BOX_FACES:
        loop = []
        for a, b in zip(face, (*face[1:], face[0]), strict=True):
            if (b, a) not in edges and (a, b) not in edges:
                edges[a, b] = step.line(corners[a], corners[b], vertices[a], vertices[b])
            loop.append((edges.get((a, b)) or edges[b, a], (a, b) in edges))
        p, q, _, r = corners[list(face)]
        normal = np.cross(q - p, r - p)
        axes = step.axes(p, normal / np.linalg.norm(normal), (q - p) / np.linalg.norm(q - p))
        faces.append(step.face(loop, step.add(f"PLANE('',{axes})")))
    return step.solid(faces)


def step_cylinder(radius, height):
    """STEP file of a cylinder about Z."""
    step = _Step(".MILLI.")
    vertices = [step.vertex((radius, 0.0, z)) for z in (0.0, height)]
    axes = [step.axes((0, 0, z), (0, 0, 1), (1, 0, 0)) for z in (0.0, height)]
    rims = [
        step.add(f"EDGE_CURVE('',{v},{v},{step.add(f'''CIRCLE('',{at},{radius:.9E})''')},.T.)")
        for v, at in zip(vertices, axes, strict=True)
    ]
    seam = step.line((radius, 0, 0), (radius, 0, height), *vertices)
    side = step.add(f"CYLINDRICAL_SURFACE('',{axes[0]},{radius:.9E})")
    down = step.add(f"PLANE('',{step.axes((0, 0, 0), (0, 0, -1), (1, 0, 0))})")
    up = step.add(f"PLANE('',{axes[1]})")
    faces = [
        step.face([(rims[0], True), (seam, True), (rims[1], False), (seam, False)], side),
        step.face([(rims[0], False)], down),
        step.face([(rims[1], True)], up),
    ]
    return step.text([step.solid(faces)])


def iges_box(corners, unit="2,2HMM"):
    """IGES file of the six faces of a box, each a ruled surface between two lines."""
    entities = []
    for a, b, c, d in BOX_FACES:
        for start, end in ((a, b), (d, c)):
            numbers = [f"{x:.6f}" for x in (*corners[start], *corners[end])]
            entities.append((110, ",".join(["110", *numbers]) + ";", 0))
        at = 2 * len(entities) - 3  # directory entry of the first line
        entities.append((118, f"118,{at},{at + 2},0,0;", 1))
    directory, parameters = [], []
    for number, (kind, text, form) in enumerate(entities):
        entry, first = 2 * number + 1, len(parameters) + 1
        rows = [text[k : k + 64] for k in range(0, len(text), 64)]
        parameters += [f"{row:<64}{entry:8d}P" for row in rows]
        used = "00010000" if kind == 110 else "00000000"
        directory.append("".join(f"{x:>8}" for x in (kind, first, 0, 0, 0, 0, 0, 0, used)) + "D")
        directory.append("".join(f"{x:>8}" for x in (kind, 0, 0, len(rows), form, "", "", "", 0)) + "D")
    globals_ = "1H,,1H;,3Hbox,7Hbox.igs,1Ha,1Ha,32,38,6,308,15,3Hbox,1.," + unit + ",1,1.,"
    globals_ = [globals_, "15H20260101.000000,1.E-6,100.,1Ha,1Ha,11,0;"]
    sections = [["box".ljust(72) + "S"], [f"{row:<72}G" for row in globals_], directory, parameters]
    lines = [f"{row}{number:7d}" for rows in sections for number, row in enumerate(rows, start=1)]
    ends = "".join(f"{letter}{len(rows):7d}" for letter, rows in zip("SGDP", sections, strict=True))
    return "\n".join([*lines, f"{ends:<72}T      1", ""]).encode()
