"""Findings: where a bag breaks a convention."""

from __future__ import annotations

from dataclasses import dataclass, field

RULES = {
    "bag-end": "a bag must have an end and an index",
    "scan-missing": "a bag must have a LaserScan topic with at least one message",
    "scan-angles": "angles must be finite, and the increment not 0, with at most one turn in all",
    "scan-count": "there must be one range for each angle from angle_min to angle_max",
    "scan-limits": "limits must be finite, with 0 <= range_min < range_max",
    "scan-ranges": "a reading must be in range_min..range_max, or +inf, -inf or NaN (REP-117)",
    "scan-no-return": "a beam without a return must be +inf, not a number (REP-117)",
    "scan-intensities": "there must be no intensities or one for each range",
    "scan-time": "times must be finite and at least 0, and the beams of a scan must fit into scan_time",
    "scan-change": "all scans of a topic must have the same angles and limits",
    "stamp-zero": "a message must have a stamp",
    "stamp-back": "stamps must not go back",
    "stamp-repeat": "stamps must not repeat",
    "stamp-jump": "stamps must come at a steady rate",
    "stamp-future": "a stamp must not be after the time of recording",
    "frame-name": "a frame must have a name, without a leading slash (tf2), and not be its own child",
    "frame-change": "the frames of a topic must not change",
    "quaternion": "a quaternion must have length 1",
    "not-finite": "poses and velocities must be finite",
    "covariance": "a covariance must be finite, symmetric and positive semidefinite, and not be all 0 (REP-103: row-major)",
    "odometry-twist": "the twist must be the pose's motion, in the child frame: x forward, y left, yaw counter-clockwise"
    " (REP-103)",
    "odometry-tf": "the transform of the odometry's frames must be its pose",
    "tf-parents": "a frame must have one parent (REP-105)",
    "tf-loop": "the parents of frames must not form a loop",
    "tf-gap": "the transforms of a moving robot must come at a steady rate",
    "tf-scan": "transforms must lead up from a scan's frame at its stamp",
}
"""Each rule with what it expects."""

MOST_INDICES = 1000
"""Largest number of indices that a finding lists."""


@dataclass
class Finding:
    """Messages of a topic that break a rule.

    Attributes:
        rule: Name of the rule, one of `RULES`.
        topic: The topic.
        got: What the first of the messages has.
        count: Number of the messages.
        indices: Their positions among the messages of the topic, from 0: the first `MOST_INDICES`.
    """

    rule: str
    topic: str
    got: str
    count: int = 0
    indices: list[int] = field(default_factory=list)

    @property
    def expected(self) -> str:
        """What the rule expects."""
        return RULES[self.rule]


class Findings:
    """Findings while a bag is read, one for each rule and topic."""

    def __init__(self) -> None:
        self._found: dict[tuple[str, str], Finding] = {}

    def add(self, rule: str, topic: str, index: int, got: str) -> None:
        """Adds a message that breaks a rule.

        Args:
            rule: Name of the rule.
            topic: Topic of the message.
            index: Its position among the messages of the topic.
            got: What it has.
        """
        assert rule in RULES
        finding = self._found.setdefault((rule, topic), Finding(rule, topic, got))
        if finding.indices and finding.indices[-1] == index:
            return
        finding.count += 1
        if len(finding.indices) < MOST_INDICES:
            finding.indices.append(index)

    def sorted(self) -> list[Finding]:
        """Returns the findings by topic and by first index."""
        return sorted(self._found.values(), key=lambda each: (each.topic, each.indices[0], each.rule))
