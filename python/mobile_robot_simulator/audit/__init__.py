"""Audit: whether the scans, odometry and transforms of a bag keep the conventions of ROS. It needs the extra `recording`."""

from .auditor import Audit, audit_bag
from .findings import RULES, Finding

__all__ = ["RULES", "Audit", "Finding", "audit_bag"]
