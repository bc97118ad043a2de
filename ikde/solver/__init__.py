"""Floor 3: one solve, its result, its independent check, and the reason when there is no solution."""
