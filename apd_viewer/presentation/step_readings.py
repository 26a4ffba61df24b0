"""Readings of a shape on a timeline as texts and curves."""

from typing import NamedTuple

import numpy as np

from apd_viewer.language import tr
from apd_viewer.presentation import readings
from apd_viewer.presentation.plate_readings import ReadingText, rest_verdict, volume_reading
from apd_viewer.session.model.state import State
from apd_viewer.session.model.timeline import Timeline
from apd_viewer.session.quantities.units import Unit

_LOCAL_TIP = tr("Largest relative change of the area of a triangle")
_STRAIN_TIP = tr("Of the edge whose length has changed most")


def step_reading_texts(state: State, unit: Unit) -> tuple[ReadingText, ...]:
    """Area, volume, local change and edge strain of a shape."""
    return (
        ReadingText(tr("Area"), readings.area_percent(state), "", tr("In percent of the area at rest")),
        volume_reading(state, unit),
        ReadingText(tr("Local change"), readings.local_change(state), "", _LOCAL_TIP),
        ReadingText(tr("Edge strain"), readings.largest_edge_strain(state), "", _STRAIN_TIP),
    )


def step_verdict(state: State) -> tuple[str, bool]:
    """Sentence saying whether a shape is in equilibrium; True if it needs no warning."""
    if state.frame.settled and state.document.paint_problem is not None:
        return tr("As it is in the file."), True
    return rest_verdict(state, tr("Not at rest."), tr("Contact stops the motion here."))


class StepCurves(NamedTuple):
    """Readings along a timeline, each (s,); NaN if unknown.

    Attributes
    ----------
    area, volume : float array
        Percent of rest.
    energy : float array
        Squared lengths.
    strain : float array
        Mean absolute strain of the edges, percent.
    settled : bool array
    """

    area: np.ndarray
    volume: np.ndarray
    energy: np.ndarray
    strain: np.ndarray
    settled: np.ndarray


def step_curves(timeline: Timeline) -> StepCurves:
    """Curves of area, volume, energy and strain along a timeline."""
    rows = np.array([_curve_row(step.state) for step in timeline.steps]).reshape(-1, 5)
    area, volume, energy, strain, settled = rows.T
    return StepCurves(area, volume, energy, strain, settled > 0.0)


def _curve_row(state: State) -> tuple[float, ...]:
    frame = state.frame
    now, rest = readings.volumes(frame, state.inspection)
    volume = 100.0 * now / rest if rest and now is not None else np.nan
    energy = np.nan if frame.energy is None else frame.energy
    return (
        100.0 * (1.0 + frame.area_error),
        volume,
        energy,
        100.0 * frame.mean_edge_strain,
        float(frame.settled),
    )
