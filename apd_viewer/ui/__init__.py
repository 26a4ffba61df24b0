"""Room 4: what the user sees and touches. The only room that knows Qt and VTK."""
