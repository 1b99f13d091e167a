"""A scanned diaphragm against a run's: read, aligned, measured, with the error of each figure."""
