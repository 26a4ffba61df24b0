"""The window; the only room with Qt and VTK, besides the drawing process."""
