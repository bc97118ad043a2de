"""A batch as a page: what ran, who was reached, at what cost, how clear, and who was not."""
