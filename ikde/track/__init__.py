"""Floor 6: a path that the tool follows with the whole robot: what is asked, and the motion that comes of it."""
