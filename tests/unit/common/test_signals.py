"""A signal ends at once what listens to nothing: a process inside one instruction of Python that takes long."""

from __future__ import annotations

import signal
import subprocess
import sys
from pathlib import Path

import pytest

from common.signals import SIGNALS

ROOT = Path(__file__).resolve().parents[3]
BUSY = """
from common import signals

with signals.handled(lambda number, frame: print("heard")), signals.at_once():
    print(signals.are_at_once(), flush=True)
    sum(range(10**11))
"""
"""The sum takes minutes, and no other thread of Python runs meanwhile, as while Taichi compiles."""
LISTENING = """
import signal
from common import signals

with signals.at_once(), signals.handled(lambda number, frame: print("heard", number)):
    print(signals.are_at_once())
    for number in signals.SIGNALS:
        signal.raise_signal(number)
"""


@pytest.mark.parametrize("number", SIGNALS)
def test_a_process_in_the_middle_of_an_instruction(number):
    process = subprocess.Popen([sys.executable, "-c", BUSY], cwd=ROOT, stdout=subprocess.PIPE, text=True)
    try:
        assert process.stdout.readline() == "True\n"
        process.send_signal(number)
        assert process.communicate(timeout=30)[0] == ""
        assert process.returncode == -number
    finally:
        process.kill()


def test_what_listens_again_hears():
    done = subprocess.run([sys.executable, "-c", LISTENING], cwd=ROOT, capture_output=True, text=True, timeout=30)
    assert done.stdout == "False\n" + "".join(f"heard {int(number)}\n" for number in SIGNALS)
    assert done.returncode == 0
    assert signal.getsignal(signal.SIGTERM) == signal.SIG_DFL
