"""The rigid shell round the diaphragm: its surface as data, and what compiled code asks of it."""
