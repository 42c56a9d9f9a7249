"""A task: a promise, the oracle that it is held to, and how many cases a release asks for."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field


class UnavailableError(Exception):
    """A task cannot run on this machine; the message says what is missing."""


@dataclass
class Outcome:
    """What one case found.

    Attributes:
        count: How many of the task's units it ran.
        tallies: Numbers that add up over cases.
        peaks: Numbers of which the largest counts.
    """

    count: float = 1
    tallies: dict[str, float] = field(default_factory=dict)
    peaks: dict[str, float] = field(default_factory=dict)


@dataclass
class Totals:
    """The outcomes of all cases so far; attributes as in :class:`Outcome`."""

    count: float = 0
    tallies: dict[str, float] = field(default_factory=dict)
    peaks: dict[str, float] = field(default_factory=dict)

    def add(self, outcome: Outcome) -> None:
        """Takes in one more case."""
        self.count += outcome.count
        for name, number in outcome.tallies.items():
            self.tallies[name] = self.tallies.get(name, 0) + number
        for name, number in outcome.peaks.items():
            self.peaks[name] = max(self.peaks.get(name, number), number)

    def fraction(self, part: str, whole: str) -> float:
        """One tally as a fraction of another; NaN where there is none yet."""
        total = self.tallies.get(whole, 0)
        return self.tallies.get(part, 0) / total if total else float("nan")


Check = Callable[[int], Outcome]
"""Runs the case of a number, which is also the seed of all that is random in it.

Raises AssertionError, with a text that says what was wrong, where the promise does not hold.
"""


CORE = (
    *("core", "CMakeLists.txt", "cmake/voxshell_code_generation.cmake"),
    *("tests/cpp/core/support", "tests/cpp/soak"),
)
WORLDS = (*CORE, "bullet", "cmake", "python/bindings", "python/voxshell/simulation")
EVERYTHING = (*CORE, "bullet", "cmake", "python", "tests/python/support")


@dataclass(frozen=True)
class Task:
    """One line of the page.

    Attributes:
        promise: What must hold, as a sentence.
        oracle: What it is held to.
        unit: What is counted, in the plural.
        target: How many a release asks for.
        prepare: Makes what all cases share, in the process that runs them. Raises
            :class:`UnavailableError`.
        describe: What the cases covered or measured, in a few words.
        doubt: Says why the totals prove little, as where hardly any pose collided; else "".
        done: How much of the target the totals reach; by default their count.
        sources: Files and folders that the counter speaks of: a change to any resets it.
        patience: Seconds after which a case hangs.
        alone: Whether at most one worker runs its cases at a time, since they are of one process or
            are timed.
    """

    promise: str
    oracle: str
    unit: str
    target: float
    prepare: Callable[[], Check]
    describe: Callable[[Totals], str] = lambda totals: ""
    doubt: Callable[[Totals], str] = lambda totals: ""
    done: Callable[[Totals], float] = lambda totals: totals.count
    sources: tuple[str, ...] = EVERYTHING
    patience: float = 300.0
    alone: bool = False
