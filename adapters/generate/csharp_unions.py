"""C# of what messages share: enumerations of words, unions, and what comes to each socket."""

from __future__ import annotations

from typing import TYPE_CHECKING

from csharp_types import pascal, union

if TYPE_CHECKING:
    from model import Model, Union

REUSED = "one of the same kind that is there already is used again"


def words(model: Model) -> list[str]:
    """Enumerations, and their words."""
    lines: list[str] = []
    for kind in model.words:
        lines += [f"/// <summary>{', '.join(kind.values)}.</summary>", f"public enum {kind.name}"]
        lines += ["{", *(f"    {pascal(value)}," for value in kind.values), "}", ""]
    lines += ["/// <summary>The words of the enumerations.</summary>"]
    lines += ["internal static class Words", "{"]
    for kind in model.words:
        given = ", ".join(f'"{value}"' for value in kind.values)
        lines.append(f"    public static readonly byte[][] {kind.name} = Utf8.Of({given});")
    for kind in model.words:
        lines += [
            "",
            f"    public static bool Read(Reader r, ref {kind.name} value)",
            "    {",
            "        int index;",
            f"        bool known = r.Word({kind.name}, out index);",
            f"        value = known ? ({kind.name})index : value;",
            "        return known;",
            "    }",
        ]
    return [*lines, "}"]


def unions(model: Model) -> list[str]:
    """Interfaces, words that stand in for a message, and how it is told which one comes."""
    lines: list[str] = []
    for each in model.unions:
        if not each.base:
            said = f"One of {', '.join(each.kinds)}"
            lines += [
                f"/// <summary>{said}.</summary>",
                f"public interface {union(each)} : IMessage",
            ]
            lines += ["{", "}", ""]
        if each.words:
            lines += [*_generate_named(each), ""]
    lines += [f"/// <summary>Reads one of several messages; {REUSED}.</summary>"]
    lines += ["internal static class Unions", "{"]
    for i, each in enumerate(model.unions):
        lines += ([""] if i else []) + [f"    {line}".rstrip() for line in _reader(each, model)]
    return [*lines, "}"]


def _generate_named(each: Union) -> list[str]:
    """A class for a word where a message could be."""
    assert each.words
    kind = each.words.name
    return [
        f"/// <summary>A word in place of {each.name[0].lower()}{each.name[1:]}: one of {kind}.</summary>",
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
        "    /// <inheritdoc/>",
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


def protocol(model: Model) -> list[str]:
    """The protocol's numbers, and what comes to each socket."""
    lines = ["/// <summary>The protocol's numbers, and its messages.</summary>"]
    lines += ["public static class Protocol", "{"]
    for name, value in model.constants.items():
        lines.append(f"    public const int {pascal(name.lower())} = {value};")
    for socket, (each, most) in model.sockets.items():
        place = "Reader r, byte[] data, int start, int count"
        lines += [
            "",
            f"    /// <summary>Reads a message of the kind `{socket}`; {REUSED}.</summary>",
            f"    public static bool Read{pascal(socket)}({place}, ref {union(each)} value)",
            "    {",
            f"        return r.Begin(data, start, count, {most})",
            "            && Unions.Read(r, ref value) && r.End();",
            "    }",
        ]
    return [*lines, "}"]
