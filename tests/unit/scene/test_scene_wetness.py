"""Wetness in a scene: what fluid has touched, and so only beside fluid; and foam, which lies on it."""

from __future__ import annotations

import pytest

DRY = "duration: 1\nfps: 24\nrigid: {bodies: {floor: {shape: {type: plane}}}}\n"


def test_fluid_wets_what_it_touches(bench, scene):
    bench.accepts(scene(more="render: {wetness: {}, foam: {cover: 10}}"))
    bench.accepts(scene(more="render: {wetness: {drying_time: 500 ms}}"))


@pytest.mark.parametrize(
    ("text", "parts"),
    [
        ("render: {wetness: {drying_time: 0}}", ("render.wetness.drying_time", "greater than 0")),
        ("render: {wetness: {drying: 3 s}}", ("drying", "drying_time")),
        ("render: {foam: {cover: 0}}", ("render.foam", "cover")),
        ("render: {materials: {ball: {type: foam}}}", ("render.materials.ball",)),
    ],
)
def test_what_can_not_be(bench, scene, text, parts):
    bench.refuses(scene(more=text), *parts)


def test_nothing_gets_wet_without_fluid(bench):
    bench.refuses(DRY + "render: {wetness: {}}\n", "render.wetness", "no fluid that could wet", "add a fluid")
