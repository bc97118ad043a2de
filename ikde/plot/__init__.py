"""Floor 8: figures. Matplotlib is imported only when something is drawn."""
