"""Floor 10: tables and figures of [Qiao2021] and [DongZhao]: what is printed, what ikde computes, both on a page.

A topic is a module with its dataclasses, `compute_<topic>` and `show_<topic>` (which stands in `<topic>_page.py` where
one file would be long). `results.py` lists them.
"""
