"""What is simulated: the sections of a scene, their checks, and the tables that they name."""
