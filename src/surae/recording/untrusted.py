"""What a library says of a file that may be damaged, as one error."""

import warnings
from collections.abc import Iterator
from contextlib import contextmanager

from surae.base.cleaning import cleaned
from surae.base.errors import InputError


@contextmanager
def untrusted(shown: str) -> Iterator[None]:
    """Turn whatever a library raises on a file into one InputError, and silence its warnings."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    except InputError:
        raise
    except MemoryError:
        raise InputError(f"{shown}: the file is damaged, or needs too much memory") from None
    except Exception as error:
        raise InputError(f"{shown}: the file is damaged ({brief(error)})") from None


def brief(error: BaseException) -> str:
    """What a library says of a damaged file, short and in one printable line."""
    return cleaned(" ".join(str(error).split())[:120]) or type(error).__name__
