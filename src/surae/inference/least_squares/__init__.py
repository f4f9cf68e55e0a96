"""A model that is named, fitted by least squares: starts, what is solved, what moves together."""
