"""Help, tour and the list of shortcuts."""
