"""Rigid bodies beside MuJoCo: a ball on a slope, dominoes and heaps of boxes, in turns on this machine.

Set-up of the peer, once:

    .venv/bin/python -m pip install --constraint constraints/3.11.txt --editable '.[peers]'

    python -m tests.benchmarks.rigid_peers
    python -m tests.benchmarks.rigid_peers --piles 3 --plot rigid_peers.png

Every scene is the same for both, to the last digit of masses, places and turns. Times are of steps alone, after one
run that compiles; the ratio is the median over runs in turns. Both engines run on one thread. Use a machine that is
idle; if it is not, the time of the processor tells more than that on the wall. What has to agree, and why within these
bounds, is in `tests/validation/test_rigid_peers.py`.
"""

from __future__ import annotations

import argparse
import statistics
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np

from tests.validation.domino_wave import arrivals
from tests.validation.rigid_peers import (
    EDGE,
    PILES,
    ROLLING,
    ROLLS,
    ROW,
    SEEN,
    SLIDING,
    START,
    Engine,
    Found,
    Scene,
    Tidemill,
    apart,
    descend,
    dominoes,
    fall,
    incline,
    mujoco,
    pile,
    run,
    settle,
    wave,
    way,
)

WARM_UP = 0.5
"""Simulated time that compiles every kernel of a scene [s]."""
Runs = tuple[list[Found], list[Found]]
"""Of ours and of the peer."""


def in_turns(engines: list[Callable[[Scene], Engine]], scenes: list[Scene], measure: Callable[[Engine], Found]) -> Runs:
    for make in engines:
        run(make(scenes[0]), WARM_UP)
    found: Runs = ([], [])
    for scene in scenes:
        for runs, make in zip(found, engines, strict=True):
            runs.append(measure(make(scene)))
    return found


def mean(runs: list[Found], name: str) -> float:
    return float(np.mean([one.values[name] for one in runs]))


def middle(runs: list[Found], name: str) -> float:
    return float(np.median([one.values[name] for one in runs]))


def middles(found: Runs, name: str) -> tuple[float, float]:
    ours, peer = found
    return middle(ours, name), middle(peer, name)


def row(name: str, ours: float, peer: float, bound: str = "", truth: float | None = None) -> None:
    difference = f"{ours / peer - 1:+.2%}" if bound else ""
    errors = f"{ours / truth - 1:+.2%}, {peer / truth - 1:+.2%}" if truth else ""
    print(f"| {name} | {ours:.4g} | {peer:.4g} | {difference} | {bound} | {errors} |")


def speed(name: str, found: Runs) -> None:
    for kind, time in enumerate(("wall", "processor")):
        costs = [[float(one.cost[kind]) for one in runs] for runs in found]
        ratio = statistics.median(ours / peer for ours, peer in zip(*costs, strict=True))
        ours, peer = map(statistics.median, costs)
        print(f"| {name}: {time} time [s] | {ours:.3g} | {peer:.3g} | {ratio:.3g} times as long | | |", flush=True)


def balls(name: str, found: Runs, slope: float, friction: float) -> None:
    row(f"ball {name}: way [m]", *middles(found, "way"), "1 %", way(slope, friction, ROLLS))
    speed(f"ball {name}", found)


def rows_of_dominoes(found: Runs) -> None:
    theory = wave(arrivals(ROW, START, SEEN))
    for name, key, bound in [("speed [m/s]", "speed", "1.3 %"), ("last struck at [s]", "last", "1 %")]:
        row(f"dominoes: {name}", *middles(found, key), bound, theory[key])
    row("dominoes: deepest overlap [m]", *middles(found, "overlap"))
    speed("dominoes", found)


def heaps(found: Runs) -> None:
    for name, key in [("mean height [m]", "height"), ("radius [m]", "radius")]:
        ours, theirs = (np.array([one.values[key] for one in runs]) for runs in found)
        bound = f"{apart(ours, theirs)[1] / theirs.mean():.1%} (3 s.e.)" if len(ours) > 1 else "needs several"
        row(f"heaps: {name}", ours.mean(), theirs.mean(), bound)
    row("heaps: share of boxes at rest", *(mean(runs, "resting") for runs in found))
    for name, key in [
        ("kinetic energy over weight times height at first", "energy"),
        ("drift at rest [m/s]", "drift"),
        (f"overlap at rest [m], of {EDGE} m", "overlap"),
        ("deepest overlap ever [m]", "deepest"),
    ]:
        row(f"heaps: {name}", *middles(found, key))
    speed("heaps", found)


def draw(rolling: Runs, sliding: Runs, falling: Runs, piling: Runs, path: Path) -> None:
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, (slope, wave, pile) = plt.subplots(1, 3, figsize=(13, 4.2), layout="constrained")
    looks = [
        {"color": "#0072b2", "linewidth": 2.6, "label": "Tidemill"},
        {"color": "#e69f00", "linewidth": 1.4, "linestyle": "--", "label": "MuJoCo"},
    ]
    seconds = np.linspace(0, ROLLS, 9)
    for found, at in [(rolling, ROLLING), (sliding, SLIDING)]:
        for runs, look in zip(found, looks, strict=True):
            slope.plot(runs[0].times, runs[0].curve, **(look if found is rolling else {**look, "label": None}))
        slope.plot(seconds, way(*at, seconds), "k.", label="closed form" if found is rolling else None)
    slope.annotate("slides, 40°", (1.4, way(*SLIDING, 1.4)), (-70, 0), textcoords="offset points")
    slope.annotate("rolls, 20°", (1.4, way(*ROLLING, 1.4)), (8, -12), textcoords="offset points")
    theory = arrivals(ROW, START, SEEN)
    for runs, look in zip(falling, looks, strict=True):
        wave.plot(runs[0].times, 1e3 * (runs[0].curve - theory), **look)
    wave.axhline(0, color="black", linewidth=0.8, label="theory (van Leeuwen 2010)")
    for runs, look in zip(piling, looks, strict=True):
        for index, one in enumerate(runs):
            pile.plot(one.times, one.curve, **{**look, "linewidth": 0.8, "label": None if index else look["label"]})
    slope.set(xlabel="time [s]", ylabel="way down the slope [m]", title="ball")
    wave.set(
        xlabel="domino after the first",
        ylabel="struck after theory [ms]",
        title="dominoes",
        xticks=range(1, ROW.number, 3),
    )
    pile.set(xlabel="time [s]", ylabel="mean height of 125 boxes [m]", title=f"{len(piling[0])} heaps", ylim=(0, None))
    for axes in (slope, wave, pile):
        axes.grid(color="#dddddd", linewidth=0.6)
        axes.spines[["top", "right"]].set_visible(False)
        axes.legend(frameon=False)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=110, metadata={"Software": None})


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--piles", type=int, default=PILES, help=f"heaps, each another one (default: {PILES})")
    parser.add_argument("--repeats", type=int, default=3, help="runs of the other scenes (default: 3)")
    parser.add_argument("--peer-step", type=float, default=1e-3, help="the peer's time step [s] (default: 0.001)")
    parser.add_argument("--max-step", type=float, default=4e-3, help="our longest time step [s] (default: 0.004)")
    parser.add_argument("--contact-error", type=float, default=1e-8, help="ours [m/s] (default: 1e-8)")
    parser.add_argument("--max-iterations", type=int, default=500, help="ours (default: 500)")
    parser.add_argument("--threads", type=int, default=1, help="ours; the peer runs on one (default: 1)")
    parser.add_argument("--plot", type=Path, metavar="PNG", help="draw ways, times and heights")
    options = parser.parse_args()
    threads = {"threads": options.threads}
    ours = {name: getattr(options, name) for name in ("max_step", "contact_error", "max_iterations")}
    engines = [partial(Tidemill, **threads, **ours), partial(mujoco, **threads, timestep=options.peer_step)]

    print("| what | ours | MuJoCo | difference | bound | errors of ours, theirs |")
    print("| --- | --- | --- | --- | --- | --- |")
    rolling, sliding = (
        in_turns(engines, [incline(*at)] * options.repeats, lambda engine, slope=at[0]: descend(engine, slope))
        for at in (ROLLING, SLIDING)
    )
    balls("rolls", rolling, *ROLLING)
    balls("slides", sliding, *SLIDING)
    falling = in_turns(engines, [dominoes()] * options.repeats, fall)
    rows_of_dominoes(falling)
    piling = in_turns(engines, [pile(seed) for seed in range(options.piles)], settle)
    heaps(piling)
    if options.plot:
        draw(rolling, sliding, falling, piling, options.plot)


if __name__ == "__main__":
    main()
