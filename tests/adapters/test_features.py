"""Unity and Unreal have the same features with the same defaults, and all that they should have of the wire."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest

from . import tools

if TYPE_CHECKING:
    from collections.abc import Iterator
    from types import ModuleType


@pytest.fixture(scope="module")
def table() -> Iterator[ModuleType]:
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(tools.ADAPTERS / "generate")
        import features_table  # type: ignore[import-not-found]

        yield features_table


@pytest.fixture(scope="module")
def model(table: ModuleType) -> Any:
    import wire  # type: ignore[import-not-found]

    return wire.read()


def test_the_table_is_that_of_the_sources(table: ModuleType, model: Any) -> None:
    ((name, text),) = table.generate(model).items()
    written = (tools.ADAPTERS / name).read_text(encoding="utf-8")
    assert written == text, "run `python adapters/generate/main.py`"


def test_both_engines_have_all_features_with_the_same_defaults(
    table: ModuleType, model: Any
) -> None:
    assert table.problems(model) == []


def test_the_sources_are_read(table: ModuleType) -> None:
    rows = table.make_table().rows
    assert {len(row) for each in rows.values() for row in each} == {5}
    assert sum(map(len, rows.values())) > 160
    (radius,) = [row for row in rows["QuietZone"] if row[0] == "Radius"]
    assert radius == ("Radius", "0.1", "Zone.radius", "`Radius`", "`Radius`")


@pytest.mark.parametrize("engine", ["unity", "unreal"])
def test_what_only_one_has_is_found(
    table: ModuleType, model: Any, monkeypatch: pytest.MonkeyPatch, engine: str
) -> None:
    read = getattr(table.features, engine)

    def without(sources: Any) -> Any:
        found = read(sources)
        found.get("HapticEffect", {}).pop("Stiffness", None)
        return found

    monkeypatch.setattr(table.features, engine, without)
    other = "Unreal" if engine == "unity" else "Unity"
    assert f"HapticEffect.Stiffness: only in {other}" in table.problems(model)


def test_what_is_new_on_the_wire_is_found(
    table: ModuleType, model: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delitem(table.UNUSED, "Path")
    monkeypatch.delitem(table.WIRE, "HapticEffect.Priority")
    told = table.problems(model)
    assert "Path: not used by both" in told
    assert "HapticObject.priority: in no feature" in told


@pytest.mark.parametrize(
    ("text", "scale", "meant"),
    [
        ("0.85f", 0.01, "0.0085"),
        ("0.0085f", 1.0, "0.0085"),
        ("FVector2D(10.0, 10.0)", 0.01, "0.1 x 0.1"),
        ("new Vector2(0.1f, 0.1f)", 1.0, "0.1 x 0.1"),
        ("EHapticSide::Right", 1.0, "Right"),
        ("HandFrameSide.Right", 1.0, "Right"),
        ('TEXT("default")', 1.0, "default"),
        ('""', 1.0, ""),
        ("true", 1.0, "yes"),
        ("false", 1.0, ""),
        ("0.0f", 1.0, ""),
        ("new float[0]", 1.0, ""),
    ],
)
def test_defaults_in_words_of_both(table: ModuleType, text: str, scale: float, meant: str) -> None:
    assert table.features.default(text, scale) == meant


@pytest.mark.parametrize(
    ("name", "kind", "feature"),
    [
        ("bArmOnConnect", "setting", "ArmOnConnect"),
        ("GetNextPoint", "action", "NextPoint"),
        ("IsArmed", "status", "Armed"),
        ("OnLost", "event", "Lost (event)"),
        ("state_changed", "event", "StateChanged (event)"),
        ("Settle", "action", "Settle"),
        ("Backend", "setting", "Backend"),
        ("Once", "action", "Once"),
    ],
)
def test_names_without_the_engines_conventions(
    table: ModuleType, name: str, kind: str, feature: str
) -> None:
    assert table.features.plain(name, kind) == feature
