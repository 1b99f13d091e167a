"""What is used of PyFoam, as it comes and for accounts without a name too.

PyFoam reads a user's settings when it is imported, and fails where they cannot be read: it looks
for them where there are none. It asks for the user's name, and fails where an account has no entry
in the list of users: such an account, usual in containers, goes by its number.
"""

from __future__ import annotations

import getpass
import os

_before = {name: os.environ.pop(name, None) for name in ("HOME", "PYFOAM_SITE_DIR")}
os.environ["HOME"] = "/nonexistent"
try:
    from PyFoam.LogAnalysis.FoamLogAnalyzer import FoamLogAnalyzer
    from PyFoam.LogAnalysis.RegExpLineAnalyzer import RegExpLineAnalyzer
    from PyFoam.RunDictionary.ParsedParameterFile import ParsedParameterFile
finally:
    del os.environ["HOME"]
    os.environ.update({name: value for name, value in _before.items() if value is not None})

try:
    getpass.getuser()
except (KeyError, OSError):  # the latter from Python 3.13 on
    os.environ["LOGNAME"] = str(os.getuid())

__all__ = ["FoamLogAnalyzer", "ParsedParameterFile", "RegExpLineAnalyzer"]
