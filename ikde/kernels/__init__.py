"""Floor 1: numba only. Arrays in, arrays out; status integers, never exceptions; SI units."""
