"""Readers and writers of selections and transforms."""
