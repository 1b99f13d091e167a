"""The inviscid, irrotational liquid by boundary elements: only its boundary carries unknowns."""
