"""Floor 4: one solve, its result, its grades, and the reason when there is no solution."""
