"""Which values of a parameter the data still allow: the profile likelihood."""
