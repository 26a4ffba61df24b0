"""The list of the gallery: what is shown, in words, files and code."""

from __future__ import annotations

import sample_files as files
import special_states as states
from entry import Entry

_HELD = """mesh = apd_viewer.open_mesh("bottle.obj")
base, neck = np.flatnonzero(mesh.V[:, 1] < 1.2), np.flatnonzero(mesh.V[:, 1] > 18.7)
"""
_FRONT = (-0.35, 0.22, 1.0)

BOTTLES = (
    Entry(
        "bottle_twisted",
        "Wrung out",
        "Half a turn, wall against wall: the area is kept exactly, and no wall passes through another.",
        "apd-viewer deform bottle.obj --selection bottle.sel --twist 180deg --contact -o twisted.obj",
    ),
    Entry(
        "bottle_twisted_wall",
        "Twisted by 120°, thin wall",
        "An elastic wall of 0.3 mm buckles into sharp helical ridges; where it touches itself, contact keeps it apart.",
        "apd-viewer deform bottle.obj --selection bottle.sel --transform bottle-twist-120.def "
        "--method wall --wall-thickness 0.03 --poisson 0.38 --contact -o twisted.obj",
        files.turned_bottle,
    ),
    Entry(
        "bottle_pushed",
        "Pushed from above",
        "The cap is pushed down by 30 % of its distance from the base; the shoulder sinks in around it.",
        "apd-viewer deform bottle.obj --selection bottle.sel --push 30% --stiffness 0.001 --contact -o pushed.obj",
    ),
    Entry(
        "bottle_bent",
        "Bent by the neck",
        "The neck turns about an axis through the base, and the ribs open on one side.",
        'apd-viewer deform bottle.obj --selection bottle.sel --bend "35deg about z" -o bent.obj',
    ),
    Entry(
        "bottle_pressed",
        "Pressed between plates",
        "PET of 0.3 mm, which bends, stretches and creases, with loads in newtons. With `--figure` the command also draws them.",
        "apd-viewer press bottle.obj --axis x --to 40% --steps 20 --unit cm --material pet-bottle "
        "--thickness 0.3mm -o pressed.obj",
        state=states.pressed_bottle,
        look=(0.9, 0.25, 0.6),
        steps=(("--to 40% --steps 20", "--to 97% --steps 1"),),
    ),
    Entry(
        "bottle_label",
        "A label keeps its area",
        "The paper label neither stretches nor shrinks, whatever the wall around it does.",
        _HELD + 'M = np.loadtxt("bottle-twist-120.def")\n'
        'label = apd_viewer.Region("Label", np.flatnonzero(abs(mesh.V[:, 1] - 11) < 2.6), area=100)\n'
        "result = apd_viewer.deform(mesh.V, mesh.F, np.r_[base, neck], "
        "np.vstack([mesh.V[base], mesh.V[neck] @ M[:3, :3].T + M[:3, 3]]), handle=neck, regions=[label])",
        files.labelled_bottle,
        as_command="apd-viewer deform bottle.obj --selection bottle.sel --transform bottle-twist-120.def "
        "--region Label label.sel 100 -o label.obj",
    ),
    Entry(
        "bottle_blown_up",
        "A target for the volume",
        "12 % more volume in a wall of the same area: the ribs unfold.",
        'apd-viewer deform bottle.obj --selection bottle.sel --move "0 0 0" --volume 112 -o full.obj',
    ),
    Entry(
        "bottle_grown",
        "A target for the area",
        "Five percent more wall around the same volume: it wrinkles, as stiffly as you say.",
        'apd-viewer deform bottle.obj --selection bottle.sel --move "0 0 0" '
        "--area 105 --volume 100 --stiffness 0.0005 -o grown.obj",
    ),
    Entry(
        "bottle_stiff",
        "Stiffness",
        "The bend of “Bent by the neck” in a stiffer wall: it spreads over the whole height.",
        'apd-viewer deform bottle.obj --selection bottle.sel --bend "35deg about z" --stiffness 0.01 -o stiff.obj',
    ),
    Entry(
        "bottle_finger",
        "A finger dents the side",
        "A round-ended cylinder pushes by contact, without friction, while base and cap are held.",
        'apd-viewer deform bottle.obj --selection bottle.sel --move "0 0 0" '
        "--obstacles finger.json --stiffness 0.001 -o dented.obj",
        files.bottle_and_finger,
        look=(0.8, 0.3, 0.8),
    ),
    Entry(
        "bottle_baked",
        "Bake and go on",
        "The twisted bottle becomes the rest shape of the next deformation, and is bent from there.",
        _HELD + "turned = mesh.V[neck] * [-1, 1, -1]  # by half a turn\n"
        "first = apd_viewer.deform(mesh.V, mesh.F, np.r_[base, neck], "
        "np.vstack([mesh.V[base], turned]), handle=neck)\n"
        "result = apd_viewer.deform(first.U, mesh.F, np.r_[base, neck], "
        "np.vstack([mesh.V[base], turned + [5, -1, 0]]), handle=neck)",
        state=states.baked_bottle,
    ),
)

FABRICS = (
    Entry(
        "cushion_pressed",
        "A silk cushion, pressed",
        "A palm presses the cushion. Every triangle of the cover keeps its area, so the silk wrinkles around it.",
        'apd-viewer deform cushion.obj --selection cushion.sel --move "0 -5 0" '
        "--method local --area 100 --area-stiffness 100 --stiffness 0.001 -o pressed.obj",
        files.cushion,
        look=(0.4, 0.55, 0.9),
    ),
    Entry(
        "cushion_full",
        "The same cushion, full of air",
        "With its volume kept, the sides bulge: the air goes where the palm is not.",
        'apd-viewer deform cushion.obj --selection cushion.sel --move "0 -5 0" '
        "--method local --area 100 --area-stiffness 100 --stiffness 0.001 --volume 100 -o bulging.obj",
        files.cushion,
        look=(0.4, 0.55, 0.9),
    ),
    Entry(
        "pillow_pressed",
        "An empty pillow, filled and pressed",
        "Two squares of cloth, sewn at their rims, are filled with five litres and pressed to half of their height. "
        "Area and volume are exact at every step.",
        "apd-viewer press pillow.obj --axis y --to 50% --steps 5 --unit cm --volume 5l "
        "--method local --area 100 --area-stiffness 100 --stiffness 0.0001 -o pressed.obj",
        files.pillow,
        state=states.pressed_pillow,
        look=(0.45, 0.4, 0.9),
        steps=(("--to 50% --steps 5", "--to 97% --steps 1"),),
    ),
    Entry(
        "cloth_folded",
        "A cloth, folded",
        "Half a turn about a line lays one end of the cloth over the other; contact keeps the layers apart.",
        "apd-viewer deform cloth.obj --selection cloth.sel --transform cloth-fold.def "
        "--method local --area-stiffness 300 --stiffness 0.0002 --contact -o folded.obj",
        files.cloth,
        look=(0.75, 0.5, 0.8),
    ),
    Entry(
        "cloth_gathered",
        "A cloth, gathered",
        "Both ends come nearer: cloth cannot be pressed together, so it rises in waves.",
        "apd-viewer deform cloth.obj --selection cloth.sel --push 22% "
        "--method local --area-stiffness 300 --stiffness 0.0005 -o gathered.obj",
        files.cloth,
        look=(0.75, 0.4, 0.8),
    ),
    Entry(
        "cloth_wrung",
        "A cloth, wrung",
        "One end makes half a turn and comes a little nearer: the cloth between is wound like a screw.",
        'apd-viewer deform cloth.obj --selection cloth.sel --turn "180deg about z" --push 6% '
        "--method local --area-stiffness 300 --stiffness 0.0005 -o wrung.obj",
        files.cloth,
        look=(0.8, 0.4, 0.75),
    ),
)

ANIMALS = (
    Entry(
        "duck_paper",
        "The duck of the paper",
        "The tail moves up and forwards as in Li and Hui's tables, by their method: the handle drifts a little.",
        "apd-viewer deform duck.obj --selection duck.sel --transform duck-bend-030.def --method paper -o bent.obj",
        files.duck,
        look=_FRONT,
    ),
    Entry(
        "duck_methods",
        "One pose, four methods",
        "The same bend by every method; the loop prints what each does to the area.",
        'mesh, M = apd_viewer.open_mesh("duck.obj"), np.loadtxt("duck-bend-030.def")\n'
        'labels = np.loadtxt("duck.sel", dtype=int)\n'
        "fixed, tail = np.flatnonzero(labels != 1), np.flatnonzero(labels == 2)\n"
        "targets = np.where(np.isin(fixed, tail)[:, None], mesh.V[fixed] @ M[:3, :3].T + M[:3, 3], mesh.V[fixed])\n"
        'for name in ("arap", "paper", "exact", "local"): result = apd_viewer.deform('
        "mesh.V, mesh.F, fixed, targets, name, handle=tail); print(name, result.area_error, result.local_change)",
        files.duck,
        as_command="apd-viewer deform duck.obj --selection duck.sel --transform duck-bend-030.def "
        "--method local -o bent.obj",
        look=_FRONT,
    ),
    Entry(
        "animal_posed",
        "Two hands on an animal",
        "Head and tail are handles of their own, and turn at the same time; the feet stand.",
        'apd-viewer deform animal.obj --selection animal.sel --turn "35deg about y" --move "0 -1 2" '
        '--handle 2 --turn "40deg about z" --move "2 3 0" -o posed.obj',
        files.animal,
        look=(0.35, 0.3, 1.0),
    ),
    Entry(
        "animal_rears",
        "Symmetric posing",
        "Both fore paws rise by mirrored motions, as with Symmetric in the window.",
        'apd-viewer deform animal.obj --selection animal.sel --move "3 7 -1.5" '
        '--handle 2 --move "3 7 1.5" -o rears.obj',
        files.animal_paws,
        look=(0.55, 0.3, 1.0),
    ),
    Entry(
        "animal_calm",
        "Calm parts stay calm",
        "The head is stretched forwards; trunk and legs, which the handle hardly reaches, keep their area.",
        'apd-viewer deform animal.obj --selection animal.sel --move "5 2 0" -o stretched.obj',
        files.animal_head,
        look=(0.2, 0.25, 1.0),
    ),
    Entry(
        "animal_eyes",
        "Loose parts go along",
        "The eyes are not connected with the head; they ride on it as rigid bodies.",
        'apd-viewer deform animal.obj --selection animal.sel --turn "-40deg about y" -o looks.obj',
        files.animal_with_eyes,
        look=(0.7, 0.35, 0.9),
    ),
)

HARD_CASES = (
    Entry(
        "defects",
        "A mesh that is not clean",
        "A hole, a fin, a crack, a doubled face and a stray vertex: the mesh check lists them, and it bends all the same.",
        'apd-viewer deform unclean.obj --selection unclean.sel --bend "25deg about z" -o bent.obj',
        files.unclean,
        look=(0.5, 0.25, 0.9),
    ),
    Entry(
        "scan",
        "A scan with holes",
        "Bumpy, noisy, open below and torn in three places: twisted with its area kept.",
        "apd-viewer deform scan.obj --selection scan.sel --twist 70deg -o twisted.obj",
        files.scan,
        look=(0.4, 0.25, 0.9),
    ),
    Entry(
        "falloff",
        "Falloff",
        "A single vertex raises a smooth bump, by springs that reach seven centimetres; the session has this falloff.",
        "apd-viewer replay falloff.apd --from-rest -o bump.obj",
        states.falloff_session,
        state=states.falloff,
        look=(0.5, 0.5, 0.9),
    ),
    Entry(
        "can_creased",
        "A can keeps its creases",
        "Pressed to half of its width and released: what is bent beyond the yield radius keeps a crease.",
        "apd-viewer press can.obj --axis x --to 50% --steps 5 --stiffness 0.003 "
        "--yield-radius 15 --release -o creased.obj",
        files.can,
        state=states.creased_can,
        steps=(("--to 50% --steps 5", "--to 97% --steps 1"),),
    ),
    Entry(
        "large",
        "A large mesh",
        "Ten times as many vertices as the others here; coarse copies lead the way. The session has a coarser mesh, to be small.",
        'apd-viewer deform animal.obj --selection animal.sel --turn "45deg about y" -o turned.obj',
        files.large,
        state=states.large_animal,
        look=(0.5, 0.3, 1.0),
    ),
)

SCRIPTS = (
    Entry(
        "notebook",
        "Five lines of a notebook",
        "Open, hold, move, deform, save: the file that is written differs from the one opened in its coordinates only.",
        _HELD + "targets = np.vstack([mesh.V[base], mesh.V[neck] + [4, 0, 0]])\n"
        "result = apd_viewer.deform(mesh.V, mesh.F, np.r_[base, neck], targets, handle=neck)\n"
        'apd_viewer.save_mesh(mesh, result.U, "leaning.obj")',
        as_command='apd-viewer deform bottle.obj --selection bottle.sel --move "4 0 0" -o leaning.obj',
    ),
    Entry(
        "measured",
        "Lengths over a surface",
        "The shortest path from cap to base over the bent wall, and the girth at half height.",
        _HELD + "result = apd_viewer.deform(mesh.V, mesh.F, np.r_[base, neck], "
        "np.vstack([mesh.V[base], mesh.V[neck] + [3, -2, 0]]), handle=neck)\n"
        "path = apd_viewer.geodesic_path(result.U, mesh.F, int(base[0]), int(neck[0]))\n"
        "print(np.linalg.norm(np.diff(path, axis=0), axis=1).sum(), "
        "apd_viewer.plane_section(result.U, mesh.F, (0, 10, 0), (0, 1, 0)).length)",
        as_command='apd-viewer deform bottle.obj --selection bottle.sel --move "3 -2 0" -o turned.obj',
    ),
    Entry(
        "batch",
        "A batch",
        "Every mesh of a folder, with the same motion.",
        'for path in sorted(Path().glob("bottle*.obj")):\n'
        "    mesh = apd_viewer.open_mesh(path)\n"
        "    fixed = np.flatnonzero((mesh.V[:, 1] < 1.2) | (mesh.V[:, 1] > 18.7))\n"
        "    targets = mesh.V[fixed] + np.where(mesh.V[fixed, 1:2] > 10, [0, -3, 0], 0)\n"
        "    result = apd_viewer.deform(mesh.V, mesh.F, fixed, targets, stiffness=0.001)",
        files.two_bottles,
        as_command='apd-viewer deform bottle.obj --selection bottle.sel --move "0 -3 0" '
        "--stiffness 0.001 -o shorter.obj",
    ),
    Entry(
        "sweep",
        "A sweep",
        "Half a turn in twelve steps, each shape from the one before: the curves show where the wall buckles.",
        "apd-viewer sweep bottle.obj --selection bottle.sel --twist 180deg --steps 12 -o sweep",
        state=states.swept_bottle,
        figure="sweep/sweep.png",
        steps=(("--steps 12", "--steps 2 --iterations 20 --methods exact"),),
    ),
    Entry(
        "film",
        "A film",
        "A sweep as an animation: by its ending a GIF, morph targets (.glb) or a point cache for Blender (.pc2).",
        "apd-viewer sweep bottle.obj --selection bottle.sel --twist 120deg --steps 10 "
        "--methods arap,exact,local -o sweep --animation twist.gif",
        state=states.filmed_bottle,
        figure="twist.gif",
        steps=(
            ("--steps 10", "--steps 1 --iterations 20"),
            ("arap,exact,local", "local"),
            ("twist.gif", "twist.glb"),
        ),
    ),
    Entry(
        "study",
        "A study",
        "Twist and push vary together, in a Latin hypercube; the results are a table, for any plot.",
        "apd-viewer study design --mesh bottle.obj --selection bottle.sel --vary twist=0..120deg "
        "--vary push=0..30% --set steps=4 --samples 12 --seed 1 -o plan.csv\n"
        "apd-viewer study plan.csv -o results --processes 2",
        state=states.studied_bottle,
        steps=(("--samples 12", "--samples 2"), ("steps=4", "steps=1"), ("--processes 2", "--processes 1")),
    ),
)

GROUPS = {
    "Bottles": BOTTLES,
    "Fabric": FABRICS,
    "Animals": ANIMALS,
    "Hard cases": HARD_CASES,
    "Scripts, sweeps and studies": SCRIPTS,
}
ENTRIES = {entry.name: entry for entries in GROUPS.values() for entry in entries}
