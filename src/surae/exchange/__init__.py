"""A fitted leg as a model file of another simulator, and how far its torque is from ours."""
