"""Faults written as text: the same faults as from Python, and clear errors for everything else."""

from __future__ import annotations

import pytest

from mobile_robot_simulator import faults
from mobile_robot_simulator.faults.reading import FAULTS, read_fault


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("Drop('/scan', probability=0.1)", faults.Drop("/scan", probability=0.1)),
        (" Delay('odom', 0.2, jitter=0.1, seed=3) ", faults.Delay("odom", 0.2, jitter=0.1, seed=3)),
        ("Blackout(start=1, end=2.5)", faults.Blackout(start=1, end=2.5)),
        ("BlockedSector(-0.2, 0.2)", faults.BlockedSector(-0.2, 0.2)),
        ("OdometryDrift([0.1, 0, 0, 0.1, 0, 0])", faults.OdometryDrift((0.1, 0, 0, 0.1, 0, 0))),
        ("Slip(0.5, robot=None)", faults.Slip(0.5)),
        ("Push(0.5, direction=1.5, end=2.0)", faults.Push(0.5, 1.5, end=2.0)),
        ("ClockJump(-3.0, at=1.0)", faults.ClockJump(-3.0, at=1.0)),
        ("Outage('laser', robot='a')", faults.Outage("laser", robot="a")),
    ],
)
def test_a_text_gives_the_fault_that_python_gives(text: str, fault: faults.Fault) -> None:
    read = read_fault(text)
    assert type(read) is type(fault) and repr(read) == repr(fault)


def test_every_fault_can_be_written() -> None:
    assert set(FAULTS) == set(faults.__all__) - {"Fault", "MessageFault"}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "must be a call such as Drop"),
        ("Drop", "must be a call such as Drop"),
        ("Drop('/scan'", "must be a call such as Drop('/scan', probability=0.1), not '(' was never closed"),
        ("faults.Drop('/scan')", "must be a call such as Drop"),
        ("Drop('/scan'); Drop('/odom')", "must be a call such as Drop"),
        ("__import__('os').system('true')", "must be a call such as Drop"),
        ("eval('1')", "unknown fault 'eval'"),
        ("Drops('/scan')", "unknown fault 'Drops'; did you mean 'Drop'?"),
        ("Drop(open('x'))", "arguments must be numbers, texts, lists or None, got open('x')"),
        ("Drop('/scan', probability=1/0)", "arguments must be numbers, texts, lists or None, got 1 / 0"),
        ("Drop(*['/scan'])", "arguments must be numbers, texts, lists or None, got *['/scan']"),
        ("Drop(**{'topic': '/scan'})", "the arguments of Drop must be written out, without **"),
        ("Drop('/scan', probabilty=0.1)", "unknown argument of Drop 'probabilty'; did you mean 'probability'?"),
        ("Blackout(probability=0.1)", "unknown argument of Blackout 'probability'"),
        ("Delay('/scan')", "missing a required argument: 'seconds'"),
        ("Drop('/scan', 0.1)", "too many positional arguments"),
        ("Drop('/scan', probability=2)", "the probability must be in 0..1, got 2"),
        ("Drop(3)", "the name of a topic or service must be a text, got 3"),
        ("Drop('/scan', probability='x')", "probability must be a number, got 'x'"),
        ("Drop('/scan', seed=0.5)", "seed must be an integer, got 0.5"),
        ("(" * 5000 + ")" * 5000, "must be a call such as Drop"),
        ("Drop(" + "-" * 100_000 + "1)", "fault "),
    ],
)
def test_any_other_text_is_an_error_that_quotes_it(text: str, message: str) -> None:
    with pytest.raises(ValueError) as raised:
        read_fault(text)
    assert str(raised.value).startswith("fault ") and message in str(raised.value)
    assert len(str(raised.value)) < 500


def test_what_is_not_a_text_is_an_error() -> None:
    with pytest.raises(ValueError, match="a fault must be a text such as"):
        read_fault(3)  # type: ignore[arg-type]
