"""What a fit is worth: goodness, gate, intervals and verdicts."""
