"""Tables of numbers in text files, as loggers and spreadsheets write them."""
