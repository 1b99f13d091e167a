"""Many runs: studies, sweeps, and the model that a scene leaves to choose."""
