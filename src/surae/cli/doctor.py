"""`surae doctor`."""

import os
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec

import click

from surae import api
from surae.cli.progress import compilation_notice, work
from surae.cli.screen import show_line

#: Extra → packages that it brings, as imported and as distributed.
EXTRAS = {
    "formats": (("edfio", "edfio"), ("pyarrow", "pyarrow"), ("pyxdf", "pyxdf")),
    "pdf": (("typst", "typst"),),
    "bayes": (("nutpie", "nutpie"), ("arviz_stats", "arviz-stats")),
    "cluster": (("distributed", "distributed"),),
}
WORKBENCH = (("surae_workbench", "surae-workbench"), ("pylsl", "pylsl"))
#: Part of a parameter's true value within which it counts as found back.
_CLOSE = 0.01


@click.command("doctor")
def command() -> int:
    """Say what this installation has, and fit a small trial to see that it works.

    Exit code 1 where the trial's parameters are not found back.
    """
    from surae.versions import versions

    show_line("versions: " + ", ".join(f"{name} {text}" for name, text in versions().items()))
    show_line(f"processors: {_processors()}")
    for name, packages in EXTRAS.items():
        show_line(f"extra {name}: {_extra(f'surae[{name}]', packages)}")
    show_line(f"workbench: {_extra('surae-workbench[live]', WORKBENCH)}")

    folder = api.cache_folder()
    sizes = [path.stat().st_size for path in folder.rglob("*") if path.is_file()]
    show_line(f"compiled kernels: {folder}, {len(sizes)} files, {sum(sizes) / 1e6:.1f} MB")
    return _self_test()


def _processors() -> str:
    usable = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    return f"{usable} usable of {os.cpu_count()}"


def _extra(requirement: str, packages: tuple[tuple[str, str], ...]) -> str:
    missing = [package for module, package in packages if find_spec(module) is None]
    if missing:
        return f'not installed (no {", ".join(missing)}): pip install "{requirement}"'
    return ", ".join(f"{package} {_version(package)}" for _, package in packages)


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "of unknown version"


def _self_test() -> int:
    """Fit a virtual trial without noise: every parameter must come back."""
    from time import perf_counter

    subject = api.virtual_subject(seed=1)
    protocol = api.Protocol(profile="multiple-holds", chirp_amplitude=0.1, rate_hz=64.0)
    trial = api.virtual_trial(subject, api.generate(protocol), noise=0.0)
    with work() as progress, compilation_notice():
        progress.describe("fitting a small trial")
        begin = perf_counter()
        fitted = api.fit(trial, model="muscle", starts=2, progress=progress.starts)
        seconds = perf_counter() - begin
    off = {
        name: abs(fitted.values[name] / truth - 1.0) for name, truth in subject.parameters.items()
    }
    worst = max(off, key=lambda name: off[name])
    if off[worst] < _CLOSE:
        show_line(f"self-test: passed in {seconds:.2g} s; every parameter found back")
        return 0
    show_line(f"self-test: FAILED; {worst} is {100 * off[worst]:.2g} % off its true value")
    return 1
