"""The inviscid, irrotational liquid by harmonic polynomials: only its boundary is sampled."""
