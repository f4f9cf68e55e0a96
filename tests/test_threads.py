"""Linear algebra in one thread: more would wait for one another wherever others use the cores."""

import numpy as np
from threadpoolctl import threadpool_info, threadpool_limits

from surae.inference import assess, fit_problem, make_problem


def threads() -> set[int]:
    libraries = [library for library in threadpool_info() if library["user_api"] == "blas"]
    return {library["num_threads"] for library in libraries}


def test_a_fit_and_its_judgement_take_one_thread(noisy, monkeypatch) -> None:
    real, seen = np.linalg.svd, []

    def svd(*arguments, **options):
        seen.append(threads())
        return real(*arguments, **options)

    monkeypatch.setattr(np.linalg, "svd", svd)
    with threadpool_limits(limits=2, user_api="blas"):  # as many as a user's computer has
        result = fit_problem(
            make_problem([noisy]), starts=1, progress=lambda *_: seen.append(threads())
        )
        assert seen == [{1}] * len(seen) != []
        seen.clear()
        assess(result)
        assert seen == [{1}] * len(seen) != []
        assert threads() == {2}
