"""Reads the words of a command."""

from __future__ import annotations

import argparse


class Parser(argparse.ArgumentParser):
    """Parser that says what is wrong in one line."""

    def error(self, message: str) -> None:  # type: ignore[override]
        """Say it in one line; argparse would print the usage before it."""
        self.exit(2, f"error: {message}; see {self.prog} --help\n")
