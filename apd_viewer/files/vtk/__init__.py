"""Surface meshes in VTK files, XML and legacy."""
