"""Commands for desktop integration: menu entry, file types and thumbnails."""
