"""Words, numbers, scales and colours of results; no Qt."""
