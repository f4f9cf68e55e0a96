"""Files to recordings: readers, units and signs, provenance."""

from surae.recording.recording import MUSCLES, ROLES, Channel, Recording, SourceFile, read_only

__all__ = ["MUSCLES", "ROLES", "Channel", "Recording", "SourceFile", "read_only"]
