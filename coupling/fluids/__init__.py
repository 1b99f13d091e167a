"""The fluid ladder: what the liquid's pressure on the diaphragm is taken to be."""
