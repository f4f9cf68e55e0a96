"""Virtual legs with hidden truth, to judge any estimate of how the ankle's muscles work."""

__version__ = "1.2.0"
