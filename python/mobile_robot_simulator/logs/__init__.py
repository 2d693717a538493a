"""Logs: scans and poses read from bags, CARMEN logs and tables."""

from .reader import read_log
from .scan_log import ScanLog

__all__ = ["ScanLog", "read_log"]
