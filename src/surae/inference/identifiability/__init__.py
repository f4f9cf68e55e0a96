"""Which parameters the data tell, and which stand in for one another."""
