"""Cycles: samples, light paths, device, colours, file format."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from render.blender import versions
from render.blender.session import bpy
from render.errors import Unusable

GPU_KINDS = ("OPTIX", "CUDA", "HIP", "METAL", "ONEAPI")
"""Cycles' names for ways to use a GPU, the fastest first."""
LOOKS = {
    "AgX": {"low": "AgX - Medium Low Contrast", "medium": "AgX - Base Contrast", "high": "AgX - Medium High Contrast"},
    "Filmic": {"low": "Medium Low Contrast", "medium": "Medium Contrast", "high": "Medium High Contrast"},
}
"""Blender's names for the contrasts of the settings; Filmic's own look is the medium one."""

STRAIGHT = 128
"""Clear surfaces that light crosses without being bent, at most: it costs only where so many lie behind each other."""


@dataclass(frozen=True)
class Device:
    """What Cycles runs on."""

    kind: str
    names: tuple[str, ...]


def configure(settings: Any, threads: int | None, fps: float) -> tuple[Device, list[str]]:
    """Set up the scene's rendering; returns the device, and warnings of what had to be done otherwise."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    _picture(scene.render, settings, fps)
    if threads is not None:
        scene.render.threads_mode, scene.render.threads = "FIXED", threads
    _light_paths(scene.cycles, settings)
    _passes(bpy.context.view_layer, settings.passes)
    warnings = [*_denoise(scene.cycles, settings), *_colors(scene.view_settings, settings)]
    return _device(scene, settings), warnings


def _picture(render: Any, settings: Any, fps: float) -> None:
    render.resolution_x, render.resolution_y = settings.resolution
    render.resolution_percentage = 100
    # fps / fps_base: Blender wants a whole number and a divisor
    render.fps = max(1, round(fps))
    render.fps_base = render.fps / fps
    render.use_motion_blur = settings.motion_blur
    render.motion_blur_shutter = settings.shutter
    render.use_persistent_data = True
    transparent = settings.background.type == "transparent"
    render.film_transparent = bpy.context.scene.cycles.film_transparent_glass = transparent
    versions.take_format(render.image_settings, "PNG", "RGBA" if transparent else "RGB", "8")
    for stamp in (name for name in dir(render) if name.startswith("use_stamp")):
        setattr(render, stamp, False)


def _passes(layer: Any, wanted: list[str]) -> None:
    layer.use_pass_z = "depth" in wanted
    layer.use_pass_normal = "normal" in wanted
    layer.use_pass_vector = "motion" in wanted
    layer.use_pass_cryptomatte_object = "objects" in wanted
    layer.use_pass_cryptomatte_material = "materials" in wanted
    # Without any stamp Blender leaves out Cryptomatte's names, too.
    bpy.context.scene.render.use_stamp_frame = bool({"objects", "materials"} & set(wanted))


def _light_paths(cycles: Any, settings: Any) -> None:
    cycles.samples = settings.samples
    cycles.use_adaptive_sampling = settings.noise_threshold > 0
    cycles.adaptive_threshold = settings.noise_threshold
    cycles.seed = settings.seed
    cycles.use_animated_seed = settings.animated_seed
    cycles.max_bounces = settings.bounces
    cycles.transmission_bounces = settings.bounces
    cycles.transparent_max_bounces = STRAIGHT
    # total reflection counts as a mirror's: light runs along a pane of glass by many of them
    cycles.glossy_bounces = settings.bounces
    cycles.diffuse_bounces = min(3, settings.bounces)
    cycles.volume_bounces = 0
    # without caustics, clear looks let light through by straight rays: see looks/refraction.py
    cycles.caustics_reflective, cycles.caustics_refractive = False, settings.caustics
    cycles.sample_clamp_indirect = settings.firefly_clamp


def _denoise(cycles: Any, settings: Any) -> list[str]:
    cycles.use_denoising = settings.denoise
    if not settings.denoise:
        return []
    try:
        cycles.denoiser = "OPENIMAGEDENOISE"
        cycles.denoising_input_passes = "RGB_ALBEDO_NORMAL"
        versions.denoise_with(cycles, settings.denoise_quality)
    except TypeError:
        cycles.use_denoising = False
        return ["this Blender was built without Open Image Denoise: pictures keep their noise; use more samples"]
    return []


def _colors(view: Any, settings: Any) -> list[str]:
    warnings = []
    transform = settings.view_transform
    try:
        view.view_transform = transform
    except TypeError:
        warnings.append(f"this Blender has no view transform {transform}: Filmic is used")
        transform = "Filmic"
        view.view_transform = transform
    view.look = LOOKS[transform][settings.contrast] if transform in LOOKS else "None"
    view.exposure = settings.exposure
    return warnings


def _device(scene: Any, settings: Any) -> Device:
    found = _find_gpu() if settings.device != "cpu" else None
    if found is None:
        if settings.device == "gpu":
            raise Unusable("device: no GPU that Cycles can use was found. Use `device: auto` or `device: cpu`")
        scene.cycles.device = "CPU"
        return Device("CPU", ())
    scene.cycles.device = "GPU"
    versions.denoise_on_gpu(scene.cycles)
    return found


def _find_gpu() -> Device | None:
    addon = bpy.context.preferences.addons.get("cycles")
    if addon is None:
        return None
    preferences = addon.preferences
    for kind in GPU_KINDS:
        try:
            preferences.compute_device_type = kind
            preferences.get_devices()
        except (TypeError, ValueError, RuntimeError):  # this Blender was built without that kind
            continue
        gpus = [device for device in preferences.devices if device.type == kind]
        if gpus:
            for device in preferences.devices:
                device.use = device.type == kind
            return Device(kind, tuple(device.name for device in gpus))
    preferences.compute_device_type = "NONE"
    return None
