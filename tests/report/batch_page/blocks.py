"""What tests look for in a section."""

from ikde.report.page import Figure, Gallery, Table


def tables(section):
    return [block for block in section.blocks if isinstance(block, Table)]


def figures(section):
    found = [block for block in section.blocks if isinstance(block, Figure)]
    return found + [figure for block in section.blocks if isinstance(block, Gallery) for figure in block.figures]


def column(table, head):
    """The cells below a head."""
    place = [column.head for column in table.columns].index(head)
    return [row[place] for row in table.rows]
