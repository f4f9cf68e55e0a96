"""The names that help shows are those of what they name."""

from surae import names
from surae.estimation import LOSSES
from surae.estimation.population import KNOWN
from surae.model import MODELS, ModelOptions, laboratory
from surae.model.anthropometry import FOOT_SHARE
from surae.studies.populations import POPULATIONS


def test_names_are_those_of_what_they_name() -> None:
    assert set(names.MODELS) == set(MODELS)
    assert names.AUTO == laboratory.AUTO
    assert names.NUISANCES == (laboratory.ALL, laboratory.NONE)
    assert set(names.LOSSES) == set(LOSSES)
    assert set(names.POPULATIONS) == set(KNOWN) == set(POPULATIONS)
    assert set(names.FOOT_SHARES) == set(FOOT_SHARE)


def test_the_first_choice_is_the_default() -> None:
    assert {name: getattr(ModelOptions(), name) for name in names.CHOICES} == {
        name: choices[0] for name, choices in names.CHOICES.items()
    }
