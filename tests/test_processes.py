"""Children: nothing of the working folder runs in them, and they end with their parent."""

import gc
import io
import os
import re
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from importlib.metadata import packages_distributions
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import surae
import surae_thesis
from surae import processes
from surae.base.errors import ComputationError, InputError
from surae.processes import Child, End, guarded, tell
from surae.processes.messages import received, send

PACKAGE = Path(surae.__file__).parent
THESIS = Path(surae_thesis.__file__).parent
SURAE = Path(sys.executable).with_name("surae")
ME = __name__
#: Seconds that anything may take on a computer that is busy with other things.
PATIENCE = 120.0
STUDY = """
protocol = "ramp-and-hold"
rate_hz = 50
starts = 1
subjects = {}
"""


@pytest.fixture
def child() -> Iterator[Child]:
    started = Child()
    yield started
    started.close()


@pytest.fixture(scope="module")
def shared_child() -> Iterator[Child]:
    """One for calls that leave it as it was."""
    started = Child()
    yield started
    started.close()


# What children call.


def echo(**values: Any) -> Any:
    return values


def messages(n: int) -> int:
    for i in range(n):
        tell({"i": i, "array": np.arange(i)})
    return n


def sleep() -> str:
    try:
        tell({"at": "work"})
        time.sleep(PATIENCE)
    except KeyboardInterrupt:
        return "the best so far"
    return "slept"


def deaf() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    tell({"at": "work"})
    time.sleep(PATIENCE)


def pause(seconds: float) -> None:
    time.sleep(seconds)


def work(seconds: float) -> str:
    end = time.process_time() + seconds
    while time.process_time() < end:
        pass
    return "done"


def crash() -> None:
    os.kill(os.getpid(), signal.SIGSEGV)


def refuse() -> None:
    raise InputError("this is\nwrong")


def fail() -> None:
    raise LookupError("name of a patient")


def half(value: float) -> object:
    return object() if value else float("nan")


def much(mib: int) -> int:
    return len(bytearray(mib * 2**20))


def shout() -> str:
    print("in between")
    os.system("echo in between")
    return "quiet"


def environment() -> dict[str, Any]:
    return {
        "safe": sys.flags.safe_path,
        "inherited": os.environ.get("PYTHONSAFEPATH"),
        "path": sys.path,
        "threads": os.environ["OPENBLAS_NUM_THREADS"],
        "group": os.getpgrp() == os.getpid(),
    }


def grandchild() -> int:
    inner = Child()
    inner.call(f"{ME}:echo", {})
    tell({"inner": inner.process})
    time.sleep(PATIENCE)
    return 0


# What is sent and comes back.


def test_plain_data_and_arrays_pass(shared_child) -> None:
    given = {
        "numbers": [1, 2.5, -0.0, 1e-300, True, None],
        "text": "Änderung\n",
        "data": bytes(range(256)),
        "inside": {"a": [np.array([[1.0, np.nan]]), np.arange(3, dtype="<i2")]},
        "none": np.zeros((0, 3)),
        "bits": np.array([True, False]),
    }
    end = shared_child.call(f"{ME}:echo", given)
    assert (end.how, end.message) == ("done", "")
    assert {k: v for k, v in end.value.items() if k in ("numbers", "text", "data")} == {
        k: given[k] for k in ("numbers", "text", "data")
    }
    for got, sent in zip(end.value["inside"]["a"], given["inside"]["a"], strict=True):  # type: ignore[index]
        assert got.dtype == sent.dtype
        np.testing.assert_array_equal(got, sent)
    assert end.value["none"].shape == (0, 3)
    assert end.value["bits"].tolist() == [True, False]


def test_messages_come_in_order(shared_child) -> None:
    heard: list[Any] = []
    end = shared_child.call(f"{ME}:messages", {"n": 50}, hear=heard.append)
    assert end == End("done", 50)
    assert [(m["i"], len(m["array"])) for m in heard] == [(i, i) for i in range(50)]


def test_what_is_no_plain_data_is_an_error_here_and_there(shared_child) -> None:
    with pytest.raises(TypeError, match="object is no plain data"):
        shared_child.call(f"{ME}:echo", {"x": object()})
    for value in (0.0, 1.0):
        end = shared_child.call(f"{ME}:half", {"value": value})
        assert end.how == "failed"
        assert end.message.startswith("internal error")


def test_what_libraries_print_does_not_come_between(shared_child) -> None:
    assert shared_child.call(f"{ME}:shout", {}) == End("done", "quiet")


@pytest.mark.parametrize(
    "noise",
    [
        b"",
        b"\n",
        b"[1]\n",
        b'["{}", [["O", [9]]]]\n',
        b'["{}", [["<f8", [-1]]]]\n',
        b'["{}", [["<f8", [9999999]]]]\nx',
        b"[" * 100_000 + b"\n",
        b'["[]", []]\n',
        b'["{\\"told',
        b'["{\\"a\\": {\\"\\\\u0000piece\\": 5}}", []]\n',
    ],
)
def test_a_child_that_was_taken_over_sends_nothing_that_runs(noise) -> None:
    with pytest.raises(EOFError):
        received(io.BytesIO(noise))


# How calls end.


def test_errors_of_a_call(child) -> None:
    assert child.call(f"{ME}:refuse", {}) == End("refused", message="this is wrong")
    failed = child.call(f"{ME}:fail", {})
    assert (failed.how, failed.message) == ("failed", "internal error (LookupError); report it")
    assert "test_processes.py" in failed.where
    assert "patient" not in str(failed)
    process = child.process
    crashed = child.call(f"{ME}:crash", {})
    assert crashed.how == "killed"
    assert "killed or crashed" in crashed.message
    assert child.call(f"{ME}:echo", {}) == End("done", {})
    assert child.process != process
    late = child.call(f"{ME}:deaf", {}, seconds=0.3)
    assert (late.how, late.message[:16]) == ("killed", "it took too long")


@pytest.mark.skipif(sys.platform == "win32", reason="Windows counts by the clock alone")
def test_work_is_limited_and_not_the_wait_for_a_busy_machine(child) -> None:
    assert child.call(f"{ME}:pause", {"seconds": 0.0}).how == "done"  # it has started
    assert child.call(f"{ME}:pause", {"seconds": 0.5}, seconds=0.3).how == "done"
    late = child.call(f"{ME}:work", {"seconds": 30.0}, seconds=0.3)
    assert (late.how, late.message[:16]) == ("killed", "it took too long")
    assert child.call(f"{ME}:work", {"seconds": 0.5}).value == "done"  # no limit, none left


@pytest.mark.skipif(sys.platform != "linux", reason="memory is limited by Linux only")
def test_memory_is_limited_for_the_call_that_asks(shared_child) -> None:
    limited = shared_child.call(f"{ME}:much", {"mib": 4000}, memory=2 * 2**30)
    assert limited.how == "failed"
    assert limited.message.startswith("not enough memory")
    assert shared_child.call(f"{ME}:much", {"mib": 10}).value == 10 * 2**20


def test_an_interrupt_is_ctrl_c_for_the_call_at_work_only(child) -> None:
    child.interrupt()  # nobody is at work
    end = child.call(f"{ME}:sleep", {}, hear=lambda _: child.interrupt())
    assert end == End("done", "the best so far")
    assert child.process is None  # what was interrupted is not trusted again
    assert child.call(f"{ME}:echo", {"a": 1}) == End("done", {"a": 1})


def test_an_interrupt_that_comes_before_its_call_is_at_work_waits_for_it() -> None:
    """A new process takes a moment to start: who stopped a fit by then waited for 20 s."""
    code = (
        f"import sys, os; sys.path[:] = {sys.path!r}; "
        "from surae.processes.inside import serve; serve(os.getppid(), 0)"
    )
    with subprocess.Popen(
        [sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as process:
        assert process.stdin is not None
        assert process.stdout is not None
        call = {"function": f"{ME}:echo", "arguments": {"a": 1}, "memory": None, "seconds": None}
        send(process.stdin, {"interrupt": 2})  # of a call to come, and not of the first
        send(process.stdin, {"call": 1, **call})
        assert received(process.stdout) == {"how": "done", "value": {"a": 1}}
        send(process.stdin, {"call": 2, **call})
        assert received(process.stdout)["how"] == "cancelled"
        send(process.stdin, {"call": 3, **call})
        assert received(process.stdout) == {"how": "done", "value": {"a": 1}}
        process.stdin.close()


def test_who_does_not_listen_is_killed(child, monkeypatch) -> None:
    monkeypatch.setattr("surae.processes.child._PATIENCE", 0.2)
    end = child.call(f"{ME}:deaf", {}, hear=lambda _: child.interrupt())
    assert end.how == "killed"


def test_a_call_that_is_cancelled_before_it_begins_does_not() -> None:
    child = Child()
    assert child.call(f"{ME}:echo", {}, unless=lambda: True).how == "cancelled"
    assert child.process is None
    child.close()
    assert child.call(f"{ME}:echo", {}).how == "cancelled"  # closed: no process is left behind
    assert child.process is None


def test_a_child_is_made_anew_after_some_calls() -> None:
    child = Child(calls=2)
    numbers = []
    for _ in range(4):
        child.call(f"{ME}:echo", {})
        numbers.append(child.process)
    child.close()
    assert numbers[1] is numbers[3] is None
    assert numbers[0] != numbers[2]


def test_a_child_that_is_forgotten_is_not_left_behind() -> None:
    child = Child()
    child.call(f"{ME}:echo", {})
    number, unclosed = child.process, [child]
    unclosed.append(unclosed)  # a cycle, in which what is collected first is anybody's guess
    del child, unclosed
    gc.collect()
    assert gone([number], 5.0)


def test_a_guarded_call_raises_what_the_function_does() -> None:
    assert guarded(f"{ME}:echo", {"a": [1]}) == {"a": [1]}
    with pytest.raises(InputError, match=r"^this is wrong$"):
        guarded(f"{ME}:refuse", {})
    with pytest.raises(ComputationError, match=r"internal error \(LookupError\).*test_processes"):
        guarded(f"{ME}:fail", {})
    with pytest.raises(ComputationError, match="killed or crashed"):
        guarded(f"{ME}:crash", {})


def nested(function: str, **limits: Any) -> Any:
    return guarded(f"{ME}:{function}", {}, **limits)


def number() -> int:
    return os.getpid()


def greedy() -> int:
    return much(2048)


def test_the_limits_of_a_guarded_call_hold_in_a_child_too(child) -> None:
    inner = child.call(f"{ME}:nested", {"function": "number"}, memory=4 * 2**30, seconds=60.0).value
    assert inner not in (child.process, os.getpid())
    for function, limits, why in (
        ("deaf", {"seconds": 0.3}, "took too long"),
        ("greedy", {"memory": 2**30}, "not enough memory"),
    ):
        end = child.call(f"{ME}:nested", {"function": function, **limits})
        assert end.how == "failed"
        assert why in end.message
    inner = child.call(f"{ME}:nested", {"function": "number"}).value
    child.close()
    assert gone([inner], 5.0)


def test_ctrl_c_waits_for_what_must_not_be_left_half_done() -> None:
    done = []

    def press_and_go_on() -> None:
        with processes.without_interrupt():
            signal.raise_signal(signal.SIGINT)
            done.append(True)

    with pytest.raises(KeyboardInterrupt):
        press_and_go_on()
    assert done
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


# Nothing of the working folder runs.


def test_a_child_has_a_safe_path(child, tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [str(tmp_path), "", "relative", *sys.path])
    told = child.call(f"{ME}:environment", {}).value
    assert told["safe"]
    assert told["inherited"] == "1"
    assert told["threads"] == "1"
    assert not {"", "relative", str(tmp_path)} & set(told["path"])
    if os.name == "posix":
        assert told["group"]  # Ctrl-C in the terminal does not reach it


def planted(folder: Path) -> Path:
    """Put a module of every name there is into a folder; the file that tells which ran."""
    names = {name.partition(".")[0] for name in (*sys.modules, *packages_distributions())}
    names |= set(sys.stdlib_module_names) | {"sitecustomize", "usercustomize"}
    told = folder / "told.txt"
    for name in names - {"surae", "__main__"}:
        if name.isidentifier():
            (folder / f"{name}.py").write_text(
                f"with open({str(told)!r}, 'a') as told:\n    print({name!r}, file=told)\n"
            )
    assert {"numpy", "numba", "json", "typing", "uvicorn"} <= {p.stem for p in folder.iterdir()}
    return told


def settled(process: "subprocess.Popen[str]", until: Callable[[], bool]) -> None:
    end = time.monotonic() + PATIENCE
    while process.poll() is None and not until():
        assert time.monotonic() < end
        time.sleep(0.05)


@pytest.mark.slow
@pytest.mark.skipif(not SURAE.exists(), reason="no surae command beside this Python")
def test_a_study_runs_nothing_of_its_folder(tmp_path) -> None:
    told = planted(tmp_path)
    (tmp_path / "s.toml").write_text(STUDY.format(3), encoding="utf-8")
    done = subprocess.run(
        [SURAE, "study", "run", "s.toml", "--store", "s.db", "--workers", "2"],
        cwd=tmp_path,
        check=False,
        capture_output=True,
        text=True,
        timeout=PATIENCE,
    )
    assert (done.returncode, told.exists()) == (0, False), done.stderr
    assert "3 fits, all there" in done.stdout


def test_calls_of_a_script_run_nothing_of_its_folder(tmp_path) -> None:
    """A script's folder is on its own path; children that start in it do not import from it."""
    script = tmp_path / "analyse.py"
    script.write_text(
        "import sys\nfolder = sys.path.pop(0)\n"  # so that it can import ours at all
        "from surae.processes import Child\nsys.path.insert(0, folder)\nchild = Child()\n"
        "print(child.call('numpy:__name__.upper', {}).how, child.call('json:dumps', "
        "{'obj': 1}).value)\n"
    )
    told = planted(tmp_path)
    done = subprocess.run(
        [sys.executable, script],
        cwd=tmp_path,
        check=False,
        capture_output=True,
        text=True,
        timeout=PATIENCE,
    )
    assert (done.stdout, told.exists()) == ("failed 1\n", False), done.stderr


@pytest.mark.slow
@pytest.mark.skipif(not SURAE.exists(), reason="no surae command beside this Python")
def test_the_workbench_runs_nothing_of_its_folder(tmp_path) -> None:
    httpx = pytest.importorskip("httpx")
    told = planted(tmp_path)
    with subprocess.Popen(
        [SURAE, "serve", "project", "--port", "0", "--no-open"],
        cwd=tmp_path,
        text=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
    ) as server:
        try:
            assert server.stdout is not None
            line = server.stdout.readline()
            address = re.search(r"http://[\d.]+:\d+", line)
            assert address, line
            with httpx.Client(base_url=address[0], timeout=PATIENCE) as browser:
                browser.get("/")
                headers = {"X-CSRF-Token": browser.get("/api/session").json()["csrf"]}
                made = browser.post("/api/demo", headers=headers)
                assert made.status_code < 300, made.text  # made in a child
        finally:
            server.terminate()
    assert not told.exists(), told.read_text()


# Killed means ended.


def gone(pids: list[int], seconds: float) -> bool:
    psutil = pytest.importorskip("psutil")
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        living = [
            p
            for p in pids
            if psutil.pid_exists(p) and psutil.Process(p).status() != psutil.STATUS_ZOMBIE
        ]
        if not living:
            return True
        time.sleep(0.05)
    return False


@pytest.mark.slow
@pytest.mark.skipif(not SURAE.exists(), reason="no surae command beside this Python")
def test_a_study_that_is_killed_leaves_no_process_and_lets_go_of_its_pipe(tmp_path) -> None:
    psutil = pytest.importorskip("psutil")
    (tmp_path / "s.toml").write_text(STUDY.format(5000), encoding="utf-8")
    run = f"{SURAE} study run s.toml --store s.db --workers 2"
    with subprocess.Popen(
        ["bash", "-c", f"{run} 2>&1 & echo $!; wait"],
        cwd=tmp_path,
        text=True,
        stdout=subprocess.PIPE,
        start_new_session=True,
    ) as shell:
        assert shell.stdout is not None
        parent = psutil.Process(int(shell.stdout.readline()))
        settled(shell, lambda: len(parent.children(recursive=True)) >= 2)
        time.sleep(1.0)  # among the fits
        children = [p.pid for p in parent.children(recursive=True)]
        assert len(children) >= 2
        parent.kill()
        begin = time.monotonic()
        shell.stdout.read()  # as `tee` does: until everybody has closed the pipe
        assert time.monotonic() - begin < 5.0
    assert gone(children, 5.0)


def test_grandchildren_end_too() -> None:
    psutil = pytest.importorskip("psutil")
    child, heard = Child(), []

    def hear(message: Any) -> None:
        heard.append(message["inner"])
        psutil.Process(child.process).kill()

    assert child.call(f"{ME}:grandchild", {}, hear=hear).how == "killed"
    assert gone(heard, 5.0)
    child.close()


@pytest.mark.skipif(sys.platform != "linux", reason="Linux alone kills with the parent")
def test_a_child_whose_parent_is_gone_before_it_looks_ends() -> None:
    code = "from surae.processes.inside import serve; serve(1 << 22, 0)"
    with subprocess.Popen(
        [sys.executable, "-P", "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as orphan:
        assert orphan.wait(PATIENCE) == 1


def test_without_linux_a_child_ends_with_its_input(monkeypatch) -> None:
    """What other systems have instead: nothing but standard input tells of the parent's end."""
    code = (
        "import sys; sys.platform = 'other'; from surae.processes.inside import serve; serve(0, 0)"
    )
    with subprocess.Popen(
        [sys.executable, "-P", "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as orphan:
        assert orphan.stdin is not None
        with pytest.raises(subprocess.TimeoutExpired):
            orphan.wait(1.0)
        orphan.stdin.close()
        assert orphan.wait(PATIENCE) == 0


def test_a_child_outlives_the_thread_that_asked_first(child) -> None:
    """Linux would end it with the thread that made it, were that not one that lasts."""
    thread = threading.Thread(target=lambda: child.call(f"{ME}:echo", {}))
    thread.start()
    thread.join()
    process = child.process
    time.sleep(0.5)
    assert child.call(f"{ME}:echo", {}) == End("done", {})
    assert child.process == process


def test_a_system_without_posix_signals_interrupts_too() -> None:
    """Windows has no `pthread_kill`: taken away in the child, Ctrl-C comes all the same."""
    code = (
        "import signal; del signal.pthread_kill, signal.pthread_sigmask; "
        f"import sys; sys.path[:] = {sys.path!r}; from surae.processes.inside import serve; "
        "import os; serve(os.getppid(), 0)"
    )
    with subprocess.Popen(
        [sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as process:
        assert process.stdin is not None
        assert process.stdout is not None
        call = {"call": 1, "function": f"{ME}:busy", "arguments": {}}
        send(process.stdin, call | {"memory": None, "seconds": None})
        assert received(process.stdout) == {"told": {"at": "work"}}
        send(process.stdin, {"interrupt": 1})
        assert received(process.stdout) == {"how": "done", "value": "the best so far"}
        process.stdin.close()


def busy() -> str:
    end = time.monotonic() + PATIENCE
    try:
        tell({"at": "work"})
        while time.monotonic() < end:
            time.sleep(0.01)
    except KeyboardInterrupt:
        return "the best so far"
    return "slept"


def test_processes_start_in_one_place_only() -> None:
    """Whoever starts one elsewhere leaves out what this guards."""
    starts = re.compile(
        r"\b(subprocess|multiprocessing|ProcessPoolExecutor|os\.(fork|spawn|exec|system|popen))"
        r"|loky|joblib|pthread_sigmask"
    )
    guilty = [
        str(source.relative_to(package))
        for package in (PACKAGE, *sorted(PACKAGE.parents[1].glob("[a-z]*/src/surae_*")))
        for source in package.rglob("*.py")
        if starts.search(source.read_text(encoding="utf-8"))
    ]
    assert guilty == ["processes/child.py"]


@pytest.mark.skipif(not hasattr(os, "register_at_fork"), reason="no fork here")
def test_a_copy_of_a_program_whose_child_is_at_work_has_a_child_of_its_own() -> None:
    code = (
        "import os, threading, time\n"
        f"import sys; sys.path.insert(0, {str(Path(__file__).parent)!r})\n"
        "from surae.processes import Child, guarded\n"
        f"own, slow, quick = Child(), '{ME}:sleep', '{ME}:echo'\n"
        "for call in (guarded, own.call):\n"
        "    threading.Thread(target=call, args=(slow, {}), daemon=True).start()\n"
        "time.sleep(2.0)\n"
        "if not os.fork():\n"
        "    told = guarded(quick, {'x': 1}), own.call(quick, {'x': 2}).value\n"
        "    print(told, flush=True)\n"
        "    os._exit(0)\n"
        "print(os.waitstatus_to_exitcode(os.wait()[1]), flush=True)\n"
        "os._exit(0)\n"
    )
    made = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=PATIENCE, check=False
    )
    assert made.stdout.splitlines() == ["({'x': 1}, {'x': 2})", "0"], made.stderr
