"""What the words of a report mean, for an engineer who has not read the thesis."""

from __future__ import annotations

from coupling.report.page import Section

TERMS = Section(
    title="What the words mean",
    text="Hydrostatic pressure is what a liquid at rest would have under gravity and the tank’s "
    "acceleration at the moment. p* is the rest of the pressure: −ρ∂φ/∂t, which speeds the liquid "
    "up within the tank, and −ρ|u|²/2, Bernoulli’s term of its speed. f₁ is the frequency at which "
    "the liquid would slosh by itself: far below it, it follows the tank as if at rest, and the "
    "error of hydrostatics is about (f/f₁)²; near and above it there is no such rule. Neglected "
    "momentum is the acceleration of the liquid’s centre of gravity within the tank over the "
    "tank’s own: the share of the force on the tank that hydrostatics cannot hold. CG is that "
    "centre of gravity; amplitude and phase are those of its first harmonic, the phase against "
    "the tank’s displacement. Of a record, which has no period, rms is the root of the mean square "
    "about the mean and a level crossing is counted where a signal passes a multiple of its rms.",
)
