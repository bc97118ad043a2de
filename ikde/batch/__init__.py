"""Floor 6: many solves: what a run file says, and how it runs, stops and goes on."""
