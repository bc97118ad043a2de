"""Floor 6: figures. Matplotlib is imported only when something is drawn."""
