"""Which measurement tells most: what a protocol will tell, and the protocol that tells most."""
