"""Arrays of others as real numbers: what would lose a part, or a meaning, is refused."""

from typing import Any

import numpy as np

from surae.base.frozen import read_only
from surae.base.units import FloatArray


def real_numbers(values: Any) -> FloatArray:
    """A read-only float64 copy of an array, a series or a list of real numbers.

    Parameters
    ----------
    values : array_like
        Real numbers; None, NaN and pandas' NA become NaN.

    Returns
    -------
    ndarray
        Of the same shape.

    Raises
    ------
    ValueError
        It holds something else; the message says what, and what to give instead.
    """
    if np.ma.isMaskedArray(values) and np.ma.getmaskarray(values).any():
        raise ValueError("some of its values are masked: fill them, or give .compressed()")
    if str(getattr(values, "dtype", "")) == "category":
        raise ValueError("it holds categories: give the numbers themselves, .astype(float)")
    array = np.asarray(values)
    match array.dtype.kind:
        case "b":
            raise ValueError("it holds True and False: if 1 and 0 are meant, give .astype(float)")
        case "c":
            raise ValueError("it holds complex numbers: give their real part, .real")
        case "O":
            return read_only(np.vectorize(_real, otypes=[np.float64])(array))
        case "i" | "u" | "f":
            return read_only(array)
    raise ValueError("it holds no numbers")


def _real(value: Any) -> float:
    """A number of an array of objects."""
    if value is None or type(value).__name__ == "NAType":
        return np.nan
    if isinstance(value, bool | np.bool_ | str | bytes) or np.iscomplexobj(value):
        raise ValueError(f"it holds no numbers alone, but {type(value).__name__} too")
    try:
        return float(value)
    except (TypeError, ValueError):
        raise ValueError(f"it holds no numbers alone, but {type(value).__name__} too") from None
