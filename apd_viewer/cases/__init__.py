"""Painted documents along motions in steps: one alone, or many by a plan."""
