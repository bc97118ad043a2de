"""Floor 3: what a robot, a target and a detector are, and how they become arrays."""
