"""Python script reproducing a deformation: open, hold, pose, deform, save."""

import textwrap
from collections.abc import Iterator

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.files.mesh_formats import MESH_FORMATS, WriteSupport
from apd_viewer.geometry.energy.wall_map import WallMap
from apd_viewer.geometry.mesh.mesh import BakedOrigin
from apd_viewer.geometry.pose.constraints import BASE, FREE, HANDLE
from apd_viewer.geometry.pose.held_path import ITERATIONS_A_STEP
from apd_viewer.geometry.solver.settings import DEFAULT_SETTINGS, SETTINGS
from apd_viewer.language import tr
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.document_parts import obstacle_shifts, targets_of
from apd_viewer.session.model.handle_paths import intermediate_documents
from apd_viewer.session.model.named_obstacle import ObstacleKind, plate_extent

_WIDTH = 110
_TARGETS = """
def targets(poses):
    moved = [X @ pose[:3, :3].T + pose[:3, 3] for X, pose in zip(gripped, poses)]
    return np.vstack([base_at, *moved])

"""
_AT_ONCE = """
result = apd_viewer.deform(
    mesh.V, mesh.F, fixed, targets(poses), handle=handles, {settings}{shifts}
)
"""
# A pose determines rotations only up to 180 degrees; larger ones need the path.
_IN_STEPS = """
solver = apd_viewer.Deformation(
    mesh.V, mesh.F, fixed, handle=handles, {settings}
)
for {step} in {way}:
    solver.aim(targets(step){shift})
    for _ in range({iterations}):
        solver.step()
    while solver.is_on_its_way:
        solver.step()
    if solver.share_reached < 1.0:  # contact lets the handles go no farther
        break
else:
    solver.aim(targets(poses){shifts})
for _ in range({most}):
    result = solver.step()
    if solver.settled:
        break
"""


def python_script(document: Document) -> str:
    """Python script of a document's deformation, using the public API.

    Raises
    ------
    InputError
        If the document cannot be deformed, or the public names cannot say it.
    """
    _check(document)
    document = document.relative_to_rest
    handles = [k for k in range(len(document.handles)) if document.label_counts[HANDLE + k]]
    lines = [
        "import numpy as np",
        "",
        "import apd_viewer",
        "",
        f"mesh = apd_viewer.open_mesh({str(document.mesh.path)!r})",
        *_assignment_lines("base", _ids(np.flatnonzero(document.labels == BASE))),
        "handles = [",
        *(line for k in handles for line in _handle(document, k)),
        "]",
        "fixed = np.concatenate([base, *handles])",
        *_initial_position_lines(document, handles),
        *_assignment_lines("poses", _poses(document, handles)),
        *_regions(document),
        *obstacle_lines(document),
        *(
            _assignment_lines("shifts", _array(obstacle_shifts(document)))
            if document.has_active_obstacles
            else ()
        ),
        _TARGETS.rstrip(),
        *_deform_lines(document, handles),
        f"apd_viewer.save_mesh(mesh, result.U, {_target(document)!r})",
    ]
    return "\n".join(lines) + "\n"


def _check(document: Document) -> None:
    if document.paint_problem:
        raise InputError(document.paint_problem)
    mesh = document.mesh
    if mesh.path is None or isinstance(mesh.origin, BakedOrigin):
        raise InputError(
            tr("The rest shape is not in a file; reset the handles, export the mesh and open the file.")
        )
    if any(handle.falloff for handle in document.handles):
        raise InputError(tr("Python lines cannot express a falloff; save the session and replay it."))
    if isinstance(document.settings.effective_settings.wall_thickness, WallMap):
        raise InputError(tr("Python lines cannot hold a wall distribution; save the session and replay it."))


def _target(document: Document) -> str:
    suffix = document.mesh.path.suffix.lower() if document.mesh.path else ""
    kind = MESH_FORMATS.get(suffix)
    is_written = kind is not None and kind.writing is not WriteSupport.NONE
    return f"{document.mesh.stem}-deformed{suffix if is_written else '.obj'}"


def _assignment_lines(name: str, value: str) -> list[str]:
    """Lines of an assignment, wrapped inside the brackets of its value."""
    return textwrap.wrap(
        f"{name} = {value}", _WIDTH, subsequent_indent="    ", break_long_words=False, break_on_hyphens=False
    )


def _ids(ids: np.ndarray) -> str:
    """Python expression of ascending ids as ranges."""
    ends = np.flatnonzero(np.diff(ids) != 1) + 1
    runs = np.split(ids, ends)
    said = (f"{run[0]}:{run[-1] + 1}" if len(run) > 2 else ", ".join(map(str, run)) for run in runs)
    return f"np.r_[{', '.join(said)}]" if len(ids) else "np.array([], dtype=int)"


def _handle(document: Document, k: int) -> Iterator[str]:
    ids = _ids(np.flatnonzero(document.labels == HANDLE + k))
    yield f"    # {' '.join(document.handles[k].name.split())}"
    yield from textwrap.wrap(f"{ids},", _WIDTH, initial_indent="    ", subsequent_indent="        ")


def _regions(document: Document) -> Iterator[str]:
    regions = targets_of(document).regions
    if not regions:
        return
    yield "regions = ["
    for region in regions:
        yield f"    apd_viewer.Region(\n        {region.name!r},"
        ids = f"{_ids(region.vertices)},"
        yield from textwrap.wrap(ids, _WIDTH, initial_indent=" " * 8, subsequent_indent=" " * 12)
        yield f"        {region.area!r},\n    ),"
    yield "]"


def _initial_position_lines(document: Document, handles: list[int]) -> Iterator[str]:
    """Lines with the initial positions of base and handles."""
    V, initial = document.mesh.V, document.initial_positions
    held = document.labels != FREE
    if np.array_equal(V[held], initial[held]):
        yield "base_at, gripped = mesh.V[base], [mesh.V[ids] for ids in handles]"
        return
    # Painted on a deformed shape: the initial positions have to be written out.
    yield from _assignment_lines("base_at", _array(initial[document.labels == BASE]))
    each = ", ".join(_array(initial[document.labels == HANDLE + k]) for k in handles)
    yield from _assignment_lines("gripped", f"[{each}]")


def _array(X: np.ndarray) -> str:
    return f"np.array({X.tolist()!r})"


def _poses(document: Document, handles: list[int]) -> str:
    return f"[{', '.join(_array(document.handles[k].pose) for k in handles)}]"


def _deform_lines(document: Document, handles: list[int]) -> Iterator[str]:
    settings = settings_arguments(document)
    pushes = document.has_active_obstacles
    shifts = ", shifts=shifts" if pushes else ""
    if not document.has_half_turn:
        yield _AT_ONCE.format(settings=settings, shifts=shifts).rstrip()
        return
    yield ""
    yield "# A turn of more than 180 degrees goes in steps."
    steps = list(intermediate_documents(document))
    yield from _assignment_lines("way", f"[{', '.join(_poses(step, handles) for step in steps)}]")
    if pushes:
        yield from _assignment_lines(
            "shifts_on_the_way", _array(np.array([obstacle_shifts(step) for step in steps]))
        )
    yield _IN_STEPS.format(
        settings=settings,
        shifts=shifts,
        step="step, shift" if pushes else "step",
        way="zip(way, shifts_on_the_way)" if pushes else "way",
        shift=", shifts=shift" if pushes else "",
        iterations=ITERATIONS_A_STEP,
        most=document.settings.convergence.most_iterations,
    ).strip("\n")


def obstacle_lines(document: Document) -> Iterator[str]:
    """Script lines defining the obstacles; none if no obstacle is active."""
    if not document.has_active_obstacles:
        return
    yield "obstacles = ["
    for obstacle, solid in zip(document.obstacles, document.active_obstacles, strict=True):
        yield f"    # {' '.join(obstacle.name.split())}"
        if obstacle.kind is ObstacleKind.PLATE:
            size = plate_extent(obstacle, document.mesh.V)
            given = f"plate({obstacle.place.tolist()!r}, {obstacle.axis.tolist()!r}, {size!r})"
        else:
            kind = "sphere" if obstacle.kind is ObstacleKind.SPHERE else "capsule"
            given = f"{kind}({', '.join(map(repr, solid.points.tolist()))}, {solid.radius!r})"
        yield f"    apd_viewer.{given},"
    yield "]"


def settings_arguments(document: Document) -> str:
    """Keyword arguments for method, settings and targets."""
    settings, targets = document.settings, targets_of(document)
    idle = {"hold_area"}  # "hold_area" is omitted: for "local", a total-area target implies it
    if settings.convergence == DEFAULT_SETTINGS.convergence:
        idle.add("convergence")
    given = {**vars(settings), **targets._asdict()}
    words = [
        f"{name}={given[name]!r}"
        for name, setting in SETTINGS.items()
        if given[name] is not None and setting.applies(settings) and name not in idle
    ]
    if document.immobile_components:
        words.append(f"loose={list(document.immobile_components)!r}")
    if document.has_active_obstacles:
        words.append("obstacles=obstacles")
    if document.mesh.has_welded_seams:
        words.append("weld=True")
    if targets.regions:
        words.append("regions=regions")
    return ", ".join(words).replace("convergence=", "convergence=apd_viewer.")
