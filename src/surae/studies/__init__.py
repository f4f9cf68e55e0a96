"""Virtual subjects and what is learnt from fitting them."""

from surae.studies.virtual import POPULATIONS, VirtualSubject, virtual_subject, virtual_trial

__all__ = ["POPULATIONS", "VirtualSubject", "virtual_subject", "virtual_trial"]
