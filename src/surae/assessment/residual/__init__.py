"""What a fit leaves over: how much, whether it is white, and how it is correlated."""
