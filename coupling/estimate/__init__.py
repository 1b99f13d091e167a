"""What is known of a run beforehand: numbers, modes, strength, cost, errors of the models."""
