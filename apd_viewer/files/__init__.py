"""Reading and writing of meshes, selections, animations, tables and reports."""
