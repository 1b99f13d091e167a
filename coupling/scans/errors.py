"""What is wrong with a scan."""

from __future__ import annotations


class ScanError(Exception):
    """A scan that cannot be compared; the message says where, what and the mend."""
