"""What Taichi does in Python for a kernel is done once, and errors say the same."""

from __future__ import annotations

import pytest

from sim.device.compiler_choice import chosen

pytestmark = pytest.mark.skipif(not chosen().memoize, reason="not with this compiler")


def test_a_place_is_described_in_short_and_in_full_for_an_error(taichi):
    context = taichi.lang.ast.ast_transformer_utils.ASTTransformerContext
    describe, told = context.get_pos_info, []

    def both(self, node):
        full = describe.__wrapped__(self, node)
        try:
            raise LookupError
        except LookupError:
            told.append((describe(self, node), full))
        short = describe(self, node)
        assert full.startswith(short.removesuffix("\n"))
        return short

    from tests.unit.sim.device import traced

    context.get_pos_info = both
    try:
        assert traced.twice(3.0) == 12.0
    finally:
        context.get_pos_info = describe
    assert len(told) > 20
    assert all(for_error == full for for_error, full in told)


def test_an_error_names_its_line(taichi):
    from tests.unit.sim.device import traced

    with pytest.raises(taichi.TaichiCompilationError, match=r"traced\.py.*\n.*unknown_name.*\n *\^+"):
        traced.wrong()


def test_a_function_is_read_once(taichi):
    from tests.unit.sim.device import traced

    read = taichi.lang.kernel_impl.getsourcelines
    before = read.cache_info()
    assert traced.thrice(1.0) == 8.0
    after = read.cache_info()
    assert (after.hits - before.hits) + (after.misses - before.misses) == 4, "the kernel, and the function thrice"
    assert after.misses - before.misses <= 2


def test_members_of_classes_are_told_from_functions(taichi):
    from tests.unit.sim.device import traced

    assert traced.doubled.func.classfunc is False
    assert traced.Scaled.__dict__["by_two"].func.classfunc is True

    def local():
        return None

    assert taichi.func(local).func.classfunc is False
