"""The command line ``edt``: its verbs, and what they share."""
