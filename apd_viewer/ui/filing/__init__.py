"""Opening, saving, exporting and recovering."""
