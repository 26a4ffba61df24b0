"""Surfaces in files of VTK: XML and legacy."""
