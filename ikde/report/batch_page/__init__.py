"""A batch as a page: what ran, how much was reached, at what cost, how clear, and what was not."""
