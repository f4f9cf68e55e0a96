"""A fit's torque while it is measured: step by step in Python, and as one file of C.

What each sample brings goes through filters that do not look ahead, and through the model's own
equations; what they read and remember is laid out once (`layout`).
"""
