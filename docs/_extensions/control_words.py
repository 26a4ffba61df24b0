"""Words about controls that the window itself does not say: groups, and sentences where there is no tip."""

from __future__ import annotations

from typing import NamedTuple


class Group(NamedTuple):
    """Controls that stand together: path, part of the window, heading and first sentence."""

    path: tuple[str, ...]
    part: str
    title: str
    lead: str


_PANEL, _VIEW, _BELOW, _DIALOGS = "Side panel", "Over the view", "Around the view", "Dialogs"

GROUPS = (
    Group(
        ("panel", "area"),
        _PANEL,
        "Area",
        "The total area, its change from rest, and its target. "
        "See [Choose method, targets and stiffness](../howto/targets.md).",
    ),
    Group(
        ("panel", "volume"),
        _PANEL,
        "Volume",
        "The enclosed volume and its target, and whether the surface crosses or touches itself. "
        "See [Read the panel and measure](../howto/measure.md).",
    ),
    Group(
        ("panel", "measures"),
        _PANEL,
        "Size and mass",
        "Boxes around the shape, and its mass as a wall. "
        "See [Read the panel and measure](../howto/measure.md).",
    ),
    Group(
        ("panel", "handles"),
        _PANEL,
        "Handles",
        "The parts that you move, one row for each. See [Move handles](../howto/move.md).",
    ),
    Group(
        ("panel", "obstacles"),
        _PANEL,
        "Obstacles",
        "Plates, spheres and cylinders that push the surface. "
        "See [Push with plates, spheres and cylinders](../howto/obstacles.md).",
    ),
    Group(
        ("panel", "poses"),
        _PANEL,
        "Poses",
        "Named places of all handles. See [Move handles](../howto/move.md).",
    ),
    Group(
        ("panel", "method"),
        _PANEL,
        "Method",
        "What is kept and what gives way. See [Choose method, targets and stiffness](../howto/targets.md) "
        "and [Methods](../methods.md).",
    ),
    Group(
        ("panel", "regions"),
        _PANEL,
        "Regions",
        "Painted parts whose area is measured or kept. "
        "See [Choose base, handles and regions](../howto/choose.md).",
    ),
    Group(
        ("panel", "measure"),
        _PANEL,
        "Measure",
        "What the tool Measure has measured. See [Read the panel and measure](../howto/measure.md#measuring).",
    ),
    Group(
        ("panel", "target"),
        _PANEL,
        "Target shape",
        "Distances from another mesh, once one is loaded. See [See what has changed](../howto/look.md).",
    ),
    Group(
        ("panel", "paint"),
        _PANEL,
        "Vertices",
        "How many vertices are painted as what. See [Choose base, handles and regions](../howto/choose.md).",
    ),
    Group(
        ("part-buttons",),
        _PANEL,
        "Buttons of a part",
        "The base, each handle and each region has them in its row. "
        "See [Choose base, handles and regions](../howto/choose.md#clear-lock-hide).",
    ),
    Group(
        ("legend",),
        _VIEW,
        "Legend of an overlay",
        "Colours and their scale, once an overlay is shown. See [See what has changed](../howto/look.md).",
    ),
    Group(
        ("cutting-plane",),
        _VIEW,
        "Section",
        "A plane that cuts the mesh open (`S`). See [See what has changed](../howto/look.md).",
    ),
    Group(
        ("before-after",),
        _VIEW,
        "Before and after",
        "A slider between the rest shape and the current one (`Shift+A`). "
        "See [See what has changed](../howto/look.md).",
    ),
    Group(
        ("finding-list",),
        _VIEW,
        "Mesh check",
        "What was found in the mesh when it was opened (`Ctrl+I`). See [Open a mesh](../howto/open.md).",
    ),
    Group(
        ("text-entry-card",),
        _VIEW,
        "Entry field",
        "A field for what you type, instead of a click: a radius, coordinates, or conditions. `Enter` accepts.",
    ),
    Group(
        ("empty-state",),
        _VIEW,
        "Empty window",
        "Opens a mesh or a sample while nothing is open. See [Open a mesh](../howto/open.md).",
    ),
    Group(
        ("recovery-bar",),
        _VIEW,
        "Unsaved work",
        "Offers what was not saved when the program last ended. See [Save, export and report](../howto/save.md).",
    ),
    Group(
        ("notice",),
        _VIEW,
        "Message",
        "What has happened, or what went wrong. See [If something goes wrong](../howto/trouble.md).",
    ),
    Group(
        ("command-search",),
        _VIEW,
        "Command search",
        "Finds commands, controls and settings by what you want to do, and runs them. "
        "See [Find help and commands](../howto/help.md).",
    ),
    Group(
        ("shortcut-sheet",),
        _VIEW,
        "Shortcuts",
        "Lists all actions and changes their keys. See [Change settings, keys and language](../howto/settings.md#keys).",
    ),
    Group(("tour-card",), _VIEW, "Tour", "The first steps on a bottle, one at a time."),
    Group(
        ("status-bar",),
        _BELOW,
        "Status bar",
        "What the tool does, and how far the solver is. "
        "See [Read the panel and measure](../howto/measure.md#the-solver-at-work).",
    ),
    Group(
        ("badge",), _BELOW, "Issues of the mesh", "A click lists what was found in the mesh, and shows where."
    ),
    Group(
        ("history-list",),
        _BELOW,
        "History",
        "All steps since the mesh was opened; a click on one goes there. See [Undo](../howto/undo.md).",
    ),
    Group(
        ("plots",),
        _BELOW,
        "Plots",
        "Curves that follow the shape (`Ctrl+P`). See [See what has changed](../howto/look.md#plots).",
    ),
    Group(
        ("results-panel",),
        _BELOW,
        "Study results",
        "Table, plot and curves of many cases. See [Run many cases](../howto/studies.md).",
    ),
    Group(
        ("comparison-window",),
        _DIALOGS,
        "Compare methods",
        "The methods side by side, in a window of its own. "
        "See [Compare methods and sweep a motion](../howto/compare.md).",
    ),
    Group(
        ("sweep-dialog",),
        _DIALOGS,
        "Sweep",
        "Curves along the motion of the handles. "
        "See [Compare methods and sweep a motion](../howto/compare.md#sweep-a-motion).",
    ),
    Group(
        ("press-dialog",),
        _DIALOGS,
        "Press between plates",
        "Load and volume while two plates close. See [Press between plates](../howto/press.md).",
    ),
    Group(
        ("animation-dialog",),
        _DIALOGS,
        "Export animation",
        "The motion as frames for another program. See [Save, export and report](../howto/save.md).",
    ),
    Group(
        ("plan-dialog",),
        _DIALOGS,
        "Study",
        "Many variants of the deformation that is open. "
        "See [Run many cases](../howto/studies.md#in-the-window).",
    ),
    Group(
        ("paper-dialog",),
        _DIALOGS,
        "The paper's tables",
        "Computes the two tables of Li and Hui. "
        "See [Compare methods and sweep a motion](../howto/compare.md#the-papers-tables).",
    ),
    Group(
        ("run-bar",),
        _DIALOGS,
        "Buttons of a run",
        "At the bottom of the dialogs that compute for a while.",
    ),
    Group(
        ("picture-dialog",),
        _DIALOGS,
        "Save picture",
        "The view as a PNG file. See [Save, export and report](../howto/save.md).",
    ),
    Group(
        ("settings-dialog",),
        _DIALOGS,
        "Settings",
        "What each setting does is listed under [Settings](settings.md).",
    ),
)

# Where the window's own title depends on what is open, or is missing.
TITLES = {
    "panel/area/unit": "Unit of length",
    "panel/volume/crossings": "Self-intersections",
    "panel/volume/pairs": "Pairs in contact",
    "panel/handles/drift": "Drift",
    "panel/handles/list/rows": "Row of a handle",
    "panel/handles/list/rows/name": "Name of a handle",
    "panel/obstacles/list/rows": "Row of an obstacle",
    "panel/obstacles/list/rows/name": "Name of an obstacle",
    "panel/poses/list/rows": "Row of a pose",
    "panel/poses/list/rows/name": "Name of a pose",
    "panel/regions/list/rows": "Row of a region",
    "panel/regions/list/rows/name": "Name of a region",
    "panel/measure/list/rows": "Row of a measurement",
    "panel/measure/list/rows/name": "Name of a measurement",
    "panel/target/closest": "Closest point: largest, RMS and mean",
    "panel/target/vertex": "Same vertex: largest, RMS and mean",
    "panel/paint/counts": "Number of vertices",
    "finding-list/rows": "Issue",
    "plan-dialog/varied/rows-check": "Quantity",
    "plan-dialog/varied/rows-low": "First end of a range",
    "plan-dialog/varied/rows-high": "Second end of a range",
    "plan-dialog/methods-checks": "Methods",
    "sweep-dialog/methods": "Methods",
    "comparison-window/checks": "Methods",
    "run-bar/start": "Run, Sweep, Press or Export",
    "text-entry-card/text": "Field",
    "shortcut-sheet/groups/rows/keys": "Keys of an action",
    "shortcut-sheet/groups/rows/back": "Restore default",
}

_RENAME = "Double-click it, or press F2, to rename; Enter accepts and Esc restores"

_HELP = "Opens the manual at this window; F1 explains the control in use"

SENTENCES = {
    **{
        f"{window}/help": _HELP
        for window in ("run-bar", "plan-dialog", "picture-dialog", "settings-dialog", "comparison-window")
    },
    "panel/volume/crossings": "Number of triangles that cross others, checked when the shape stops moving; "
    "a click shows where they are",
    "panel/handles/list/rows/name": _RENAME,
    "panel/obstacles/list/rows/name": _RENAME,
    "panel/poses/list/rows/name": _RENAME,
    "panel/regions/list/rows/name": _RENAME,
    "panel/measure/list/rows/name": _RENAME,
    "panel/handles/list/rows/reading": "Number of vertices of the handle",
    "panel/regions/list/rows/reading": "Area of the region, in percent of its rest area",
    "panel/method/method": "Deformation method; the two sentences below say what it keeps and what it gives up",
    "panel/method/convergence": "Says when the solver stops; a click unfolds it",
    "panel/handles/motion/choice": "Kind of motion to type: twist, push, bend, turn, move, scale and others",
    "panel/handles/motion/amount": "An amount with a unit or an expression, such as 60deg, 1/6 turn, 0.15L, 5mm "
    "or 80%; Enter makes the motion",
    "panel/obstacles/fields/along": "The axis of the obstacle, or an axis of the mesh, to move it along",
    "panel/paint/counts": "Vertices of the base, of all handles, and free ones",
    "empty-state/open": "Asks for a mesh or a session to open",
    "before-after/close-button": "Closes the card; the view shows the current shape again",
    "legend/choice": "Quantity that the colours show",
    "cutting-plane/slider": "Moves the plane through the mesh",
    "finding-list/rows": "A click selects the place in the view",
    "text-entry-card/text": "The radius of the brush, the coordinates of a pivot, or IDs and conditions of vertices",
    "shortcut-sheet/search": "Shows the rows with all words that you type",
    "shortcut-sheet/swap": "Gives the keys to this action, and its own keys to the one that had them",
    "shortcut-sheet/groups/rows/keys": "Click it and press the new keys; Delete removes them, Esc cancels",
    "shortcut-sheet/groups/rows/back": "Returns to the keys that the action is made with",
    "tour-card/back": "Goes to the step before",
    "tour-card/next": "Goes to the next step, or ends the tour",
    "status-bar/cancel": "Cancels the job that is named beside it",
    "results-panel/open": "Opens the results of a study from their folder",
    "results-panel/curves/reading": "Quantity of the curves",
    "results-panel/scatter/upright": "Column along the upright axis of the plot",
    "results-panel/scatter/across": "Column along the horizontal axis of the plot",
    "results-panel/scatter/color": "Column that colours the dots",
    "results-panel/table": "A row for each case; a click opens its shape, a click on a title sorts",
    "comparison-window/checks": "Methods to compare, at least two; the tip of each says what it keeps and gives up",
    "comparison-window/table": "Measurements of each method, as far as it has come",
    "sweep-dialog/motion": "What is walked: the motion of the handles so far, or a twist of the active handle",
    "sweep-dialog/twist": "Angle of the twist, such as 180deg, where a twist is swept",
    "sweep-dialog/steps": "Shapes that are computed along the motion",
    "sweep-dialog/to": "Where the motion ends, in percent of what the handles have moved so far",
    "sweep-dialog/iterations": "Most iterations for each shape",
    "sweep-dialog/methods": "Methods whose curves are drawn; some take several times as long as others",
    "sweep-dialog/meshes": "Writes the mesh of each step too",
    "sweep-dialog/animation": "Writes the shapes one after another as an animation",
    "sweep-dialog/format": "Format of the animation",
    "press-dialog/direction": "Axis along which the plates close",
    "press-dialog/to": "Distance of the plates in the end, in percent of the size at rest",
    "press-dialog/steps": "Shapes that are computed on the way",
    "press-dialog/iterations": "Most iterations for each shape",
    "press-dialog/method": "Method of the wall",
    "press-dialog/stiffness": "How strongly the wall resists bending, from cloth to sheet metal",
    "press-dialog/wall-material": "Fills in the moduli and the density of a material",
    "press-dialog/wall-release": "Opens the plates after the last step, and measures what remains",
    "animation-dialog/motion": "The motion of the handles so far, or their last step",
    "animation-dialog/steps": "Frames of the animation after the first one",
    "animation-dialog/format": "Point cache, morph targets or a series for ParaView",
    "plan-dialog/varied/rows-check": "Varies this quantity: a motion, the stiffness or a target",
    "plan-dialog/varied/rows-low": "Value at the beginning of the range, shown in the view while it is edited",
    "plan-dialog/varied/rows-high": "Value at the end of the range; empty for a single value",
    "plan-dialog/methods-checks": "Methods to compute; with several, each is tried like a value of a range",
    "plan-dialog/design": "How the cases are spread over the ranges",
    "plan-dialog/samples": "Number of cases to compute",
    "plan-dialog/steps": "Steps in which each case walks its motion",
    "plan-dialog/engine-where": "On this machine, or by a scheduler of Dask",
    "plan-dialog/engine-processes": "Cases that are computed at a time, one core for each",
    "plan-dialog/browse": "Chooses the folder",
    "plan-dialog/start": "Writes the plan and begins to compute",
    "plan-dialog/cancel": "Closes the dialog without a study",
    "run-bar/start": "Begins to compute; the dialog shows the result",
    "run-bar/cancel": "Ends the run",
    "run-bar/save": "Saves the results to a folder",
    "run-bar/open": "Shows the folder of the results",
    "picture-dialog/times": "The size of the view, a multiple of it, or a size of your own",
    "picture-dialog/width": "Width in pixels",
    "picture-dialog/height": "Height in pixels",
    "picture-dialog/legend": "Draws the legend of the overlay, where one is shown",
    "picture-dialog/gizmo": "Draws the gizmo, where it is shown",
    "picture-dialog/save": "Asks for a file and writes the picture",
    "picture-dialog/cancel": "Closes the dialog without a picture",
    "settings-dialog/close": "Closes the dialog; every setting holds as soon as it is chosen",
    "finding-list/close-button": "Closes the list",
}
