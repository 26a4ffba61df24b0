"""Lists of named rows: parts with their buttons, and what else has names."""
