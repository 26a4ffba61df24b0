"""Previews of typed motions, symmetric posing and named poses in the window."""
