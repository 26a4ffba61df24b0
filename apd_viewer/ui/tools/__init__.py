"""Mouse tools of the canvas: brush, selections and gizmo."""
