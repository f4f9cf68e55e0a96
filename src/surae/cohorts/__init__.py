"""Many legs that surae fitted, together: groups, differences, changes, each leg among its group."""
