"""Room 3: what the user has said, and the worker that answers. Threads; no Qt."""
