"""Child processes: the one place where they start, guarded, and the loop that they run.

A child calls functions of modules, by name, with plain data, and answers with plain data: JSON, in
which bytes and arrays may stand. Nothing is pickled, so that a child that a broken file has taken
over runs nothing here. It never imports from the working folder, reads and prints nothing of ours,
and ends with its parent, however that ended: its standard input closes everywhere, and Linux kills
it. Ctrl-C in the terminal is the parent's.
"""

from surae._lazy import lazy_names

__getattr__, __dir__ = lazy_names(__name__, __file__)
