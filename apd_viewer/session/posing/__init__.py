"""Posing: typed motions, mirrored motions and named poses."""
