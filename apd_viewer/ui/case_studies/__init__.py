"""Studies of many cases in the window: set up, run, looked at."""
