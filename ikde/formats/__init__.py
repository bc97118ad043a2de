"""Floor 5: what all files that users write and get share: entries, tables, units, errors in place, whole files."""
