"""The Unreal plugin as text: checks of its build and its engine, without them."""

from __future__ import annotations

import json
import re
from typing import TYPE_CHECKING

import pytest

from . import tools, unreal

if TYPE_CHECKING:
    from pathlib import Path

PLUGIN = json.loads((unreal.PLUGIN / "Pacinian.uplugin").read_text(encoding="utf-8"))
SOURCES = unreal.layer()
HEADERS = sorted((unreal.SOURCE / "Pacinian" / "Public").glob("*.h"))
ENGINE = (unreal.STUBS / "headers.txt").read_text(encoding="utf-8").splitlines()
KNOWN = {line.split()[0] for line in ENGINE if line and not line.startswith("#")}
OWN = {"ZeroMQ", *unreal.MODULES}
ENGINE_MODULES = {
    "Core", "CoreUObject", "Engine", "DeveloperSettings", "HeadMountedDisplay", "InputCore", "PhysicsCore", "Projects",
    "PropertyEditor", "RHI", "RenderCore", "Slate", "SlateCore", "ToolMenus", "UnrealEd",
}  # fmt: skip
CORE = [
    path
    for path in (unreal.SOURCE / "PacinianCore").rglob("*")
    if path.suffix in {".h", ".cpp"} and path.name != "PacinianCoreModule.cpp"
]
FORBIDDEN = r"\b(try|catch|throw|dynamic_cast|typeid)\b"
LENGTHS = {"Amplitude", "Diameter", "MouseReach", "Radius", "Thickness", "Reach"}


def named(path: Path) -> str:
    return path.name


def test_the_descriptor_names_modules_that_there_are() -> None:
    assert PLUGIN["FileVersion"] == 3
    assert [module["Name"] for module in PLUGIN["Modules"]] == list(unreal.MODULES)
    for module in PLUGIN["Modules"]:
        rules = unreal.SOURCE / module["Name"] / f"{module['Name']}.Build.cs"
        assert f"public class {module['Name']} : ModuleRules" in rules.read_text(encoding="utf-8")
        assert module["Type"] == ("Editor" if module["Name"].endswith("Editor") else "Runtime")
        is_editor = module["Type"] == "Editor"  # GUnrealEd does not exist in the phase Default
        assert module["LoadingPhase"] == ("PostEngineInit" if is_editor else "Default")
        made = [f for f in SOURCES if f", {module['Name']})" in f.read_text(encoding="utf-8")]
        assert len(made) == 1, "one IMPLEMENT_MODULE each"


@pytest.mark.parametrize("rules", sorted(unreal.SOURCE.rglob("*.Build.cs")), ids=named)
def test_build_rules_name_modules_that_there_are(rules: Path) -> None:
    text = rules.read_text(encoding="utf-8")
    name = rules.name.removesuffix(".Build.cs")
    assert rules.parent.name == name
    for listed in re.findall(r"DependencyModuleNames\.AddRange\(new string\[\] \{(.*?)\}", text):
        assert set(re.findall(r'"(\w+)"', listed)) <= OWN | ENGINE_MODULES
    if name in unreal.MODULES:
        for setting in ("bUseUnity = false", "bEnableExceptions = false", "bUseRTTI = false"):
            assert setting in text
    else:
        assert "ModuleType.External" in text
        assert "BuildException" in text, "says what is missing"
    assert text.count("{") == text.count("}")


def test_libzmq_is_used_only_where_it_is() -> None:
    text = (unreal.SOURCE / "PacinianCore" / "PacinianCore.Build.cs").read_text(encoding="utf-8")
    always, found, there = text.partition("if (File.Exists(Header))")
    assert found
    assert "ExternalDependencies" not in always, "a file that is missing"
    assert '"ZeroMQ"' not in re.findall(r"new string\[\] \{.*?\}", always)[0]
    assert "PACINIAN_LIBZMQ" not in always
    assert '"ZeroMQ"' in there
    assert "PACINIAN_LIBZMQ=1" in there


@pytest.mark.deep("cmake")
def test_the_recipe_places_libzmq_where_the_module_looks(tmp_path: Path) -> None:
    """CMake configures it, and it places stubs of what it would have built: it downloads nothing."""
    recipe = unreal.SOURCE / "ThirdParty"
    tools.run("cmake", "-S", recipe, "-B", tmp_path / "build")
    assert "zeromq" in tools.run("cmake", "--build", tmp_path / "build", "--target", "help")
    here, stage = tmp_path / "plugin" / "Source" / "ThirdParty", tmp_path / "stage"
    for name in ("zeromq/include/zmq.h", "zeromq/lib/libzmq.so.5"):
        (stage / name).parent.mkdir(parents=True, exist_ok=True)
        (stage / name).touch()
    tools.run("cmake", f"-DHERE={here}", f"-DSTAGE={stage}", "-P", recipe / "place.cmake")
    assert (here / "ZeroMQ" / "Include" / "zmq.h").exists()
    library = tmp_path / "plugin" / "Binaries" / "ThirdParty" / "ZeroMQ" / "Linux" / "libzmq.so.5"
    assert library.exists()


def test_nothing_but_text_is_kept() -> None:
    listed = tools.run("git", "ls-files", "-co", "--exclude-standard", folder=unreal.PLUGIN)
    assert listed
    for name in listed.splitlines():
        (unreal.PLUGIN / name).read_text(encoding="utf-8")


def test_sources_keep_to_what_the_engine_has() -> None:
    own = {f.name for f in SOURCES}
    for path in SOURCES:
        text = unreal.code(path)
        assert not re.search(FORBIDDEN, text), path
        only_core = r"\bstd::(thread|mutex|this_thread|async|future)\b"
        assert not re.search(only_core, text), path
        assert not re.search(r"\b(sleep|Sleep|Wait|FEvent|zmq_\w+)\b", text), path
        raw = path.read_text(encoding="utf-8")
        longest = 250 if path.parent.name == "Public" else 200  # a class cannot be split
        assert len(raw.splitlines()) <= longest, path
        for include in re.findall(r'#include "(.*?)"', raw):
            of_core = include.startswith("pacinian/")
            assert include in own | KNOWN or of_core or ".generated.h" in include, (path, include)
            if of_core:
                before = raw[: raw.index(include)]
                begun, ended = (before.count(f"THIRD_PARTY_INCLUDES_{w}") for w in ("START", "END"))
                assert begun > ended, (path, include)
                assert path.parent.name == "Private", path


def test_the_core_knows_nothing_of_the_engine_and_its_public_headers_need_no_library() -> None:
    for path in CORE:
        text, raw = unreal.code(path), path.read_text(encoding="utf-8")
        assert not re.search(FORBIDDEN, text), path
        assert not re.search(r"\b(UE_LOG|FString|UObject|TEXT)\b", text), path
        assert not KNOWN.intersection(re.findall(r'#include "(.*?)"', raw)), path
        if "Public" in path.parts:
            assert not re.search(r"#include <(zmq|windows)", raw), path


@pytest.mark.deep("g++")
@pytest.mark.parametrize("macro", ["DLLEXPORT", "DLLIMPORT"])
def test_the_core_compiles_with_the_macro_of_the_engines_build(macro: str, tmp_path: Path) -> None:
    """The engine's header, which defines the macros again, comes last; or before all."""
    public = unreal.SOURCE / "PacinianCore" / "Public"
    headers = sorted(public.rglob("*.h"))
    for header in headers:
        text = header.read_text(encoding="utf-8")
        assert "PACINIANCORE_API" not in text or header.name == "api.h" or "pacinian/api.h" in text
    includes = [f'#include "{header.relative_to(public).as_posix()}"\n' for header in headers]
    engine = '#define DLLEXPORT __attribute__((visibility("default")))\n'
    engine += engine.replace("DLLEXPORT", "DLLIMPORT")
    last, first = tmp_path / "last.cpp", tmp_path / "first.cpp"
    last.write_text("".join([*includes, engine]))
    first.write_text("".join([engine, *includes]))
    sources = [last, first]
    if macro == "DLLEXPORT":
        sources.append(unreal.SOURCE / "PacinianCore" / "Private" / "client" / "client.cpp")
    tools.run(
        "g++", "-std=c++17", "-fsyntax-only", "-Wall", "-Wextra", "-Werror", "-fno-exceptions",
        f"-DPACINIANCORE_API={macro}", "-I", public, "-I", public.parent / "Private", *sources,
    )  # fmt: skip


def test_headers_are_as_their_tool_wants_them() -> None:
    for header in HEADERS:
        text = header.read_text(encoding="utf-8")
        includes = re.findall(r'#include "(.*?)"', text)
        assert includes[-1] == f"{header.stem}.generated.h"
        assert text.startswith("#pragma once"), header
        found = unreal.classes(header)
        assert len(found) <= 1, f"one class each: {header}"
        assert text.count("GENERATED_BODY()") == len(found), header
        for enum in re.findall(r"UENUM\(BlueprintType\)\n(.*)", text):
            assert re.match(r"enum class E\w+ : uint8 \{", enum), header
        for member in (member for each in found for member in each.members):
            at = header.name, member.text
            assert "std::" not in member.text, at  # reflection has no such type
            told = member.text.split("(")[0] if member.kind == "UFUNCTION" else member.text
            assert not re.search(r"\b(uint32|size_t|unsigned)\b", told), at
            if member.kind == "UPROPERTY" and member.specifiers:
                flag = re.match(r"bool (\w+)", member.text)
                assert flag is None or re.match(r"b[A-Z]", flag[1]), at
            if "Edit" in member.specifiers or "Blueprint" in member.specifiers:
                assert "Category" in member.specifiers or "Config" in member.specifiers, at
            if "CallInEditor" in member.specifiers:  # buttons have neither arguments nor results
                assert re.match(r"void \w+\(\);", member.text), at


def test_properties_say_their_units() -> None:
    for header in HEADERS:
        for member in (member for each in unreal.classes(header) for member in each.members):
            match, at = re.match(r"float (\w+) =", member.text), (header.name, member.text)
            if member.kind == "UPROPERTY" and match and match[1] in LENGTHS:
                assert "[cm]" in member.comment, at
                assert 'Units = "cm"' in member.specifiers, at
            if match and 'Units = "' in member.specifiers:
                unit = re.findall(r'Units = "(\w+)"', member.specifiers)[0]
                assert f"[{unit}]" in member.comment, at


def test_what_properties_refer_to_is_there() -> None:
    for header in HEADERS:
        text = header.read_text(encoding="utf-8")
        for name in re.findall(r'GetOptions = "(\w+)"', text):
            assert re.search(rf"UFUNCTION\(.*\)\n  TArray<FString> {name}\(\) const;", text)
        for condition in re.findall(r'EditCondition = "(.*?)"', text):
            assert not re.search(r"[<>]", condition), (header.name, "the editor compares no enums")
            for name, word in re.findall(r"(\w+) == \w+::(\w+)", condition):
                assert re.search(rf"\b{name}( =|;)", text)
                assert any(
                    re.search(rf"\b{word}\b", other.read_text(encoding="utf-8"))
                    for other in HEADERS
                )


def test_documents_link_to_what_there_is() -> None:
    for page in (tools.ADAPTERS / "unreal").rglob("*.md"):
        if "Intermediate" in page.parts:
            continue
        text = page.read_text(encoding="utf-8")
        for link in re.findall(r"\]\(([^)#]+)", text):
            assert link.startswith("https://") or (page.parent / link).exists(), (page.name, link)
