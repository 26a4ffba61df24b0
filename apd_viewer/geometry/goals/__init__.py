"""Areas and a volume to be met: goals, and the projection onto them."""
