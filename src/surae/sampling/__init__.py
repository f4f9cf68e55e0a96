"""Beyond the covariance of a fit: profiles, and draws from a named model's posterior."""
