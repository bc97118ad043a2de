"""The engines that search: each makes attempts number a .. b - 1 on some rows of a `SearchState`."""
