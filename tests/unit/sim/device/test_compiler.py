"""The compiler is chosen by one variable, and what differs between compilers is served in one place each."""

from __future__ import annotations

import dataclasses
import importlib
import sys
from typing import Any

import numpy as np
import pytest

from scene.settings import Refused
from sim.device import compiler_choice, kernel_cache
from sim.device.compiler_choice import COMPILERS, VARIABLE, chosen


def test_it_is_taichi_unless_another_is_named(monkeypatch):
    monkeypatch.delenv(VARIABLE, raising=False)
    assert chosen().package == "taichi"
    for name in COMPILERS:
        monkeypatch.setenv(VARIABLE, name)
        assert chosen().module == name


def test_a_name_of_none_is_refused(monkeypatch):
    monkeypatch.setenv(VARIABLE, "tachi")
    with pytest.raises(Refused, match=f"{VARIABLE}=tachi") as refused:
        chosen()
    assert all(name in refused.value.remedy for name in COMPILERS)


def test_one_that_is_not_installed_is_refused(monkeypatch):
    absent = dataclasses.replace(COMPILERS["quadrants"], module="no_such_compiler", package="no-such-compiler")
    monkeypatch.setitem(compiler_choice.COMPILERS, "quadrants", absent)
    monkeypatch.setenv(VARIABLE, "quadrants")
    monkeypatch.delitem(sys.modules, "sim.device.compiler", raising=False)
    with pytest.raises(Refused, match="no-such-compiler is not installed") as refused:
        importlib.import_module("sim.device.compiler")
    assert VARIABLE in refused.value.remedy


def test_each_keeps_its_kernels_apart(monkeypatch, tmp_path):
    """Taichi Forge would keep them where Taichi does."""
    monkeypatch.setenv("TI_OFFLINE_CACHE_FILE_PATH", str(tmp_path / "kernels"))
    found = set()
    for compiler in COMPILERS.values():
        monkeypatch.setattr("sim.device.compiler.compiler", compiler)
        found.add(kernel_cache.folder())
    assert len(found) == len(COMPILERS)
    assert str(tmp_path / "kernels") in found


def test_packs_without_argpack_look_the_same(monkeypatch):
    """Of data classes, as for Quadrants."""
    from sim.device import argument_packs
    from sim.device.double import Integers, Numbers

    monkeypatch.setattr(argument_packs, "compiler", COMPILERS["quadrants"])
    kind: Any = argument_packs.argpack(size=Integers, value=Numbers)
    assert kind.members == {"size": Integers, "value": Numbers}
    size, value = np.zeros(2, np.int32), np.ones(3)
    for pack in (kind(size, value), kind(value=value, size=size)):
        assert [name for name, _ in pack.items] == ["size", "value"]
        assert pack.size is pack["size"] is size and pack.value is value
    assert dataclasses.is_dataclass(kind)
