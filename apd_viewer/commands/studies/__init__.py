"""The command ``apd-viewer study`` and its design of plans."""
