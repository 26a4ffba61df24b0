"""Help, tour and list of shortcuts."""
