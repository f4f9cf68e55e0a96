"""What the data and prior knowledge say together: draws from the posterior."""
