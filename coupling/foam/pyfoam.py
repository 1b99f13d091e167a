"""What is used of PyFoam, for accounts without a name too.

PyFoam asks for the user's name, and fails where an account has no entry in the list of users: such
an account, usual in containers, goes by its number here.
"""

from __future__ import annotations

import getpass
import os

from PyFoam.LogAnalysis.FoamLogAnalyzer import FoamLogAnalyzer
from PyFoam.LogAnalysis.RegExpLineAnalyzer import RegExpLineAnalyzer
from PyFoam.RunDictionary.ParsedParameterFile import ParsedParameterFile

try:
    getpass.getuser()
except (KeyError, OSError):  # the latter from Python 3.13 on
    os.environ["LOGNAME"] = str(os.getuid())

__all__ = ["FoamLogAnalyzer", "ParsedParameterFile", "RegExpLineAnalyzer"]
