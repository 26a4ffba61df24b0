"""Sweeps, comparisons, replays and the paper's curves."""
