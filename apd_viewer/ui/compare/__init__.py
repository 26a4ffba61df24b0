"""Methods compared side by side."""
