"""Make a renderer from a scene file."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pacinian.errors import ArgumentError, PluginError, SceneFileError
from pacinian.plugins import registry
from pacinian.rendering.renderer import Renderer
from pacinian.scene.config_sections import PluginConfig
from pacinian.scene.sampling.ramps import RAMP_TIME
from pacinian.scene.sampling.sampler import Sampler
from pacinian.solving.limits import Limits

if TYPE_CHECKING:
    from pathlib import Path

    from pacinian.plugins.registry import Kind
    from pacinian.scene.file import SceneFile


def make_renderer(file: SceneFile, path: Path | str, *, strict: bool = False) -> Renderer:
    """Make a renderer for a scene file. strict: see `Renderer`. Raises SceneFileError, with `path` and the key."""
    solver = _make("solver", file.solver, path)
    backend = _make("backend", file.backend, path)
    try:
        return Renderer(
            file.array.make(),
            file.scene,
            medium=file.medium.make(),
            solver=solver,
            backend=backend,
            rate=file.rate,
            strict=strict,
            limits=Limits(gain=file.gain),
            sampler=Sampler(file.sampling.budget, file.sampling.spacing, ramp=RAMP_TIME),
        )
    except ArgumentError as error:
        raise SceneFileError(path, "", str(error)) from error


def _make(kind: Kind, choice: str | PluginConfig, path: Path | str) -> Any:
    chosen = choice if isinstance(choice, PluginConfig) else PluginConfig(choice)
    try:
        return registry.discover_plugins().make(kind, chosen.name, dict(chosen.options))
    except (PluginError, ArgumentError) as error:
        raise SceneFileError(path, f"$.{kind}", str(error)) from error
