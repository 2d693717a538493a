"""Logs: scans and poses read from bags, CARMEN logs and tables."""

from .playback import Playback, PlayedRobot, PlayedScan
from .reader import read_log
from .scan_log import ScanLog

__all__ = ["Playback", "PlayedRobot", "PlayedScan", "ScanLog", "read_log"]
