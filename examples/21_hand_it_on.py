"""
How do I hand a fit on?
=======================

A line each: what others do with a fit.
"""

import tempfile
from pathlib import Path

import surae
from surae.api import write_parquet

folder = Path(tempfile.mkdtemp())
trial, other = surae.example(), surae.example(trial=2)
fit = surae.fit(trial, "muscle", starts=1)

print(fit.predictor(1000))  # the torque while it is measured
fit.predictor(1000).to_c("leg").save(folder)  # the same in C
prediction = surae.validate(fit, other)[0]  # another trial, beside what knows no muscle
print(prediction, prediction.baselines)
print(surae.write_bids(folder / "study", [trial, other], fit))  # EMG-BIDS
write_parquet(folder / "trial.parquet", trial)  # a table for pandas, Polars, R
print(surae.export(fit, to="mjcf"))  # a model of MuJoCo
critical = surae.fit(trial, "muscle", starts=1, fixed={"beta": 1.0})
print(surae.compare({"free": fit, "beta = 1": critical}))  # fits beside each other
print(fit.fit_report().splitlines()[0], fit.aic)  # as lmfit's users read one
print(fit.to_dataframe().head(3))
print(sorted(path.name for path in folder.iterdir()))
