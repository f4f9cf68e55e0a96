"""An ordinary day with `surae live`, compressed: restarts, kills, lost streams, a full disk.

    python benchmarks/day.py FOLDER [--trials 24] [--seconds 8] [--minutes 60]

FOLDER is an empty folder on a small disk of its own (mount -t tmpfs -o size=200m tmpfs FOLDER). The
streams are real ones of LSL, in real time, of virtual legs; a trial lasts seconds instead of
minutes. With --minutes the trials are spread over so many, with rest between them as people need.
Prints a row for each trial, then what was lost.
"""

import argparse
import contextlib
import json
import os
import signal
import subprocess
import sys
import threading
import time
from functools import partial
from pathlib import Path

SESSION = "SURAE_LSL_SESSION"
DEVICE, EMG = ("angle", "torque"), ("emg_ta", "emg_gl", "emg_sol", "emg_gm")
UNITS = {"angle": "rad", "torque": "Nm"}
REST = 6.0


class Streams:
    """A manipulator and an amplifier that send one trial after another, and do as they are told."""

    def __init__(self, seconds):
        self.seconds = seconds
        import numpy as np

        from surae.api import Protocol, generate, virtual_recording, virtual_subject
        from surae_workbench.live.lsl import lsl

        self.np, self.clock = np, lsl().local_clock
        self.made, self.begin, self.off, self.kind = {}, None, None, "active"
        for task in ("passive", "active"):
            profile = "sine" if task == "passive" else "multiple-holds"
            asked = generate(Protocol(profile=profile, task=task, duration=seconds, rate_hz=1024.0))
            channels = virtual_recording(virtual_subject(3), asked, seed=1).channels
            signals = np.column_stack([channels[r].values for r in (*DEVICE, *EMG)])
            self.made[task] = (asked, signals)
        self.order, self.out, self.sent = list(EMG), {}, 0
        for name in ("manipulator", "EMG"):
            self.open(name)
        threading.Thread(target=self.run, daemon=True).start()

    def open(self, name):
        from surae_workbench.live.lsl import outlet

        labels = list(DEVICE) if name == "manipulator" else self.order
        units = [UNITS.get(label, "V") for label in labels]
        self.out[name] = outlet(name, "x", labels, units, 1024.0, f"day {name}")

    def lose(self, name, seconds, order=None):
        self.out[name] = None
        if order:
            self.order = order
        threading.Timer(seconds, self.open, (name,)).start()

    def run(self):
        np, start = self.np, self.clock()
        rng = np.random.default_rng(1)
        while True:
            time.sleep(0.01)
            due = int((self.clock() - start) * 1024.0)
            if due <= self.sent:
                continue
            times = start + np.arange(self.sent, due) / 1024.0
            self.sent = due
            _, signals = self.made[self.kind]
            rows = np.tile(signals[0] * [1, 1, 0, 0, 0, 0], (len(times), 1))
            if self.begin is not None:
                index = np.round((times - self.begin) * 1024.0).astype(int)
                inside = (index >= 0) & (index < len(signals))
                rows[inside] = signals[index[inside]]
            rows[:, 2:] += 2e-6 * rng.standard_normal((len(times), 4))
            if self.off is not None:
                hum = np.sin(2 * np.pi * 50.0 * times)
                late = times >= self.off
                rows[late, 4] = 2e-3 * hum[late] + 1e-4 * rng.standard_normal(int(late.sum()))
            emg = [2 + EMG.index(label) for label in self.order]
            for name, columns in (("manipulator", [0, 1]), ("EMG", emg)):
                sender = self.out[name]
                if sender is not None:
                    sender.push_chunk(np.ascontiguousarray(rows[:, columns]), float(times[-1]))


def room(folder):
    """What is killed and started again: a room that is told what to do by lines."""
    from surae_workbench.live.room import Room

    def tell(event, data):
        if event in ("alarm", "disk", "lost", "back", "layout"):
            say({"event": event, "clock": made.trials.recorder.clock(), **data})

    def say(what):
        print(json.dumps(what, default=str), flush=True)

    made = Room(folder, joint=False, tell=tell)
    say(
        {
            "event": "began",
            "broken": made.trials.broken,
            "trials": {n: r.shown() for n, r in made.trials.trials.items()},
        }
    )
    for line in sys.stdin:
        word = json.loads(line)
        if word["do"] == "ready":
            until(
                lambda: (
                    len(
                        [
                            s
                            for s in made.trials.recorder.streams.values()
                            if s.state == "good" and s.kind == "x"
                        ]
                    )
                    >= 2
                    and made.trials.mapping
                    and made.trials.warm.done()
                )
            )
            say({"event": "ready"})
        elif word["do"] == "start":
            made.load(word["file"], beyond=True)
            number = made.start(0.3)
            say({"event": "started", "trial": number, "begin": made.begin})
        elif word["do"] == "mark":
            made.trials.mark(word["text"])
            say({"event": "marked"})
        elif word["do"] == "verdict":
            until(partial(made.trials.verdicts.__contains__, word["trial"]))
            say(
                {
                    "event": "verdict",
                    "trial": word["trial"],
                    **made.trials.verdicts[word["trial"]].result(),
                }
            )
        elif word["do"] == "end":
            for verdict in made.trials.verdicts.values():
                verdict.result()
            made.close()
            say({"event": "ended"})
            return


def until(holds, seconds=120.0):
    end = time.monotonic() + seconds
    while not holds():
        if time.monotonic() > end:
            raise TimeoutError
        time.sleep(0.02)


class Program:
    """The room in a process of its own; what it says, by event."""

    def __init__(self, folder):
        self.said, self.new = [], threading.Condition()
        self.process = subprocess.Popen(
            [sys.executable, __file__, str(folder), "--room"],
            text=True,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=sys.stderr,
        )
        threading.Thread(target=self.hear, daemon=True).start()

    def hear(self):
        for line in self.process.stdout:
            with self.new:
                self.said.append(json.loads(line))
                self.new.notify_all()

    def wait(self, event, seconds=180.0):
        def found():
            return next((one for one in self.said if one["event"] == event), None)

        with self.new:
            if not self.new.wait_for(found, seconds):
                raise TimeoutError(event)
            one = found()
            self.said.remove(one)
            return one

    def do(self, word, event, **more):
        self.process.stdin.write(json.dumps({"do": word, **more}) + "\n")
        self.process.stdin.flush()
        return self.wait(event)


LOSSES = {2, 4, 5, 7, 8, 10, 11, 15, 17, 19}
LAYOUTS, KILLS, FULL = {6, 12, 18}, {3, 8, 13, 16, 20}, {14, 21}


def day(folder, trials, seconds, minutes):
    streams = Streams(seconds)
    from surae.api import write_protocol_csv

    files = {}
    for kind, (asked, _) in streams.made.items():
        files[kind] = folder.parent / f"day-{kind}.csv"
        write_protocol_csv(asked, files[kind])
    rows, marks, restarts, program = [], {}, 0, Program(folder)
    began = [program.wait("began")]
    first = time.monotonic()
    for n in range(1, trials + 1):
        time.sleep(max(0.0, first + 60.0 * minutes * (n - 1) / trials - time.monotonic()))
        row, number = trial(n, program, streams, folder, files)
        marks[number] = [f"mark {n}", f"again {n}"]
        rows.append(row)
        print(" | ".join(map(str, row)), flush=True)
        streams.off = streams.begin = None
        if n <= 20:
            restarts += 1
            if n not in KILLS:
                program.do("end", "ended")
                program.process.wait()
            program = Program(folder)
            began.append(program.wait("began"))
    program.do("end", "ended")
    program = Program(folder)  # what was killed is judged
    last = program.wait("began")
    program.do("end", "ended")
    report(folder, rows, marks, restarts, [*began, last], time.monotonic() - first)


def trial(n, program, streams, folder, files):
    """One trial of the day with what goes wrong in it: its row, and its number."""
    program.do("ready", "ready")
    streams.kind = "passive" if n == 1 else "active"
    told = program.do("start", "started", file=str(files[streams.kind]))
    number, streams.begin = told["trial"], told["begin"]
    at = streams.begin + 0.3 * streams.seconds
    while streams.clock() < at:
        time.sleep(0.01)
    for text in (f"mark {n}", f"again {n}"):
        program.do("mark", "marked", text=text)
    fault = streams.clock()
    event = disturbed(n, streams, folder, fault)
    if n in KILLS:
        time.sleep(0.2 * streams.seconds)
        event += "kill -9 "
        program.process.kill()
        program.process.wait()
        verdict = {"verdict": "", "alarms": []}
    else:
        verdict = program.do("verdict", "verdict", trial=number)
    alarm = [
        one
        for one in program.said
        if one["event"] in ("alarm", "disk") and one["clock"] > streams.begin
    ]
    late = min((one["clock"] - fault for one in alarm if one["clock"] > fault), default=None)
    said = ", ".join(sorted({one.get("code", one["event"]) for one in alarm}))
    late = "" if late is None else f"{late:.2f}"
    return [number, event.strip(), verdict["verdict"], said, late], number


def disturbed(n, streams, folder, fault):
    """Let a stream, an electrode or the disk fail, as the trial has it; what it was."""
    event = "relaxed" if n == 1 else ""
    if n in LOSSES:
        streams.lose("EMG" if n % 2 else "manipulator", 1.0)
        event += "stream lost 1 s "
    if n in LAYOUTS:
        streams.lose("EMG", 0.5, order=streams.order[::-1])
        event += "other layout "
    if n == 9:
        streams.off, event = fault, "electrode off"
    if n in FULL:
        event += "disk full 3 s "
        filler = folder / "filler"
        with filler.open("wb") as file, contextlib.suppress(OSError):
            while True:
                file.write(bytes(2**20))
                file.flush()
        time.sleep(3.0)
        filler.unlink()
    return event


def report(folder, rows, marks, restarts, began, seconds):
    import surae

    damaged = [p.name for p in folder.iterdir() if "damaged" in p.name]
    lost, unread = [], []
    for number, texts in marks.items():
        record = json.loads((folder / f"trial-{number:02d}.json").read_text())
        if [m["text"] for m in record["marks"]] != texts:
            lost.append(number)
        if not record.get("protocol") or not record.get("effort_asked"):
            lost.append(number)
        try:
            fit = surae.fit(record["recording"], "muscle", starts=1)
            rows[list(marks).index(number)].append(f"{fit.vaf:.1f}")
        except Exception as error:
            unread.append((number, str(error)))
            rows[list(marks).index(number)].append("–")
    print("\n| trial | event | verdict | alarms | first alarm after [s] | VAF of surae fit |")
    print("|--:|---|---|---|--:|--:|")
    for row in rows:
        print("| " + " | ".join(map(str, row)) + " |")
    print(
        f"\n{len(rows)} trials, {restarts} restarts, {seconds:.0f} s; damaged: {damaged}; marks or "
        f"requests lost: {lost}; not fitted: {unread}"
    )
    print("said at starts:", sorted({text for one in began for text in one["broken"]}))


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--trials", type=int, default=24)
    parser.add_argument("--seconds", type=float, default=8.0)
    parser.add_argument("--minutes", type=float, default=0.0)
    parser.add_argument("--room", action="store_true")
    given = parser.parse_args()
    os.environ.setdefault(SESSION, f"day-{os.getpid()}")
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)
    if given.room:
        room(given.folder)
    else:
        day(given.folder, given.trials, given.seconds, given.minutes)
