"""The on-disk cache of compiled kernels: named by its source, never stale, always writable."""

import ast
import errno
import importlib
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import surae
from surae.model import jit, kernel_cache

PACKAGE = Path(surae.__file__).parent


@pytest.fixture
def fresh(tmp_path, monkeypatch) -> Iterator[Path]:
    """A copy of the package's sources as the package, an empty cache, nothing remembered.

    What kernels neither are nor need is left out.
    """
    package = tmp_path / "surae"
    others = ("__pycache__", "report", "recording", "quality", "measures", "studies", "cli", "api")
    shutil.copytree(PACKAGE, package, ignore=shutil.ignore_patterns(*others))
    monkeypatch.setattr(kernel_cache, "_PACKAGE", package)
    monkeypatch.setenv("SURAE_CACHE", str(tmp_path / "cache"))
    kernel_cache.cache_folder.cache_clear()
    yield package
    kernel_cache.cache_folder.cache_clear()


def folder_now() -> Path:
    kernel_cache.cache_folder.cache_clear()
    folder = kernel_cache.cache_folder()
    assert folder is not None
    return folder


def test_folder_lies_in_the_cache_and_is_stable(fresh, tmp_path) -> None:
    folder = folder_now()
    assert folder.is_dir()
    assert folder.parent == tmp_path / "cache" / "surae"
    assert folder_now() == folder


@pytest.mark.parametrize("source", ["model/contraction.py", "model/rigid.py", "model/jit.py"])
def test_another_source_is_another_folder(fresh, source) -> None:
    before = folder_now()
    text = (fresh / source).read_text(encoding="utf-8")
    (fresh / source).write_text(text + "\n# changed\n", encoding="utf-8")
    assert folder_now() != before
    (fresh / source).write_text(text, encoding="utf-8")
    assert folder_now() == before


def test_a_new_source_is_another_folder(fresh) -> None:
    before = folder_now()
    source = fresh / "inference" / "another_kernel.py"
    source.write_text("from surae.model.jit import jit\nx = 1\n", encoding="utf-8")
    assert folder_now() != before


@pytest.mark.parametrize(
    "source", ["model/registry.py", "model/parameters.py", "inference/least_squares/fit.py"]
)
def test_a_sentence_elsewhere_compiles_nothing_again(fresh, source) -> None:
    before = folder_now()
    text = (fresh / source).read_text(encoding="utf-8")
    (fresh / source).write_text(text + "\n# changed\n", encoding="utf-8")
    assert folder_now() == before


def test_folders_that_nobody_uses_are_removed(fresh, tmp_path) -> None:
    root = tmp_path / "cache" / "surae"
    ages = {"kernels-new": 0.5, "kernels-a": 3.0, "kernels-b": 30.0, "kernels-c": 90.0}
    for name, days in ages.items():
        (root / name).mkdir(parents=True)
        (root / name / "code.nbc").write_bytes(b"machine code")
        then = time.time() - 86400 * days
        os.utime(root / name, (then, then))
    (root / "not-ours").mkdir()
    now = folder_now()
    left = {path.name for path in root.iterdir()}
    assert left == {now.name, "kernels-new", "kernels-a", "not-ours"}


def test_other_versions_are_another_folder(fresh, monkeypatch) -> None:
    before = folder_now()
    monkeypatch.setattr(jit.numba, "__version__", "0.0.1")
    other_numba = folder_now()
    monkeypatch.setattr(kernel_cache.platform, "python_version", lambda: "3.99.0")
    assert len({before, other_numba, folder_now()}) == 3


def test_a_relative_cache_does_not_follow_the_working_directory(
    fresh, tmp_path, monkeypatch
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("SURAE_CACHE", "here")
    assert folder_now().parent == tmp_path / "here" / "surae"


def test_the_cache_of_the_desktop_is_used(fresh, tmp_path, monkeypatch) -> None:
    monkeypatch.delenv("SURAE_CACHE")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "xdg"))
    assert folder_now().parent == tmp_path / "xdg" / "surae"
    monkeypatch.delenv("XDG_CACHE_HOME")
    monkeypatch.setattr(Path, "home", lambda: tmp_path / "home")
    assert folder_now().parent == tmp_path / "home" / ".cache" / "surae"


def no_home() -> Path:
    raise RuntimeError("Could not determine home directory.")


@pytest.fixture
def temporary(fresh, tmp_path, monkeypatch) -> Path:
    """A user without a home; the folder of temporary files."""
    monkeypatch.delenv("SURAE_CACHE")
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    monkeypatch.setattr(Path, "home", no_home)
    folder = tmp_path / "temporary"
    folder.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    return folder


def test_without_a_home_the_temporary_folder_serves(temporary) -> None:
    folder = folder_now()
    assert folder.is_dir()
    assert temporary in folder.parents
    assert folder_now() == folder


def test_a_home_that_cannot_be_written_is_left_alone(temporary, tmp_path, monkeypatch) -> None:
    (tmp_path / "file").write_text("not a folder", encoding="utf-8")
    monkeypatch.setenv("SURAE_CACHE", str(tmp_path / "file"))
    assert temporary in folder_now().parents
    monkeypatch.setenv("SURAE_CACHE", str(tmp_path / "read-only"))
    real = os.access
    monkeypatch.setattr(os, "access", lambda p, how: "read-only" not in str(p) and real(p, how))
    assert temporary in folder_now().parents


needs_users = pytest.mark.skipif(
    not hasattr(os, "getuid"), reason="users have no number on this system"
)


def no_folder() -> bool:
    kernel_cache.cache_folder.cache_clear()
    return kernel_cache.cache_folder() is None


@needs_users
def test_every_folder_is_this_users_alone(fresh, tmp_path) -> None:
    previous = os.umask(0)  # as a careless laboratory's computer has it
    try:
        folder = folder_now()
    finally:
        os.umask(previous)
    assert [path.stat().st_mode & 0o777 for path in (folder, folder.parent)] == [0o700, 0o700]


@needs_users
def test_code_that_others_could_have_written_is_not_run(fresh) -> None:
    folder = folder_now()
    jit.jit(abs_of)(-1.0)
    assert any(folder.rglob("*.nbi.*"))
    folder.chmod(0o777)
    assert folder_now() == folder
    assert not any(folder.rglob("*.nbi.*"))
    assert folder.stat().st_mode & 0o777 == 0o700


@needs_users
def test_a_folder_whose_parent_others_may_write_is_not_used(
    temporary, tmp_path, monkeypatch
) -> None:
    shared = tmp_path / "shared"
    shared.mkdir()
    monkeypatch.setenv("SURAE_CACHE", str(shared))
    shared.chmod(0o777)  # who may rename its folders may put others there
    assert shared not in folder_now().parents
    shared.chmod(0o1777)  # as the folder of temporary files: each keeps what is his
    assert shared in folder_now().parents


@needs_users
def test_the_temporary_folder_is_no_link(temporary) -> None:
    private = temporary / f"surae-{os.getuid()}"
    assert folder_now().parent == private
    shutil.rmtree(private)
    elsewhere = temporary / "elsewhere"
    elsewhere.mkdir(mode=0o700)
    private.symlink_to(elsewhere)
    assert no_folder()
    assert not any(elsewhere.iterdir())
    assert {path.name for path in temporary.iterdir()} == {private.name, "elsewhere"}


@needs_users
def test_without_a_private_folder_kernels_are_compiled_in_memory(
    temporary, monkeypatch, caplog
) -> None:
    mine = folder_now().parent
    me = os.getuid()
    monkeypatch.setattr(os, "getuid", lambda: me + 1)
    mine.rename(temporary / f"surae-{me + 1}")  # somebody else's
    assert no_folder()
    kernel_cache.say_unsaved.cache_clear()
    jit.compile_all.cache_clear()
    jit.compile_all()
    assert jit.jit(abs_of)(-1.0) == 1.0
    assert [path.name for path in temporary.iterdir()] == [f"surae-{me + 1}"]
    assert len(caplog.messages) == 1
    assert "SURAE_CACHE" in caplog.messages[0]
    jit.compile_all.cache_clear()


def cut(content: bytes) -> bytes:
    return content[: len(content) // 2]


def emptied(content: bytes) -> bytes:
    return content[:0]


def noise(content: bytes) -> bytes:
    return np.random.default_rng(7).bytes(len(content))


@pytest.mark.parametrize("damage", [cut, emptied, noise])
def test_a_damaged_file_is_compiled_again_and_replaced(fresh, damage) -> None:
    jit.jit(abs_of)(-1.0)
    [path] = folder_now().rglob("*.nbi.*")
    whole = path.read_bytes()
    path.write_bytes(damage(whole))
    again = jit.jit(abs_of)
    assert again(-2.0) == 2.0
    assert sum(again.stats.cache_misses.values()) == 1
    third = jit.jit(abs_of)
    assert third(-3.0) == 3.0
    assert sum(third.stats.cache_hits.values()) == 1


def test_another_kernels_code_under_this_ones_name_is_not_run(fresh) -> None:
    jit.jit(abs_of)(-1.0)
    [mine] = folder_now().rglob("*.nbi.*")
    jit.jit(negative_of)(-1.0)
    [other] = set(folder_now().rglob("*.nbi.*")) - {mine}
    mine.write_bytes(other.read_bytes())
    assert jit.jit(abs_of)(-2.0) == 2.0


def test_a_full_disk_forbids_nothing(fresh, monkeypatch, caplog) -> None:
    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(kernel_cache.VerifiedFile, "_open_for_write", full)
    kernel_cache.say_unsaved.cache_clear()
    assert jit.jit(abs_of)(-1.0) == 1.0
    assert jit.jit(negative_of)(-1.0) == 1.0
    assert len(caplog.messages) == 1
    assert "no space left" in caplog.messages[0]
    assert str(folder_now()) in caplog.messages[0]


def test_systems_without_user_numbers(temporary, monkeypatch) -> None:
    monkeypatch.delattr(os, "getuid", raising=False)
    folder = folder_now()
    assert folder.is_dir()
    assert folder.parent == temporary / "surae"


def test_compilation_is_noticed_once_and_only_when_it_happens(fresh) -> None:
    told: list[str] = []
    kernel = jit.jit(abs_of)
    with kernel_cache.on_compilation(lambda: told.append("first")):
        kernel(-1.0)
        kernel(np.float32(-1.0))
    assert told == ["first"]
    with kernel_cache.on_compilation(lambda: told.append("second")):
        kernel(-2.0)
    assert told == ["first"]


def test_decorating_leaves_the_configuration_of_numba_alone(fresh) -> None:
    before = jit.numba.config.CACHE_DIR
    jit.jit(abs_of)
    assert before == jit.numba.config.CACHE_DIR


def abs_of(x: float) -> float:
    return abs(x)


def negative_of(x: float) -> float:
    return -x


def test_each_signature_has_a_file_of_its_own(fresh, tmp_path) -> None:
    # numba's index, written by two programs at once, may give one's machine code to the other
    one, other = jit.jit(abs_of), jit.jit(abs_of)
    one(-1.0), other(-1)
    files = sorted(path.name for path in (tmp_path / "cache").rglob("*.py*") if path.is_file())
    assert len(files) == 2
    both = jit.jit(abs_of)
    assert [both(-2.0), both(-2)] == [2.0, 2]
    assert [type(both(-2.0)), type(both(-2))] == [float, int]
    assert sum(both.stats.cache_hits.values()) == 2
    assert not both.stats.cache_misses


def test_one_of_another_name_or_none_is_compiled(fresh, tmp_path) -> None:
    jit.jit(abs_of)(-1.0)
    for path in (tmp_path / "cache").rglob("*.py*"):
        if path.is_file():
            path.rename(path.with_name("half-written.tmp"))
    again = jit.jit(abs_of)
    assert again(-1.0) == 1.0
    assert sum(again.stats.cache_misses.values()) == 1


@pytest.fixture
def halves(fresh, monkeypatch) -> Iterator[list[int]]:
    """Which halves are compiled, in whatever process."""
    asked: list[int] = []

    class Asked:
        """A child that notes what it is asked."""

        def __init__(self, calls: int) -> None:
            assert calls == 1

        def call(self, function: str, arguments: dict[str, int]) -> None:
            assert function == "surae.model.jit:compile_half"
            asked.append(arguments["half"])

        def close(self) -> None:
            """Nothing is open."""

    monkeypatch.setattr("surae.processes.Child", Asked)
    monkeypatch.setattr(jit, "compile_half", asked.append)
    jit.compile_all.cache_clear()
    yield asked
    jit.compile_all.cache_clear()


def test_both_halves_are_compiled_once_for_a_folder(halves) -> None:
    jit.compile_all()
    assert sorted(halves) == [0, 1]
    jit.compile_all.cache_clear()  # another program
    jit.compile_all()
    assert sorted(halves) == [0, 1]


def test_what_was_interrupted_is_compiled_the_next_time(halves, monkeypatch) -> None:
    def interrupted(half: int) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(jit, "compile_half", interrupted)
        with pytest.raises(KeyboardInterrupt):
            jit.compile_all()
    halves.clear()
    jit.compile_all()
    assert sorted(halves) == [0, 1]


LISTED = [
    line.split()
    for line in (PACKAGE / "model" / "kernels.txt").read_text(encoding="utf-8").splitlines()
    if line
]


def test_what_is_compiled_ahead_exists_and_takes_as_many_arguments() -> None:
    assert len({name for name, *_ in LISTED}) == len(LISTED) == 13
    for name, *given in LISTED:
        module, kernel = name.split(":")
        function = getattr(importlib.import_module(f"surae.{module}"), kernel).py_func
        assert function.__code__.co_argcount == len(given), name


def test_kernels_use_nothing_that_is_slow_to_compile() -> None:
    # a product of matrices or what is written to a slice compiles as long as all else together
    for source in PACKAGE.rglob("*.py"):
        text = source.read_bytes()
        if kernel_cache._IMPORT not in text:
            continue
        for node in ast.walk(ast.parse(text)):
            named = [ast.unparse(d) for d in getattr(node, "decorator_list", ())]
            if not any("jit" in name or name == "inner" for name in named):
                continue
            for part in ast.walk(node):
                where = f"{source.name}:{getattr(part, 'lineno', 0)}"
                assert not isinstance(part, ast.MatMult), where
                written = isinstance(part, ast.Subscript) and isinstance(part.ctx, ast.Store)
                assert not (written and isinstance(part.slice, ast.Slice)), where
                assert not (isinstance(part, ast.Attribute) and part.attr == "linalg"), where


FIRST_FIT = """
from numba.core import event
from surae import api
from surae.model import jit, kernel_cache

jit.compile_all()
compiled = []

class Listener(event.Listener):
    def on_start(self, told):
        compiled.append(told.data["dispatcher"].py_func.__name__)
    def on_end(self, told):
        pass

with event.install_listener("numba:compile", Listener()):
    protocol = api.Protocol(profile="multi-sine", duration=20.0)
    trial = api.virtual_trial(api.virtual_subject(seed=1), api.generate(protocol))
    api.fit(trial).measures()
print(compiled)
"""


@pytest.mark.slow
def test_a_first_fit_compiles_nothing_that_was_not_compiled_ahead(tmp_path) -> None:
    done = subprocess.run(
        [sys.executable, "-c", FIRST_FIT],
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, "SURAE_CACHE": str(tmp_path / "cache")},
    )
    assert done.stdout.split("\n")[-2] == "[]"
    files = [path.name for path in (tmp_path / "cache").rglob("*.py*") if path.is_file()]
    kernels = [name.split("-")[0] for name in files]
    assert len(set(kernels)) == len(kernels) == 60  # one signature each


RUN = """
from surae.model import upper
print(upper.twice(3.0), sum(upper.twice.stats.cache_hits.values()))
"""


@pytest.mark.slow  # in the fast suite another source is another folder
def test_a_changed_helper_is_never_served_from_the_cache(fresh, tmp_path) -> None:
    # numba alone would: it looks only at the file of the function that is called
    head = "from surae.model.jit import jit\n"
    lower = fresh / "model" / "lower.py"
    lower.write_text(f"{head}@jit\ndef part(x):\n    return x\n", encoding="utf-8")
    (fresh / "model" / "upper.py").write_text(
        f"{head}from surae.model.lower import part\n@jit\ndef twice(x):\n    return 2 * part(x)\n",
        encoding="utf-8",
    )

    def run() -> list[str]:
        code = f"import sys; sys.path.insert(0, {str(tmp_path)!r})\n{RUN}"
        done = subprocess.run(
            [sys.executable, "-B", "-c", code], capture_output=True, text=True, check=True
        )
        return done.stdout.split()

    assert run() == ["6.0", "0"]
    assert run() == ["6.0", "1"]
    lower.write_text(f"{head}@jit\ndef part(x):\n    return -x\n", encoding="utf-8")
    assert run() == ["-6.0", "0"]


def imports(source: Path) -> list[tuple[str, str]]:
    """Module and name of whatever a file imports by name."""
    tree = ast.parse(source.read_text(encoding="utf-8"))
    nodes = [node for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)]
    return [(node.module or "", alias.name) for node in nodes for alias in node.names]


def test_every_kernel_lies_in_a_folder_that_names_the_cache() -> None:
    sources = [
        source
        for source in PACKAGE.rglob("*.py")
        if b"surae.model.jit" in source.read_bytes()
        and {("surae.model.jit", "jit"), ("surae.model.jit", "inner")} & {*imports(source)}
    ]
    assert all(kernel_cache._IMPORT in source.read_bytes() for source in sources)
    modules = {".".join(("surae", *s.relative_to(PACKAGE).with_suffix("").parts)) for s in sources}
    kernels = {*modules, "surae.model.jit"}
    numbers = {
        (".".join(("surae", *source.removesuffix(".py").split("/"))), name)
        for source, names in kernel_cache._CONSTANTS.items()
        for name in names
    }
    hashed = {PACKAGE / folder for folder in kernel_cache._KERNEL_FOLDERS}
    assert len(sources) >= 4
    assert {source.parent for source in sources} <= hashed
    for source in sources:  # nor do kernels read constants from elsewhere in the package
        for module, name in imports(source):
            if module.startswith("surae."):
                inside = module in kernels or (module, name) in numbers
                assert inside or name.endswith("Array"), f"{source.name} imports {name}"


def test_a_number_from_elsewhere_compiles_anew() -> None:
    lines = list(kernel_cache._constants())
    assert b"GRAVITY = 9.81" in lines
    assert len(lines) == len({*lines}) == sum(map(len, kernel_cache._CONSTANTS.values()))


def test_no_other_numba_decorator() -> None:
    made = re.compile(
        r"\b(numba|nb)\.(n?jit|(gu)?vectorize|cfunc|stencil)\b|^\s*from numba\b", re.M
    )
    for source in PACKAGE.rglob("*.py"):
        if source.name not in ("jit.py", "kernel_cache.py"):
            assert not made.search(source.read_text(encoding="utf-8")), source
