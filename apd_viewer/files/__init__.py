"""Room 2: meshes, selections and transforms on disk. Reads and writes; decides nothing."""
