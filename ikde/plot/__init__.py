"""Floor 7: figures. Matplotlib is imported only when something is drawn."""
