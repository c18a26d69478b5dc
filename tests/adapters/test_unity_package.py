"""What Unity's package manager and importer rely on, without Unity: names, files, GUIDs and references."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

from . import tools
from .unity import PACKAGE, build_for_unity

ROOT = tools.ADAPTERS.parent
GENERATE = tools.ADAPTERS / "generate" / "main.py"
BUILT_IN = {"0000000000000000e000000000000000", "0000000000000000f000000000000000"}
ENGINE = {
    "Ultraleap.Tracking.Core", "Unity.InputSystem", "Unity.XR.Hands", "Unity.XR.Interaction.Toolkit",
    "UnityEngine.TestRunner", "UnityEditor.TestRunner",
}  # fmt: skip
LARGEST = 200_000  # [bytes] of a picture
LONGEST = 200  # lines of a source
KEEP = {"LICENSE.md", "README.md", "CHANGELOG.md", "package.json"}

YAML = sorted(p for e in ("unity", "prefab", "asset") for p in PACKAGE.rglob(f"*.{e}"))
SOURCES = sorted(p for p in PACKAGE.rglob("*.cs") if "Core" not in p.parts)
PAGES = sorted(PACKAGE.rglob("*.md"))


def guids() -> dict[str, Path]:
    """Return the assets by their GUIDs."""
    found: dict[str, Path] = {}
    for meta in PACKAGE.rglob("*.meta"):
        match = re.search(r"^guid: ([0-9a-f]{32})$", meta.read_text(encoding="utf-8"), re.MULTILINE)
        assert match, meta
        assert match[1] not in found, meta
        found[match[1]] = meta.with_suffix("")
    return found


def test_each_asset_has_its_meta_file_and_none_is_of_nothing() -> None:
    done = subprocess.run([sys.executable, GENERATE, "--check"], check=False, capture_output=True)
    assert done.returncode == 0, done.stdout.decode()
    assets = set(guids().values())
    for path in PACKAGE.rglob("*"):
        hidden = path.name == "Samples~" or "Documentation~" in path.parts or path.suffix == ".meta"
        assert (path in assets) != hidden, path


@pytest.mark.deep("npm")
def test_the_packed_package_has_exactly_what_is_in_the_folder() -> None:
    said = tools.run("npm", "pack", "--dry-run", "--json", "--offline", folder=PACKAGE)
    (packed,) = json.loads(said[said.index("[") :])
    assert packed["id"] == "com.pacinian.haptics@0.1.0"
    files = {path.relative_to(PACKAGE).as_posix() for path in PACKAGE.rglob("*") if path.is_file()}
    assert {entry["path"] for entry in packed["files"]} == files
    for name in (*KEEP, "Runtime/Core/Pacinian.Core.asmdef", "Samples~/TouchABall/Ball.prefab"):
        assert name in files
    kinds = {Path(name).suffix for name in files}
    assert kinds == {".asmdef", ".asset", ".cs", ".json", ".md", ".meta", ".prefab", ".unity"}


def test_the_manifest() -> None:
    manifest = json.loads((PACKAGE / "package.json").read_text(encoding="utf-8"))
    assert re.fullmatch(r"[a-z0-9-]+(\.[a-z0-9-]+)+", manifest["name"])
    assert re.fullmatch(r"\d+\.\d+\.\d+", manifest["version"])
    assert f'\nversion = "{manifest["version"]}"\n' in (ROOT / "pyproject.toml").read_text("utf-8")
    assert f"\n## [{manifest['version']}]" in (PACKAGE / "CHANGELOG.md").read_text("utf-8")
    assert re.fullmatch(r"20\d\d\.\d", manifest["unity"])
    assert manifest["license"] == "Apache-2.0"
    assert (PACKAGE / "LICENSE.md").read_bytes() == (ROOT / "LICENSE").read_bytes()
    assert all(name.startswith("com.unity.modules.") for name in manifest["dependencies"])
    for sample in manifest["samples"]:
        assert set(sample) == {"displayName", "description", "path"}
        assert (PACKAGE / sample["path"]).is_dir()
    assert len(manifest["samples"]) == len(list((PACKAGE / "Samples~").iterdir())) // 2


def test_assemblies() -> None:
    asmdefs = {path: json.loads(path.read_text("utf-8")) for path in PACKAGE.rglob("*.asmdef")}
    names = {made["name"] for made in asmdefs.values()}
    assert len(names) == len(asmdefs)
    for path, made in asmdefs.items():
        assert path.stem == made["name"]
        assert set(made["references"]) <= names | ENGINE
        assert made["includePlatforms"] in ([], ["Editor"])
        assert (made["includePlatforms"] == ["Editor"]) == ("Editor" in path.parts)
        assert made["noEngineReferences"] == (made["name"] == "Pacinian.Core")
        assert made["includePlatforms"] or "Tests" in path.parts or made["excludePlatforms"]
    for source in PACKAGE.rglob("*.cs"):
        assert any(path.parent in source.parents for path in asmdefs), source


@pytest.mark.deep("mcs")
def test_it_compiles_with_what_unity_has(tmp_path: Path) -> None:
    """Its tests, too: Unity compiles them in each project that has the package in its folder Packages."""
    build_for_unity(tmp_path)


@pytest.mark.parametrize("path", YAML, ids=lambda p: p.name)
def test_references_resolve(path: Path) -> None:
    text, known = path.read_text(encoding="utf-8"), guids()
    assert text.startswith("%YAML 1.1\n%TAG !u! tag:unity3d.com,2011:\n")
    own = re.findall(r"^--- !u!\d+ &(\d+)", text, re.MULTILINE)
    assert len(own) == len(set(own))
    for number, of in re.findall(r"\{fileID: (\d+)(?:, guid: ([0-9a-f]+), type: \d)?\}", text):
        if not of:
            assert number == "0" or number in own, number
        elif of not in BUILT_IN:
            asset = known[of]
            assert asset.is_file()
            inside = {".cs": "11500000", ".asset": "11400000"}.get(asset.suffix)
            inside = inside or (
                number if f"&{number}\n" in asset.read_text("utf-8") else "100100000"
            )
            assert number == inside, (number, asset)


@pytest.mark.parametrize("path", YAML, ids=lambda p: p.name)
def test_components_have_the_fields_that_are_set(path: Path) -> None:
    known = guids()
    for part in path.read_text(encoding="utf-8").split("--- !u!")[1:]:
        script = re.search(r"m_Script: \{fileID: 11500000, guid: ([0-9a-f]+)", part)
        if script:
            source = known[script[1]]
            _, _, body = part.partition("m_EditorClassIdentifier: \n")
            told = re.findall(r"^  (\w+):", body, re.MULTILINE)
            assert told == fields(source), source


def fields(source: Path) -> list[str]:
    """Return the names of the fields that Unity serialises, in order, those of the base class first."""
    text = re.sub(r'"[^"]*"', '""', source.read_text(encoding="utf-8"))
    base = re.search(r"class \w+ : (Haptic\w+)", text)
    first = fields(PACKAGE / "Runtime" / f"{base[1]}.cs") if base else []
    found = re.findall(r"\[SerializeField[^;]*?private [\w.\[\]]+ (\w+)(?: =|;)", text, re.DOTALL)
    return first + found


def test_unity_finds_each_component_by_the_name_of_its_file() -> None:
    known = r"class (\w+) : (?:MonoBehaviour|ScriptableObject|HapticEffect|HandProvider)\b"
    found = 0
    for source in SOURCES:
        if "Tests" not in source.parts:
            for name in re.findall(known, source.read_text(encoding="utf-8")):
                assert source.stem == name, source
                found += 1
    assert found >= 12


def test_sources_are_short_and_make_no_garbage_by_linq() -> None:
    for path in SOURCES:
        text = path.read_text(encoding="utf-8")
        assert "\r" not in text, path
        assert "System.Linq" not in text, path
        assert text.count("\n") < LONGEST, path
        assert max(map(len, text.split("\n"))) <= 140, path


@pytest.mark.parametrize("page", PAGES, ids=lambda p: p.name)
def test_links_lead_somewhere(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    for link in re.findall(r"\]\(([^)]+)\)", text):
        if "://" in link or link.startswith("#"):
            continue
        name, _, heading = link.partition("#")
        target = (page.parent / name).resolve()
        assert target.exists(), link
        if heading:
            heads = re.findall(r"^#+ (.*)$", target.read_text(encoding="utf-8"), re.MULTILINE)
            made = {re.sub(r"[^\w -]", "", head.lower()).replace(" ", "-") for head in heads}
            assert heading in made, link
        if target.suffix == ".png":
            assert target.stat().st_size < LARGEST, link
