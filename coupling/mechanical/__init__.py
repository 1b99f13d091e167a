"""Mechanical model of a tank: pendulums or spring-masses that follow what runs of it have shown."""
