import signal
import threading

import pytest

from surae.inference.interrupt import checkpoint, postponed_interrupt


def press() -> None:
    signal.raise_signal(signal.SIGINT)


def test_ctrl_c_waits_for_the_checkpoint_and_counts_once() -> None:
    with postponed_interrupt():
        checkpoint()
        press()
        with pytest.raises(KeyboardInterrupt):
            checkpoint()
        checkpoint()


def test_a_second_ctrl_c_does_not_wait() -> None:
    with postponed_interrupt():
        press()
        with pytest.raises(KeyboardInterrupt):
            press()


def test_afterwards_everything_is_as_before() -> None:
    with postponed_interrupt():
        press()
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    checkpoint()
    with pytest.raises(KeyboardInterrupt):
        press()


def test_somebody_elses_handler_stays() -> None:
    pressed = []
    before = signal.signal(signal.SIGINT, lambda *_: pressed.append(1))
    try:
        with postponed_interrupt():
            press()
            checkpoint()
    finally:
        signal.signal(signal.SIGINT, before)
    assert pressed == [1]


def test_other_threads_are_never_stopped() -> None:
    outcome = []

    def work() -> None:
        with postponed_interrupt():
            checkpoint()
            outcome.append("done")

    with postponed_interrupt():
        press()
        thread = threading.Thread(target=work)
        thread.start()
        thread.join()
        assert outcome == ["done"]
        with pytest.raises(KeyboardInterrupt):
            checkpoint()
