"""From a `Robot` to kernels written for it: ordinary, readable modules of straight-line code."""
