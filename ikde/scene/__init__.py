"""Floor 7: what a drawing shows, as plain data that figures, pages and viewers render alike."""
