"""findings: one for each rule and topic."""

from mobile_robot_simulator.audit.findings import MOST_INDICES, Findings


def test_messages_of_a_rule_and_a_topic_are_one_finding() -> None:
    findings = Findings()
    findings.add("stamp-back", "/b", 3, "first")
    findings.add("stamp-back", "/b", 3, "the same message")
    findings.add("stamp-back", "/b", 5, "second")
    findings.add("stamp-zero", "/a", 9, "other")
    first, second = findings.sorted()
    assert (first.rule, first.topic, first.indices, first.count) == ("stamp-zero", "/a", [9], 1)
    assert (second.got, second.indices, second.count) == ("first", [3, 5], 2)
    assert second.expected == "stamps must not go back"


def test_many_messages_are_counted_but_not_listed() -> None:
    findings = Findings()
    for index in range(MOST_INDICES + 5):
        findings.add("stamp-back", "/a", index, "x")
    (finding,) = findings.sorted()
    assert finding.count == MOST_INDICES + 5 and finding.indices == list(range(MOST_INDICES))
