"""The diaphragm alone: an inextensible cloth in a rigid spherical shell."""
