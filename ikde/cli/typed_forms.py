"""What users type for numbers: three words, one quoted string, or commas; brought to what the options take."""

from collections.abc import Callable, Iterator, Sequence

VECTORS = {"--position": 3, "--rpy": 3, "--axis": 3, "--quat-wxyz": 4, "--look-at": 3, "--distance": 2}
"""Options of so many numbers, a word each."""
LISTS = {
    "--q",
    "--near",
    "--start",
    "--freeze",
    "--weights",
    "--de",
    "--tolerance-box",
    "--rotation-box",
    "--base-region",
}
"""Options of one word that holds them all."""


def regroup(words: Sequence[str]) -> list[str]:
    """The words of a command line, in which each option of numbers has as many words as it takes.

    What is no number, and words that are too few or too many, stay as they are, to be refused by the option.
    """
    return list(_regroup(list(words)))


def _regroup(words: list[str]) -> Iterator[str]:
    while words:
        option, given, value = words.pop(0).partition("=")
        if option == "--":
            yield from ("--", *words)
            return
        if option not in VECTORS and option not in LISTS:
            yield f"{option}{given}{value}"
            continue
        follow = [value] if given else []
        yield option
        if option in VECTORS:
            yield from _take_vector(follow, words, VECTORS[option])
        else:
            yield from _take_list(option, follow, words)


def _take_vector(follow: list[str], words: list[str], count: int) -> list[str]:
    """Words of so many numbers, taken off `words`; none of them if they are not so many."""
    from ikde.io.joint_text import split_values

    taken, left = list(follow), list(words)
    numbers = [number for word in taken for number in split_values(word)]
    while left and len(numbers) < count and _holds(left[0], _is_number):
        taken.append(left.pop(0))
        numbers += split_values(taken[-1])
    if len(numbers) != count or not all(map(_is_number, numbers)):
        return follow
    words[:] = left
    return numbers


def _take_list(option: str, follow: list[str], words: list[str]) -> list[str]:
    """One word of all that belongs to an option: its first word, and values after it."""
    taken = follow or words[:1]
    if not follow:
        del words[:1]
    fits = _is_joint if option == "--freeze" else _is_value
    while taken and words and _holds(words[0], fits):
        taken.append(words.pop(0))
    return [" ".join(taken)] if taken else []


def _holds(word: str, fits: Callable[[str], bool]) -> bool:
    from ikde.io.joint_text import split_values

    values = split_values(word)
    return bool(values) and all(map(fits, values))


def _is_number(text: str) -> bool:
    """True for what Python reads as a number."""
    try:
        float(text)
    except ValueError:
        return False
    return True


def _is_value(text: str) -> bool:
    name, equals, _ = text.partition("=")
    return _is_number(text) or (bool(equals) and not name.startswith("-"))


def _is_joint(text: str) -> bool:
    return not text.startswith("-")
