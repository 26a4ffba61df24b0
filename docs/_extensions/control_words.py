"""Words about controls that the window itself does not say: groups, and sentences where there is no tip."""

from __future__ import annotations

from typing import NamedTuple


class Group(NamedTuple):
    """Controls that stand together: their class, part of the window, heading and first sentence."""

    name: str
    part: str
    title: str
    lead: str


_PANEL, _VIEW, _BELOW, _DIALOGS = "Side panel", "Over the view", "Around the view", "Dialogs"

GROUPS = (
    Group(
        "AreaSection",
        _PANEL,
        "Area",
        "The total area and its change from rest, above both pages. "
        "See [Read the panel and measure](../howto/measure.md).",
    ),
    Group(
        "PartsSection",
        _PANEL,
        "Parts",
        "Base, handles, regions and obstacles, one row for each. "
        "See [Choose base, handles and regions](../howto/choose.md).",
    ),
    Group(
        "VolumeSection",
        _PANEL,
        "Volume",
        "The enclosed volume, and whether the surface crosses or touches itself. "
        "See [Read the panel and measure](../howto/measure.md).",
    ),
    Group(
        "StrainSection",
        _PANEL,
        "Strain and drift",
        "How far triangles and edges are stretched, and handles are off. "
        "See [Read the panel and measure](../howto/measure.md).",
    ),
    Group(
        "SizeSection",
        _PANEL,
        "Size and mass",
        "Boxes around the shape, its wall and its mass. "
        "See [Read the panel and measure](../howto/measure.md).",
    ),
    Group(
        "HandleSection",
        _PANEL,
        "Motion",
        "The motion of the active handle, by hand or by a typed amount. See [Move handles](../howto/move.md).",
    ),
    Group(
        "ObstacleSection",
        _PANEL,
        "Obstacles",
        "Place and motion of the active plate, sphere or cylinder. "
        "See [Push with plates, spheres and cylinders](../howto/obstacles.md).",
    ),
    Group(
        "PoseSection",
        _PANEL,
        "Poses",
        "Named places of all handles. See [Move handles](../howto/move.md).",
    ),
    Group(
        "MethodSection",
        _PANEL,
        "Method",
        "What is kept and what gives way, with the targets of area and volume. See [Choose method, targets and stiffness](../howto/targets.md) "
        "and [Methods](../methods.md).",
    ),
    Group(
        "MeasureSection",
        _PANEL,
        "Measure",
        "What the tool Measure has measured. See [Read the panel and measure](../howto/measure.md#measuring).",
    ),
    Group(
        "TargetSection",
        _PANEL,
        "Target shape",
        "Distances from another mesh, once one is loaded. See [See what has changed](../howto/look.md).",
    ),
    Group(
        "PaintSection",
        _PANEL,
        "Vertices",
        "How many vertices are painted as what. See [Choose base, handles and regions](../howto/choose.md).",
    ),
    Group(
        "PartButtons",
        _PANEL,
        "Buttons of a part",
        "The base, each handle and each region has them in its row. "
        "See [Choose base, handles and regions](../howto/choose.md#clear-lock-hide).",
    ),
    Group(
        "Legend",
        _VIEW,
        "Legend of an overlay",
        "Colours and their scale, once an overlay is shown. See [See what has changed](../howto/look.md).",
    ),
    Group(
        "CuttingPlaneCard",
        _VIEW,
        "Section",
        "A plane that cuts the mesh open (`S`). See [See what has changed](../howto/look.md).",
    ),
    Group(
        "BlendCard",
        _VIEW,
        "Before and after",
        "A slider between the rest shape and the current one (`Shift+A`). "
        "See [See what has changed](../howto/look.md).",
    ),
    Group(
        "FindingList",
        _VIEW,
        "Mesh check",
        "What was found in the mesh when it was opened (`Ctrl+I`). See [Open a mesh](../howto/open.md).",
    ),
    Group(
        "TextEntryCard",
        _VIEW,
        "Entry field",
        "A field for what you type, instead of a click: a radius, coordinates, or conditions. `Enter` accepts.",
    ),
    Group(
        "EmptyState",
        _VIEW,
        "Empty window",
        "Opens a mesh or a sample while nothing is open. See [Open a mesh](../howto/open.md).",
    ),
    Group(
        "RecoveryBar",
        _VIEW,
        "Unsaved work",
        "Offers what was not saved when the program last ended. See [Save, export and report](../howto/save.md).",
    ),
    Group(
        "Notice",
        _VIEW,
        "Message",
        "What has happened, or what went wrong. See [If something goes wrong](../howto/trouble.md).",
    ),
    Group(
        "CommandSearch",
        _VIEW,
        "Command search",
        "Finds commands, controls and settings by what you want to do, and runs them. "
        "See [Find help and commands](../howto/help.md).",
    ),
    Group(
        "ShortcutSheet",
        _VIEW,
        "Shortcuts",
        "Lists all actions and changes their keys. See [Change settings, keys and language](../howto/settings.md#keys).",
    ),
    Group("TourCard", _VIEW, "Tour", "The first steps on a bottle, one at a time."),
    Group(
        "StatusBar",
        _BELOW,
        "Status bar",
        "What the tool does, and how far the solver is. "
        "See [Read the panel and measure](../howto/measure.md#the-solver-at-work).",
    ),
    Group(
        "HistoryList",
        _BELOW,
        "History",
        "All steps since the mesh was opened; a click on one goes there. See [Undo](../howto/undo.md).",
    ),
    Group(
        "Plots",
        _BELOW,
        "Plots",
        "Curves that follow the shape (`Ctrl+P`). See [See what has changed](../howto/look.md#plots).",
    ),
    Group(
        "TimelinePanel",
        _BELOW,
        "Timeline",
        "Every step of a motion or of an opened animation, and two plates that close on the mesh (`Shift+K`). "
        "See [Go back along the timeline](../howto/timeline.md) and [Press between plates](../howto/press.md).",
    ),
    Group(
        "ResultsPanel",
        _BELOW,
        "Study results",
        "Table, plot and curves of many cases. See [Run many cases](../howto/studies.md).",
    ),
    Group(
        "ComparisonWindow",
        _DIALOGS,
        "Compare methods",
        "The methods side by side, in a window of its own. "
        "See [Compare methods and sweep a motion](../howto/compare.md).",
    ),
    Group(
        "SweepDialog",
        _DIALOGS,
        "Sweep",
        "Curves along the motion of the handles. "
        "See [Compare methods and sweep a motion](../howto/compare.md#sweep-a-motion).",
    ),
    Group(
        "PressDialog",
        _DIALOGS,
        "Press between plates",
        "Load and volume while two plates close. See [Press between plates](../howto/press.md).",
    ),
    Group(
        "AnimationDialog",
        _DIALOGS,
        "Export animation",
        "The motion as frames for another program. See [Save, export and report](../howto/save.md).",
    ),
    Group(
        "PlanDialog",
        _DIALOGS,
        "Study",
        "Many variants of the deformation that is open. "
        "See [Run many cases](../howto/studies.md#in-the-window).",
    ),
    Group(
        "PaperDialog",
        _DIALOGS,
        "The paper's tables",
        "Computes the two tables of Li and Hui. "
        "See [Compare methods and sweep a motion](../howto/compare.md#the-papers-tables).",
    ),
    Group(
        "VerificationDialog",
        _DIALOGS,
        "Verify",
        "Runs cases with exact answers. See [Verify the program](../howto/verification.md).",
    ),
    Group(
        "RunBar",
        _DIALOGS,
        "Buttons of a run",
        "At the bottom of the dialogs that compute for a while.",
    ),
    Group(
        "PictureDialog",
        _DIALOGS,
        "Save picture",
        "The view as a PNG file. See [Save, export and report](../howto/save.md).",
    ),
    Group(
        "ReportDialog",
        _DIALOGS,
        "Save report",
        "The heading of a report. See [Save, export and report](../howto/save.md).",
    ),
    Group(
        "SettingsDialog",
        _DIALOGS,
        "Settings",
        "What each setting does is listed under [Settings](settings.md).",
    ),
)

# Where the window's own title depends on what is open: a pattern of section and title, and what stands for it.
TITLES = {
    "AreaSection/Unit of length.*": "AreaSection/Unit of length",
    "VolumeSection/self-intersections.*": "VolumeSection/Self-intersections",
    "StrainSection/Distance between a handle.*": "StrainSection/Drift",
    "(\\w+)Section/.*, active": "Row",
    "PaintSection/Vertices: .*": "PaintSection/Number of vertices",
    "TargetSection/.*, Closest point": "TargetSection/Closest point: largest, RMS and mean",
    "TargetSection/.*, Same vertex": "TargetSection/Same vertex: largest, RMS and mean",
    "PlanDialog/.* from": "PlanDialog/First end of a range",
    "PlanDialog/.* to": "PlanDialog/Second end of a range",
    "SweepDialog/(ARAP|Paper|Exact|Local)": "SweepDialog/Methods",
    "RunBar/(Run|Sweep|Press|Export)": "RunBar/Run, Sweep, Press or Export",
    "TextEntryCard/.*": "TextEntryCard/Field",
    "ShortcutSheet/Keys of .*": "ShortcutSheet/Keys of an action",
    "ShortcutSheet/Restore the default keys of .*": "ShortcutSheet/Restore default",
    "StatusBar/(No issues|.* issues?)": "StatusBar/Issues of the mesh",
}

# By section and title, or by title alone, where there is no tip or the tip depends on what is open.
SENTENCES = {
    "Name": "Double-click it, or press F2, to rename; Enter accepts and Esc restores",
    "VolumeSection/Self-intersections": "Number of triangles that cross others, checked when the shape stops moving; a click shows where they are",
    "PartsSection/Measurement of the handle": "Number of vertices of the handle",
    "PartsSection/Measurement of the region": "Area of the region, in percent of its rest area",
    "MethodSection/Method": "Deformation method; the two sentences below say what it keeps and what it gives up",
    "VerificationDialog/Cases with exact answers": "A row for each quantity; a click shows the figure of its case",
    "VerificationDialog/Copy table": "Copies the rows for a spreadsheet",
    "MethodSection/Convergence": "Says when the solver stops; a click unfolds it",
    "HandleSection/Handle motion": "Kind of motion to type: twist, push, bend, turn, move, scale and others",
    "HandleSection/Amount": "An amount with a unit or an expression, such as 60deg, 1/6 turn, 0.15L, 5mm or 80%; Enter makes the motion",
    "ObstacleSection/Direction of the distance": "The axis of the obstacle, or an axis of the mesh, to move it along",
    "PaintSection/Number of vertices": "Vertices of the base, of all handles, and free ones",
    "EmptyState/Open mesh": "Asks for a mesh or a session to open",
    "BlendCard/Close before and after": "Closes the card; the view shows the current shape again",
    "Legend/Overlay": "Quantity that the colours show",
    "CuttingPlaneCard/Section position": "Moves the plane through the mesh",
    "TextEntryCard/Field": "The radius of the brush, the coordinates of a pivot, or IDs and conditions of vertices",
    "ShortcutSheet/Search shortcuts": "Shows the rows with all words that you type",
    "ShortcutSheet/Swap": "Gives the keys to this action, and its own keys to the one that had them",
    "ShortcutSheet/Keys of an action": "Click it and press the new keys; Delete removes them, Esc cancels",
    "ShortcutSheet/Restore default": "Returns to the keys that the action is made with",
    "TourCard/Back": "Goes to the step before",
    "TourCard/Next": "Goes to the next step, or ends the tour",
    "StatusBar/Cancel": "Cancels the job that is named beside it",
    "ResultsPanel/Open study": "Opens the results of a study from their folder",
    "ResultsPanel/Measurement along the motion": "Quantity of the curves",
    "ResultsPanel/Upright axis": "Column along the upright axis of the plot",
    "ResultsPanel/Axis across": "Column along the horizontal axis of the plot",
    "ResultsPanel/Colour": "Column that colours the dots",
    "ResultsPanel/Results of the study": "A row for each case; a click opens its shape, a click on a title sorts",
    "ComparisonWindow/Measurements of the methods": "Measurements of each method, as far as it has come",
    "SweepDialog/Motion to sweep": "What is walked: the motion of the handles so far, or a twist of the active handle",
    "SweepDialog/Angle of the twist": "Angle of the twist, such as 180deg, where a twist is swept",
    "SweepDialog/Number of steps": "Shapes that are computed along the motion",
    "SweepDialog/End of the motion": "Where the motion ends, in percent of what the handles have moved so far",
    "SweepDialog/Iterations per step": "Iteration limit for each shape",
    "SweepDialog/Methods": "Methods whose curves are drawn; some take several times as long as others",
    "SweepDialog/the mesh of each step": "Writes the mesh of each step too",
    "SweepDialog/an animation:": "Writes the shapes one after another as an animation",
    "SweepDialog/Format of the animation": "Format of the animation",
    "PressDialog/Direction to press in": "Axis along which the plates close",
    "PressDialog/Distance of the plates in the end": "Distance of the plates in the end, in percent of the size at rest",
    "PressDialog/Number of steps": "Shapes that are computed on the way",
    "PressDialog/Iterations per step": "Iteration limit for each shape",
    "PressDialog/Method": "Method of the wall",
    "PressDialog/Stiffness": "How strongly the wall resists bending, from cloth to sheet metal",
    "PressDialog/open the plates again, to see what remains": "Opens the plates after the last step, and measures what remains",
    "AnimationDialog/Motion to export": "The motion of the handles so far, or their last step",
    "AnimationDialog/Number of steps": "Frames of the animation after the first one",
    "AnimationDialog/Format of the animation": "Point cache, morph targets or a series for ParaView",
    "PlanDialog/First end of a range": "Value at the beginning of the range, shown in the view while it is edited",
    "PlanDialog/Second end of a range": "Value at the end of the range; empty for a single value",
    "PlanDialog/Design": "How the cases are spread over the ranges",
    "PlanDialog/Number of cases": "Number of cases to compute",
    "PlanDialog/Steps per case": "Steps of the motion in each case",
    "PlanDialog/Where the cases run": "On this machine, or by a scheduler of Dask",
    "PlanDialog/Cases at a time": "Cases that are computed at a time, one core for each",
    "PlanDialog/Choose": "Chooses the folder",
    "PlanDialog/Run": "Writes the plan and begins to compute",
    "PlanDialog/Cancel": "Closes the dialog without a study",
    "RunBar/Run, Sweep, Press or Export": "Begins to compute; the dialog shows the result",
    "RunBar/Cancel": "Ends the run",
    "RunBar/Save": "Saves the results to a folder",
    "RunBar/Open folder": "Shows the folder of the results",
    "PictureDialog/Size": "The size of the view, a multiple of it, or a size of your own",
    "PictureDialog/Width": "Width in pixels",
    "PictureDialog/Height": "Height in pixels",
    "PictureDialog/Overlay legend": "Draws the legend of the overlay, where one is shown",
    "PictureDialog/Gizmo": "Draws the gizmo, where it is shown",
    "PictureDialog/Save": "Asks for a file and writes the picture",
    "PictureDialog/Cancel": "Closes the dialog without a picture",
    "ReportDialog/Save": "Asks for a file and writes the report",
    "ReportDialog/Cancel": "Closes the dialog without a report",
    "SettingsDialog/Close": "Closes the dialog; every setting holds as soon as it is chosen",
    "FindingList/Close mesh check": "Closes the list",
    "StatusBar/Issues of the mesh": "Lists what was found in the mesh, and shows where",
    "ResultsPanel/Table": "Shows the results as a table",
    "ResultsPanel/Plot": "Shows the results as dots, by two columns",
    "ResultsPanel/Curves": "Shows the curves of the cases along their motion",
}
