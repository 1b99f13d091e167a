"""The irrotational liquid by harmonic polynomials: only its boundary is sampled."""
