"""Floor 6: the paper's tables and figures as plain data, the published values beside ours."""
