"""The names that help shows are those of what they name, and a type's name means one thing."""

import re
from collections import Counter
from pathlib import Path

import surae
from surae.base import names
from surae.inference import LOSSES
from surae.model import MODELS, ModelOptions, laboratory
from surae.model.parameters import OPTIONAL, OPTIONAL_PARAMETERS
from surae.model.registry import PARAMETERS
from surae.nerve.movements import PERTURBATIONS
from surae.planning.ready import ready_protocols
from surae.protocol import DEVICES, PROFILES, TASKS
from surae.studies.populations import POPULATIONS


def test_names_are_those_of_what_they_name() -> None:
    assert set(names.MODELS) == set(MODELS)
    assert names.AUTO == laboratory.AUTO
    assert names.NUISANCES == (laboratory.ALL, laboratory.NONE)
    optional = {p.name: p for p in OPTIONAL_PARAMETERS}
    assert set(names.DRIVES) == {
        group for group, of in OPTIONAL.items() if optional[of[0]].group != "measurement"
    }
    assert set(names.LOSSES) == set(LOSSES)
    assert set(names.POPULATIONS) == set(POPULATIONS)
    assert {of for p in PARAMETERS.values() for of in (*p.known, *p.drawn)} == set(POPULATIONS)
    assert (*names.PROFILES,) == (*PROFILES,)
    assert (*names.DESIGNED,) == (*ready_protocols(),)
    assert (*names.TELLING,) == (*PERTURBATIONS, "stretches")
    assert (*names.TASKS,) == (*TASKS,)
    assert (*names.DEVICES,) == (*DEVICES,)


def test_the_first_choice_is_the_default() -> None:
    assert {name: getattr(ModelOptions(), name) for name in names.CHOICES} == {
        name: choices[0] for name, choices in names.CHOICES.items()
    }


def test_no_two_public_types_share_a_name() -> None:
    sources = Path(surae.__file__).parent.rglob("*.py")
    texts = [source.read_text(encoding="utf-8") for source in sources]
    types = [name for text in texts for name in re.findall(r"^ *class ([A-Za-z]\w*)", text, re.M)]
    assert len(types) > 200
    assert [name for name, count in Counter(types).items() if count > 1] == []
