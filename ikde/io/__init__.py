"""Floor 8: files and typed text to objects, and back. The only place that knows mm, degrees and YAML."""
