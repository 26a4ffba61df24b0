"""Commands for desktops: their menu, file types and thumbnails."""
