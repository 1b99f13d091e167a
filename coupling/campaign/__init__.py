"""Many runs: studies, sweeps, design curves, and the model that a scene leaves to choose."""
