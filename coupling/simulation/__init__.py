"""A run: the participants put together, the time loop, what is sampled and counted on the way."""
