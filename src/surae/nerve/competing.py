"""Descriptions of a stretched leg that compete by evidence: laws of EMG, and columns of tissue.

First each column alone is tried beside those always fitted, then others beside the best of them
while evidence grows. What is nearly as well described otherwise has its say in every interval.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from surae.base.units import FloatArray
from surae.nerve.driven import Envelopes, Law, driven
from surae.nerve.tissue import Tissue

#: What keeps coefficients together that no sample tells apart.
RIDGE = 1e-6
#: Samples of which one is independent.
DEPENDENT = 20.0
#: Most columns of tissue beside those always there; laws that are tried with each of them; best of
#: each trial that are kept; difference of BIC beyond which a description has no say (Raftery 1995:
#: 10 is very strong), and how many have.
MOST = 3
TRIED = 25
KEPT = 6
BEYOND = 18.0
SAY = 40
#: Most of what drives muscles, beside tissue, that is held to be noise.
NOISIEST = 0.5
#: Part of the largest torque that EMG drives from which an answer is strong.
STRONG = 0.33


@dataclass(frozen=True, slots=True)
class TorqueDescription:
    """Coefficients of one description, of all of tissue's columns; (k,), 0 where it has none."""

    law: Law
    weight: float  #: Its evidence beside the others' [1].
    c: FloatArray  #: Of tissue, after what noise of the EMG took is put right.
    diluted: FloatArray  #: What that was.
    gains: FloatArray  #: Of muscles [Nm].
    used: FloatArray  #: Numbers of tissue's columns it has, (u,).
    covariance: FloatArray  #: Of `c` at those, (u, u).
    sd: float  #: Of what it leaves [Nm].


class Competition:
    """Normal equations of all descriptions at once, each muscle's drive made once a law."""

    def __init__(
        self,
        tissue: Tissue,
        envelopes: Envelopes,
        torques: Sequence[FloatArray],
        use: Sequence[np.ndarray],
    ) -> None:
        """Of the torque of each recording, the samples `use`."""
        self.tissue = tissue
        self.envelopes = envelopes
        self.use = use
        self.x = np.concatenate([r[u] for r, u in zip(tissue.rows, use, strict=True)])
        self.y = np.concatenate([t[u] for t, u in zip(torques, use, strict=True)])
        self.size = np.sqrt(np.mean(self.x**2, axis=0)) + 1e-12
        scaled = self.x / self.size
        n = len(self.y)
        self.xx = scaled.T @ scaled / n
        self.xy = scaled.T @ self.y / n
        self.yy = self.y @ self.y / n
        self.laws = list(envelopes.laws())
        self.calf = np.array([m != "ta" for m in envelopes.muscles], bool)
        self.parts = []
        for law in self.laws:
            d = np.concatenate([d[u] for d, u in zip(self.drives(law), use, strict=True)])
            s = np.sqrt(np.mean(d**2, axis=0)) + 1e-12
            d /= s
            self.parts.append((s, d.T @ d / n, scaled.T @ d / n, d.T @ self.y / n))

    def drives(self, law: Law) -> list[FloatArray]:
        """Torque of muscles by a law, per unit, of each recording, (n, muscles)."""
        called = self.envelopes.bent(law.bend)
        return [driven(c, law, n) for c, n in zip(called, self.envelopes.lengths, strict=True)]

    def best(self) -> list[TorqueDescription]:
        """Descriptions that have a say, the best first."""
        every: list[tuple[float, int, tuple[int, ...]]] = []
        laws = range(len(self.laws))
        now = self._tried((), laws)
        more = tuple[int, ...]()
        every += now[:KEPT]
        total = self.x.shape[1] if self.envelopes.muscles else self.tissue.always
        for _ in range(MOST):
            some = [law for _, law, _ in now[:TRIED]]
            trials = [
                self._tried((*more, k), some)
                for k in range(self.tissue.always, total)
                if k not in more
            ]
            best = min(trials, key=lambda t: t[0], default=None)
            if best is None or best[0][0] >= now[0][0]:
                break
            every += [each for trial in trials for each in trial[:KEPT]]
            more = best[0][2]
            now = self._tried(more, laws)
            every += now[:KEPT]
        # one of a kind: the order in which columns came in does not matter
        alike = {(law, frozenset(columns)): bic for bic, law, columns in every}
        ranked = sorted((bic, law, tuple(sorted(cols))) for (law, cols), bic in alike.items())
        likely = [each for each in ranked if each[0] <= ranked[0][0] + BEYOND][:SAY]
        weights = np.exp([0.5 * (ranked[0][0] - bic) for bic, _, _ in likely])
        weights /= weights.sum()
        return [
            self._described(law, columns, float(w))
            for (_, law, columns), w in zip(likely, weights, strict=True)
        ]

    def plain(self, law: Law) -> TorqueDescription:
        """That of tissue's usual columns alone, by a law."""
        return self._described(self.laws.index(law), (), 0.0)

    def _tried(
        self, more: tuple[int, ...], laws: Sequence[int]
    ) -> list[tuple[float, int, tuple[int, ...]]]:
        """BIC of some columns with each of some laws (Schwarz 1978), the best first."""
        n = len(self.y) / DEPENDENT
        left = ((self._solved(more, law)[0], law) for law in laws)
        return sorted((n * math.log(v) + len(more) * math.log(n), law, more) for v, law in left)

    def _solved(
        self, more: tuple[int, ...], law: int
    ) -> tuple[float, FloatArray, FloatArray, FloatArray, np.ndarray]:
        """Mean square left, scaled coefficients, matrix, right side, and muscles that pull.

        The calf only pulls: a head that would push is left out (a step of Lawson and Hanson 1974).
        """
        used = np.array([*range(self.tissue.always), *more])
        _, dd, xd, dy = self.parts[law]
        k = len(used)
        pull = np.arange(len(dy))
        while True:
            a = np.empty((k + len(pull), k + len(pull)))
            a[:k, :k], a[:k, k:] = self.xx[np.ix_(used, used)], xd[np.ix_(used, pull)]
            a[k:, :k], a[k:, k:] = a[:k, k:].T, dd[np.ix_(pull, pull)]
            b = np.concatenate([self.xy[used], dy[pull]])
            ridged = a + RIDGE * np.eye(len(b))
            c = np.linalg.solve(ridged, b)
            pushes = np.where(self.calf[pull], c[k:], 0.0)
            if not (pushes < 0.0).any():
                break
            pull = np.delete(pull, int(np.argmin(pushes)))
        return max(float(self.yy - 2.0 * c @ b + c @ a @ c), 1e-12), c, ridged, b, pull

    def _described(self, law: int, more: tuple[int, ...], weight: float) -> TorqueDescription:
        used = np.array([*range(self.tissue.always), *more])
        mean, first, a, b, pull = self._solved(more, law)
        k = len(used)
        description = self.laws[law]
        size = np.concatenate([self.size[used], self.parts[law][0][pull]])
        # noise of the EMG draws what it drives to 0, and tissue takes it (Fuller 1987)
        less = a.copy()
        if len(pull):
            noise = np.diag(self.envelopes.noisy(description)[pull] / size[k:] ** 2)
            alone = np.linalg.inv(a)[k:, k:]  # inverse of what of drives tissue does not explain
            most = float(np.max(np.linalg.eigvals(alone @ noise).real))
            less[k:, k:] -= noise * min(1.0, NOISIEST / max(most, 1e-12))
        c = np.linalg.solve(less, b)
        whole = np.zeros(self.x.shape[1])
        diluted = np.zeros(self.x.shape[1])
        whole[used] = (c / size)[:k]
        diluted[used] = ((c - first) / size)[:k]
        gains = np.zeros(len(self.calf))
        gains[pull] = (first / size)[k:]
        covariance = np.linalg.inv(a) / np.outer(size, size) * mean * DEPENDENT / len(self.y)
        return TorqueDescription(
            description, weight, whole, diluted, gains, used, covariance[:k, :k], math.sqrt(mean)
        )

    def left_out(self, of: TorqueDescription, label: np.ndarray) -> FloatArray:
        """By what tissue's coefficients change if one label's samples are left out, weighed.

        Their squares' sum is the variance of a jackknife over groups (Tukey 1958): what equations
        get wrong alike in all repeats of one speed shows where other speeds alone predict it. Last
        comes what leaving out the strongest answers changes: laws hold for small ones too.
        """
        d = np.concatenate([d[u] for d, u in zip(self.drives(of.law), self.use, strict=True)])
        pull = of.gains != 0.0
        x = np.hstack([self.x[:, of.used], d[:, pull]])
        k = len(of.used)
        c = np.concatenate([(of.c - of.diluted)[of.used], of.gains[pull]])
        size = np.sqrt(np.mean(x**2, axis=0)) + 1e-12
        scaled = x / size
        groups = np.unique(label)
        moved = []
        torque = d[:, pull] @ of.gains[pull]
        weak = np.abs(torque) <= STRONG * float(np.max(np.abs(torque), initial=0.0))
        ridge = RIDGE * len(self.y) * np.eye(x.shape[1])
        for stays in (*(label != group for group in groups), weak):
            keep = scaled[stays]
            y = self.y[stays]
            # towards the coefficients of all: of what only this group tells nothing is known
            step = np.linalg.solve(keep.T @ keep + ridge, keep.T @ (y - keep @ (c * size)))
            moved.append((step / size)[:k])
        weight = math.sqrt((len(groups) - 1.0) / len(groups))
        return np.array([*(weight * each for each in moved[:-1]), moved[-1]])
