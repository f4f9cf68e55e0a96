"""First compilations begun two at a time and killed at random: the next one is right each time.

Few kernels stand for all: a whole first fit compiles for 20 s, and five pairs of those were killed
too (decision 14). What is written, read and replaced is the same code.
"""

import os
import random
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import pytest

KERNELS = """
import numpy as np
from surae.model.jit import inner, jit


@inner
def half(x):
    return 0.5 * x


@jit
def total(values):
    s = 0.0
    for value in values:
        s += half(value)
    return s


@jit
def largest(values):
    most = values[0]
    for value in values:
        most = max(most, value)
    return most


@jit
def scaled(values, by):
    made = np.empty_like(values)
    for k in range(len(values)):
        made[k] = by * values[k]
    return made


values = np.linspace(0.0, 3.0, 301)
print(f"{total(values)!r} {largest(values)!r} {total(scaled(values, 4.0))!r}", flush=True)
"""
RIGHT = "225.75 3.0 903.0"


def begun(script: Path, cache: Path) -> "subprocess.Popen[str]":
    return subprocess.Popen(
        [sys.executable, str(script)],
        env={**os.environ, "SURAE_CACHE": str(cache)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def numbers(text: str) -> list[float]:
    return [float(word.removeprefix("np.float64(").rstrip(")")) for word in text.split()]


@pytest.mark.slow
def test_what_two_begin_and_are_killed_in_is_right_the_next_time(tmp_path) -> None:
    script = tmp_path / "kernels_of_a_test.py"
    script.write_text(KERNELS, encoding="utf-8")
    chance = random.Random(71)
    start = time.monotonic()
    out, err = begun(script, tmp_path / "whole").communicate(timeout=300)
    whole = time.monotonic() - start
    assert numbers(out) == numbers(RIGHT), err
    killed = 0
    for pair in range(20):
        cache = tmp_path / f"cache {pair}"
        both = [begun(script, cache) for _ in range(2)]
        for one in both[: 1 + pair % 2]:  # one of them, or both
            time.sleep(chance.uniform(0.0, 1.1 * whole / 2))
            with suppress(ProcessLookupError):
                os.kill(one.pid, signal.SIGKILL)
        for one in both:
            out, err = one.communicate(timeout=300)
            killed += one.returncode == -signal.SIGKILL
            assert one.returncode in (0, -signal.SIGKILL), err
            assert one.returncode or numbers(out) == numbers(RIGHT), err
        out, err = begun(script, cache).communicate(timeout=300)
        assert numbers(out) == numbers(RIGHT), err
    assert killed >= 15
