"""What the estimates would be with other noise: bootstrap, and the bias by EMG noise."""
