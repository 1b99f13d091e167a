"""What programs call: one function each for a run, a study and a sweep; the command calls them."""
