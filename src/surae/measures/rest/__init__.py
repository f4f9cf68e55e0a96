"""Measures of a leg by its rest alone: torque and stiffness of its relaxed curve."""
