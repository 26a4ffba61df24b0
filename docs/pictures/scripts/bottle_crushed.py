"""The sample bottle at rest, twisted by half a turn, and pressed flat: the three commands of the page."""

from pathlib import Path

from stage import Stage

from apd_viewer.__main__ import main
from apd_viewer.figures.rendered_pictures import Picture, draw_shapes
from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.files.samples import resource_path
from apd_viewer.presentation.palette import label_colors


def draw(stage: Stage) -> Path:
    """Run the commands, and draw their meshes side by side."""
    mesh, labels = stage.sample("bottle")
    rest, selection = stage.folder / "bottle.obj", stage.folder / "bottle.sel"
    save_mesh(mesh, mesh.V, rest)
    selection.write_text("\n".join(map(str, labels.tolist())) + "\n", encoding="utf-8")
    transform = resource_path("bottle-twist-60.def" if stage.quick else "bottle-twist-180.def")
    twisted, crushed = stage.folder / "twisted.obj", stage.folder / "crushed.obj"
    held = ["--selection", str(selection), "--transform", str(transform)]
    apart = ["--contact", "--thickness", "0.03"]
    assert main(["deform", str(rest), *held, *apart, "-o", str(twisted)]) == 0
    steps = ["--to", "95%", "--steps", "1"] if stage.quick else ["--to", "50%", "--steps", "5"]
    wall = ["--unit", "cm", "--material", "pet-bottle", "--thickness", "0.3mm"]
    press = ["press", str(twisted), "--axis", "x", *steps, "--stiffness", "0.001", *wall]
    assert main([*press, "-o", str(crushed)]) == 0
    path = stage.folder / "crushed.png"
    shapes = [mesh.V, open_mesh(twisted).V, open_mesh(crushed).V]
    picture = Picture(
        path, shapes, [["At rest"], ["Twisted by 180°"], ["Pressed to a half"]], [label_colors(labels)]
    )
    drawn = draw_shapes(mesh, [picture], (1600, 1000))
    assert drawn or stage.quick
    return path
