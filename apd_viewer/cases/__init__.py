"""Deformation cases: painted documents moved in steps, singly or by a study plan."""
