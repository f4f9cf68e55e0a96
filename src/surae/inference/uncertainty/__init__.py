"""How far off the estimates may be: their covariance, white or robust."""
