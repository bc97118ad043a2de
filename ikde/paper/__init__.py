"""Floor 10: the tables and figures of [Qiao2021]: what is printed, what ikde computes, and both side by side on a page.

A topic is a module with its dataclasses, `compute_<topic>` and `show_<topic>` (which stands in `<topic>_page.py` where
one file would be long). `results.py` lists them.
"""
