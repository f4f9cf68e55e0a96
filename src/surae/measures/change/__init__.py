"""Whether a leg has changed between two sessions, or differs from the other leg.

What both sessions are wrong in alike cancels in their difference: the leg's own delay, its tendon's
toe, the curve from EMG to force. What is drawn anew does not: noise, the torque's zero, electrodes
and foot mounted anew; nor does what models leave unsure, as noise decides among them. Virtual legs
differ between sessions by a little more than that (`SCATTER`). Between two legs nothing cancels:
each has its own delay, tendon and skin.

Many differences are looked at, and one of twenty would be beyond its 95 % interval by chance alone.
What was asked beforehand is judged at the full level, by Holm's p-values among what was asked; all
else is exploratory, by the false discovery rate (`surae.measures.claims`), and a claim of it is to
be confirmed. Intervals aren't corrected for multiple comparisons.

What rest tells (`surae.measures.relaxed_change`) is one estimate of both sessions, and is doubted
by rest alone; what muscles' fits tell is withheld where one of them is doubtful.

A spread between sessions that repeated baselines show is known as badly as they are few: what it
adds has Student's t, with the degrees of freedom of Welch and Satterthwaite.
"""
