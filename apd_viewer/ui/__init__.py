"""User interface: the only package with Qt and VTK, besides the drawing process."""
