"""``python -m coupling.cli``: as ``edt``."""

from coupling.cli.main import main

main()
