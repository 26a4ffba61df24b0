"""Dialogs for sweeps, presses and the paper's tables."""
