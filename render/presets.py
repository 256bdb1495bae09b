"""What the quality presets mean for the render stage; a scene's own values go above them."""

from __future__ import annotations

from typing import Any

PRESETS: dict[str, dict[str, Any]] = {
    "draft": {"resolution": [480, 270], "samples": 10, "noise_threshold": 0.05, "bounces": 8, "motion_blur": False},
    "standard": {"resolution": [640, 360], "samples": 16, "noise_threshold": 0.05},
    "final": {"resolution": [1920, 1080], "samples": 128, "noise_threshold": 0.01, "bounces": 24},
}
