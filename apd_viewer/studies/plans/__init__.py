"""Plans of studies: cases, the files that they need, and designs."""
