"""One time step, coupled, potential or dry: its fixed point, convergence, and halves."""
