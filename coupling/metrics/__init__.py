"""What the results mean: arrays in, numbers out."""
