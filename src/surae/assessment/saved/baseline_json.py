"""A baseline for snSEM as a file."""

from surae.assessment.saved.json_file import check_format, read_json
from surae.assessment.uncertainty.snsem import Baseline, baseline_as_dict, read_baseline
from surae.errors import InputError
from surae.files import PathLike, shown, write_json


def save_baseline(path: PathLike, baseline: Baseline) -> None:
    """Write a baseline; `load_baseline` reads it back.

    Raises
    ------
    InputError
        The file cannot be written.
    """
    write_json(path, baseline_as_dict(baseline))


def load_baseline(path: PathLike) -> Baseline:
    """Read a baseline."""
    data = read_json(path)
    check_format(data, path)
    try:
        return read_baseline(data)
    except KeyError as error:
        raise InputError(
            f"{shown(path)}: not a baseline, {error} is missing; give a file that "
            "`surae baseline` wrote"
        ) from None
    except (TypeError, ValueError, AttributeError) as error:
        raise InputError(f"{shown(path)}: a damaged baseline ({error})") from None
    except InputError as error:
        raise InputError(f"{shown(path)}: {error}") from None
