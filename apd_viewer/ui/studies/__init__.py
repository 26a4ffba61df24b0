"""Dialogs for sweeps and the paper's tables."""
