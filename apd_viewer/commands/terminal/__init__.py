"""Shared parser, options, progress display and streams of all commands."""
