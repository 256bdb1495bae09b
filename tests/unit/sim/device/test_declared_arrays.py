"""Arrays of particles are attributes by the names that they are declared with: no code asks for another."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[4]
DECLARED = re.compile(r'Declared\(\s*"(\w+)"')
USED = re.compile(r"\bparticles\.(\w+)")
OWN = re.compile(r"def (\w+)|self\.(\w+)\b")


def test_what_is_used_is_declared():
    sources = {path: path.read_text() for path in (ROOT / "sim").rglob("*.py")}
    declared = {name for text in sources.values() for name in DECLARED.findall(text)}
    assert {"position", "pressure_acceleration"} <= declared
    arrays = sources[ROOT / "sim" / "device" / "arrays.py"]
    own = {name for pair in OWN.findall(arrays) for name in pair}
    chapters = (ROOT / "sim" / "fluid", ROOT / "sim" / "coupling")
    within = {path: text for path, text in sources.items() if any(path.is_relative_to(folder) for folder in chapters)}
    used = {(path.name, name) for path, text in within.items() for name in USED.findall(text)}
    assert len(used) > 50
    assert not {(file, name) for file, name in used if name not in declared | own}
