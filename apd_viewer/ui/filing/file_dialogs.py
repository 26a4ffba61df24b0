"""Dialogs to choose files, and the About box."""

from collections.abc import Sequence
from pathlib import Path

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QFileDialog, QInputDialog, QMessageBox, QWidget

from apd_viewer.files.mesh_formats import CAD_FORMATS, MESH_FORMATS, POINT_CACHES, SERIES, WRITABLE_FORMATS
from apd_viewer.files.mesh_writing import dropped_contents
from apd_viewer.files.scalar_files import ScalarRows
from apd_viewer.geometry.mesh.arrays import diagonal
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.installation import program_version
from apd_viewer.language import comma_separated, tr
from apd_viewer.session.model.view import SESSION_SUFFIX
from apd_viewer.session.quantities.wall_distribution import DISTRIBUTION_SUFFIXES

_MESHES = " ".join("*" + suffix for suffix in (*MESH_FORMATS, *CAD_FORMATS))
_ANIMATIONS = " ".join("*" + suffix for suffix in (SERIES, *POINT_CACHES))
_OPEN_FILTER = tr("Meshes, animations and sessions ({endings})").format(
    endings=f"{_MESHES} {_ANIMATIONS} *.apd"
)
_MESH_FILTER = tr("Meshes ({endings})").format(endings=_MESHES)
_WITHOUT, _WITH = tr("Session (*.apd)"), tr("Session including the mesh (*.apd)")
_IMAGES = tr("Images ({endings})").format(endings="*.png *.jpg *.jpeg *.webp *.tif *.tiff *.bmp")
_DISTRIBUTIONS = " ".join("*" + suffix for suffix in DISTRIBUTION_SUFFIXES)
_EDGE, _DECIMALS = 1 / 60, 4  # proposed edge length, in diagonals, and its decimals
_MOST_TRIANGLES = 2_000_000
_ICON = 64  # px; icon in the About box
SELECTION_FORMATS = (".json", ".npz", ".ply", ".sel", ".dmat")
_SELECTIONS = tr("Selections ({endings})").format(
    endings=" ".join("*" + suffix for suffix in SELECTION_FORMATS)
)


def ask_for_mesh(parent: QWidget, folder: Path) -> Path | None:
    """Ask for a mesh or session to open; None if cancelled."""
    path, _ = QFileDialog.getOpenFileName(parent, tr("Open a mesh or a session"), str(folder), _OPEN_FILTER)
    return Path(path) if path else None


def ask_for_target_shape(parent: QWidget, folder: Path) -> Path | None:
    """Ask for a mesh file as target shape; None if cancelled."""
    path, _ = QFileDialog.getOpenFileName(parent, tr("Load target shape"), str(folder), _MESH_FILTER)
    return Path(path) if path else None


def ask_for_image(parent: QWidget, folder: Path) -> Path | None:
    """Ask for an image file; None if cancelled."""
    path, _ = QFileDialog.getOpenFileName(parent, tr("Picture on a region"), str(folder), _IMAGES)
    return Path(path) if path else None


def ask_for_wall_distribution(parent: QWidget, folder: Path) -> Path | None:
    """Ask for a file of a wall distribution; None if cancelled."""
    kinds = tr("Wall distributions ({endings})").format(endings=_DISTRIBUTIONS)
    path, _ = QFileDialog.getOpenFileName(parent, tr("Thickness from file"), str(folder), kinds)
    return Path(path) if path else None


def ask_where_to_save_session(parent: QWidget, folder: Path, mesh: Mesh) -> tuple[Path, bool] | None:
    """Ask for a session file to write, and whether to embed the mesh."""
    path, chosen = QFileDialog.getSaveFileName(
        parent, tr("Save session"), str(folder / f"{mesh.stem}.apd"), f"{_WITHOUT};;{_WITH}", _WITHOUT
    )
    if not path:
        return None
    target = (
        Path(path) if path.lower().endswith(SESSION_SUFFIX) else _confirmed_path(parent, path, SESSION_SUFFIX)
    )
    return None if target is None else (target, chosen == _WITH)


def ask_for_selection(parent: QWidget, folder: Path) -> Path | None:
    """Ask for a selection file to load; None if cancelled."""
    path, _ = QFileDialog.getOpenFileName(parent, tr("Load selection"), str(folder), _SELECTIONS)
    return Path(path) if path else None


def ask_where_to_save_selection(parent: QWidget, folder: Path, mesh: Mesh) -> Path | None:
    """Ask where to save a selection; None if cancelled."""
    proposed = folder / f"{mesh.stem}-selection.json"
    return ask_for_format(parent, tr("Save selection"), proposed, SELECTION_FORMATS)


def ask_for_format(parent: QWidget, title: str, proposed: Path, kinds: Sequence[str]) -> Path | None:
    """Ask for a path with the suffix of one of several formats; None if cancelled."""
    filters = {kind: f"{kind[1:].upper()} (*{kind})" for kind in kinds}
    path, chosen = QFileDialog.getSaveFileName(parent, title, str(proposed), ";;".join(filters.values()))
    if not path or Path(path).suffix.lower() in kinds:
        return Path(path) if path else None
    return _confirmed_path(parent, path, next(kind for kind, name in filters.items() if name == chosen))


def ask_how_to_remesh(parent: QWidget, folder: Path, mesh: Mesh, area: float) -> tuple[Path, float] | None:
    """Ask for a file for even triangles, and for their edge length, mesh units."""
    size, least = diagonal(mesh.V), (area / _MOST_TRIANGLES) ** 0.5
    title, label = tr("Remesh"), tr("Length of the edges, in units of the mesh:")
    usual = max(_EDGE * size, least)
    edge, is_given = QInputDialog.getDouble(parent, title, label, usual, least, size, _DECIMALS)
    proposed = folder / f"{mesh.stem}-even.obj"
    path = ask_for_format(parent, title, proposed, tuple(WRITABLE_FORMATS)) if is_given else None
    return None if path is None else (path, edge)


def ask_where_to_save_mesh(parent: QWidget, folder: Path, mesh: Mesh) -> Path | None:
    """Ask for a file for the deformed mesh, confirming overwrite and data loss."""
    suffix = mesh.origin.suffix if mesh.origin else ".obj"
    filters = {kind: f"{kind[1:].upper()} (*{kind})" for kind in dict.fromkeys([suffix, *WRITABLE_FORMATS])}
    path, chosen = QFileDialog.getSaveFileName(
        parent,
        tr("Export deformed mesh"),
        str(folder / f"{mesh.stem}-deformed{suffix}"),
        ";;".join(filters.values()),
        filters[suffix],
    )
    if not path:
        return None
    target: Path | None = Path(path)
    if Path(path).suffix.lower() not in (*MESH_FORMATS, *CAD_FORMATS):
        target = _confirmed_path(parent, path, next(kind for kind, name in filters.items() if name == chosen))
    return target if target and _accepts_loss(parent, mesh, target) else None


def ask_where_to_save_scalars(parent: QWidget, folder: Path, mesh: Mesh) -> tuple[Path, ScalarRows] | None:
    """Ask where to save the scalars, and whether a row is a vertex or a triangle."""
    filters = {
        tr("PLY with scalars of vertices and faces (*.ply)"): (".ply", ScalarRows.VERTICES),
        tr("CSV with a row per vertex (*.csv)"): (".csv", ScalarRows.VERTICES),
        tr("CSV with a row per triangle (*.csv)"): (".csv", ScalarRows.TRIANGLES),
    }
    path, chosen = QFileDialog.getSaveFileName(
        parent, tr("Export scalars"), str(folder / f"{mesh.stem}-scalars.ply"), ";;".join(filters)
    )
    if not path:
        return None
    suffix, rows = filters.get(chosen, (".ply", ScalarRows.VERTICES))
    target = Path(path) if path.lower().endswith((".ply", ".csv")) else _confirmed_path(parent, path, suffix)
    return None if target is None else (target, rows)


def _accepts_loss(parent: QWidget, mesh: Mesh, target: Path) -> bool:
    """True if the target format loses no data, or the user accepts the loss."""
    lost = dropped_contents(mesh, target)
    if not lost:
        return True
    named = lost[0]
    if len(lost) > 1:
        named = tr("{several} and {last}").format(several=comma_separated(lost[:-1]), last=lost[-1])
    kind, own = target.suffix[1:].upper(), mesh.origin.suffix[1:].upper() if mesh.origin else ""
    buttons = QMessageBox.StandardButton
    answer = QMessageBox.question(
        parent,
        tr("Export as {kind}?").format(kind=kind),
        tr("Exporting {name} as {kind} loses its {named}. Exporting as {own} loses nothing.").format(
            kind=kind, name=mesh.name, named=named, own=own
        ),
        buttons.Save | buttons.Cancel,
        buttons.Save,
    )
    return answer == buttons.Save


def _confirmed_path(parent: QWidget, path: str, suffix: str) -> Path | None:
    """Path with the chosen format's suffix; None if an overwrite is declined."""
    target = Path(path + suffix)
    buttons = QMessageBox.StandardButton
    if not target.exists():
        return target
    question = tr("{name} already exists. Replace it?").format(name=target.name)
    answer = QMessageBox.question(parent, tr("Replace file?"), question, buttons.Yes | buttons.No, buttons.No)
    return target if answer == buttons.Yes else None


def ask_where_to_save_report(parent: QWidget, folder: Path, mesh: Mesh) -> Path | None:
    """Ask for a report file to write; None if cancelled."""
    return ask_where_to_save(parent, tr("Save report"), folder / f"{mesh.stem}-report.html")


def ask_where_to_save_deck(parent: QWidget, folder: Path, mesh: Mesh) -> Path | None:
    """Ask for an FE deck to write; None if cancelled."""
    return ask_where_to_save(parent, tr("Export FE deck"), folder / f"{mesh.stem}.inp")


def ask_where_to_save_picture(parent: QWidget, folder: Path, mesh: Mesh) -> Path | None:
    """Ask for a picture file to write; None if cancelled."""
    return ask_where_to_save(parent, tr("Save picture"), folder / f"{mesh.stem}.png")


def ask_where_to_save(parent: QWidget, title: str, proposed: Path) -> Path | None:
    """Ask for a path with the suffix of ``proposed``; None if cancelled."""
    suffix = proposed.suffix
    path, _ = QFileDialog.getSaveFileName(parent, title, str(proposed), f"{suffix[1:].upper()} (*{suffix})")
    if not path or path.lower().endswith(suffix):
        return Path(path) if path else None
    return _confirmed_path(parent, path, suffix)


def show_about_box(parent: QWidget) -> None:
    """Show version, method, libraries and licence of the program."""
    box = QMessageBox(parent, windowTitle=tr("About APD Viewer"), textFormat=Qt.TextFormat.RichText)
    box.setIconPixmap(parent.windowIcon().pixmap(_ICON))
    box.setText(
        tr(
            "<h3>APD Viewer {version}</h3>"
            "<p>Area-preserving deformation of 3D objects, after the method of Li and Hui.</p>"
            "<p>Built on NumPy, SciPy, Numba, cholespy, fast-simplification, trimesh, PyVista and "
            "Qt for Python. MIT licence.</p>"
        ).format(version=program_version())
    )
    box.exec()
    box.deleteLater()
