"""What all rooms' tests share. pytest puts this folder on sys.path, so ``from meshes import box`` works."""

from hypothesis import settings

# The kernels compile on first use, which no deadline can foresee; the same examples on every machine.
settings.register_profile("suite", deadline=None, derandomize=True, max_examples=60)
settings.load_profile("suite")
