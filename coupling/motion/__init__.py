"""How the tank moves, and what is known of its motion before a run."""
