"""Generates the C# code that messages share: enumerations, unions, and reading from each socket."""

from __future__ import annotations

from typing import TYPE_CHECKING

from csharp_types import pascal, union

if TYPE_CHECKING:
    from model import Model, Union

REUSED = "if `value` is already a message of the same kind, it is reused"


def words(model: Model, for_tests: bool) -> list[str]:
    """Return the enumerations and their encoded words."""
    lines: list[str] = []
    if not for_tests:
        for kind in model.words:
            lines += [f"/// <summary>{', '.join(kind.values)}.</summary>"]
            lines += [f"public enum {kind.name}", "{"]
            lines += [*(f"    {pascal(value)}," for value in kind.values), "}", ""]
        lines += ["/// <summary>The encoded words of the enumerations.</summary>"]
    lines += ["internal static partial class Words", "{"]
    if not for_tests:
        for kind in model.words:
            given = ", ".join(f'"{value}"' for value in kind.values)
            lines.append(f"    public static readonly byte[][] {kind.name} = Utf8.Of({given});")
    for kind in model.words:
        if (kind.name in model.heard) != for_tests:
            lines += [
                *([""] if lines[-1] != "{" else []),
                f"    public static bool Read(Reader r, ref {kind.name} value)",
                "    {",
                "        int index;",
                f"        bool known = r.Word({kind.name}, out index);",
                f"        value = known ? ({kind.name})index : value;",
                "        return known;",
                "    }",
            ]
    return [*lines, "}"]


def unions(model: Model, for_tests: bool) -> list[str]:
    """Return interfaces, words that stand for a message, and functions that read any message of a union."""
    lines: list[str] = []
    for each in model.unions:
        lines += _declare(each, model, for_tests)
        if each.words and not for_tests:
            lines += [*_generate_named(each), ""]
    if not for_tests:
        lines += [f"/// <summary>Reads one of several messages; {REUSED}.</summary>"]
    lines += ["internal static partial class Unions", "{"]
    for each in model.unions:
        if (each.name in model.heard) != for_tests:
            gap = [""] if lines[-1] != "{" else []
            lines += gap + [f"    {line}".rstrip() for line in _reader(each, model)]
    return [*lines, "}"]


def _declare(each: Union, model: Model, for_tests: bool) -> list[str]:
    """Return the interface of a union, unless its messages have a base. Only tests write what a client receives."""
    is_written = each.name in model.written
    if each.base or (for_tests and is_written):
        return []
    partial = "" if is_written else "partial "
    return [
        *([] if for_tests else [f"/// <summary>One of {', '.join(each.kinds)}.</summary>"]),
        f"public {partial}interface {union(each)}{' : IMessage' * (is_written or for_tests)}",
        "{",
        "}",
        "",
    ]


def _generate_named(each: Union) -> list[str]:
    """Return a class for a word that stands for a message."""
    assert each.words
    kind = each.words.name
    return [
        f"/// <summary>A word that stands for an {union(each)}: one of {kind}.</summary>",
        f"public sealed class Named{each.name} : {union(each)}",
        "{",
        "    /// <summary>The word.</summary>",
        f"    public {kind} Value;",
        "",
        "    /// <inheritdoc/>",
        "    public void Write(Writer w)",
        "    {",
        f"        w.Word(Words.{kind}[(int)Value]);",
        "    }",
        "",
        "    /// <summary>Reads the word.</summary>",
        "    public bool Read(Reader r)",
        "    {",
        "        return Words.Read(r, ref Value);",
        "    }",
        "}",
    ]


def _reader(each: Union, model: Model) -> list[str]:
    tags = {message.name: message.tag for message in model.messages}
    given = ", ".join(f'"{tags[kind]}"' for kind in each.kinds)
    kinds = [*each.kinds, *([f"Named{each.name}"] if each.words else [])]
    word = ["if (r.IsText())", "{", *(f"    {line}" for line in _take(kinds[-1])), "}"]
    lines = [
        f"private static readonly byte[][] {each.name}Tags = Utf8.Of({given});",
        "",
        f"public static bool Read(Reader r, ref {union(each)} value)",
        "{",
        *(f"    {line}" for line in (word if each.words else [])),
        f"    switch (r.Tag({each.name}Tags))",
        "    {",
    ]
    for i, kind in enumerate(each.kinds):
        lines += [f"        case {i}:", "        {"]
        lines += [*(f"            {line}" for line in _take(kind)), "        }"]
    return [*lines, "        default: return false;", "    }", "}"]


def _take(kind: str) -> list[str]:
    return [
        f"{kind} made = value as {kind} ?? new {kind}();",
        "value = made;",
        "return made.Read(r);",
    ]


def protocol(model: Model, for_tests: bool) -> list[str]:
    """Return the constants of the protocol, and functions that read from each socket."""
    lines = ["public static partial class Protocol", "{"]
    if not for_tests:
        lines.insert(
            0,
            "/// <summary>Constants of the protocol, and functions that read its messages.</summary>",
        )
        for name, value in model.constants.items():
            kind = "double" if isinstance(value, float) else "int"
            lines.append(f"    public const {kind} {pascal(name.lower())} = {value};")
    for socket, (each, most) in model.sockets.items():
        if (each.name in model.heard) == for_tests:
            continue
        place = "Reader r, byte[] data, int start, int count"
        lines += [
            *([""] if lines[-1] != "{" else []),
            f"    /// <summary>Reads a message of the kind `{socket}`; {REUSED}.</summary>",
            f"    public static bool Read{pascal(socket)}({place}, ref {union(each)} value)",
            "    {",
            f"        return r.Begin(data, start, count, {most})",
            "            && Unions.Read(r, ref value) && r.End();",
            "    }",
        ]
    return [*lines, "}"]
