"""Studies of a section, through the study engine: what is in the store is not computed again."""

from surae.reproduction.chapter import Context
from surae.runner import Engine
from surae.studies.run import run
from surae.studies.store import Store
from surae.studies.study import parse_study
from surae.studies.table import Cell, table

#: A row of a study's table, by column.
Row = dict[str, Cell]


def study_rows(context: Context, text: str) -> list[Row]:
    """The table of a study, computed as far as it is not there yet.

    Parameters
    ----------
    context : Context
        Of the section; its store is named after the study.
    text : str
        A STUDY.toml with a `name` that no other study of the reproduction has.

    Returns
    -------
    list of dict
        A row for each combination of the factors, in the order of the plan.

    Raises
    ------
    InputError, ComputationError
        As of `surae.studies.run.run`.
    """
    study = parse_study(text)
    engine = Engine("processes", context.workers)
    with Store(context.store(f"{study.name}.db"), write=True) as store:
        run(
            study,
            store,
            engine=engine,
            progress=lambda done, total: context.progress(study.name, done, total),
        )
        return list(table(store))
