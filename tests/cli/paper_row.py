"""A row of the paper as a user pastes it."""

# [Qiao2021, Table 5]: a row that reaches (800, 500, 1000) mm, in mm and rad, classical.
ROW = "-0.0008 0.8659 1.6368 1.0156 0.9326 -0.0388 0.4905 2.8275 0.6857"
ROW_OPTIONS = ("--unit", "mm", "--angles", "rad", "--convention", "classical")
