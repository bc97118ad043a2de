"""Floor 9: results to text. Every function returns a `str` or a plain `dict`; only the CLI prints."""
