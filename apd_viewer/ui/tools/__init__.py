"""Tools of the mouse: brushes, selections and the gizmo."""
