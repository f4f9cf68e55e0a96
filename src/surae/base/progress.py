"""Callbacks that follow a long computation."""

from collections.abc import Callable

#: Called with how many parts are done, and how many there are.
Progress = Callable[[int, int], None]
#: The same after what is being done.
NamedProgress = Callable[[str, int, int], None]
#: Called with how many starts are done, how many there are, and the best sum of squares so far.
SearchProgress = Callable[[int, int, float], None]
