"""What became of all that the fuzzers tried, said at the end."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager

import pytest

_inputs: Counter[str] = Counter()


@pytest.fixture
def survived(request: pytest.FixtureRequest) -> Iterator[Callable[..., AbstractContextManager[None]]]:
    """Of one input: it may be refused by an error of these kinds, with a message; any other error fails the test."""
    tally: Counter[str] = Counter()

    @contextmanager
    def check(*refusals: type[Exception]) -> Iterator[None]:
        try:
            yield
        except refusals as refused:
            assert str(refused)
            tally["refused"] += 1
        else:
            tally["used"] += 1

    yield check
    request.node.user_properties.append(("inputs", dict(tally)))


def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    if report.when == "teardown":
        _inputs.update(dict(report.user_properties).get("inputs", {}))


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter, config: pytest.Config) -> None:
    if _inputs and not hasattr(config, "workerinput"):
        counts = ", ".join(f"{count:,} {outcome}" for outcome, count in sorted(_inputs.items()))
        terminalreporter.write_line(f"fuzzers: {_inputs.total():,} inputs, {counts}")
