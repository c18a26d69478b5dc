from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any, get_args

import jsonschema
import msgpack
import pytest
from click.testing import CliRunner

from pacinian.cli.wire import wire
from pacinian.serving.settings import Safety
from pacinian.wire import commands, control, objects, protocol, replies, state
from pacinian.wire.asyncapi import CHANNELS, make_asyncapi
from pacinian.wire.codec import encode
from pacinian.wire.message_docs import describe_fields, summarise
from pacinian.wire.protocol_pages import make_guide, make_reference
from pacinian.wire.silence_cause import CAUSES
from pacinian_lab.vectors.examples import make_examples

ROOT = Path(__file__).parents[3]
DOCUMENT = make_asyncapi()
PAGE = f"{make_guide(Safety().lease)}\n{make_reference()}"
KINDS = [
    *commands.COMMANDS,
    *control.CONTROLS,
    *replies.REPLIES,
    *state.STATES,
    *objects.OBJECTS,
    *(commands.HandFrame, commands.Zone, control.Choice, replies.Plugin, state.ClientState),
]


def test_what_is_published_is_what_the_commands_print() -> None:
    told = CliRunner().invoke(wire).output
    pages = [(ROOT / "docs" / name).read_text("utf-8") for name in ("wire.md", "wire-messages.md")]
    assert "\n".join(pages) == told == PAGE
    schema = CliRunner().invoke(wire, ["--schema"]).output
    assert json.loads(schema) == json.loads(json.dumps(DOCUMENT))


def test_every_message_and_field_says_what_it_is() -> None:
    for kind in KINDS:
        assert len(summarise(kind)) > 4, kind
        assert summarise(kind) in PAGE
        for field in describe_fields(kind):
            assert field.meaning, field
            assert field.type, field


def test_every_number_of_a_client_has_bounds() -> None:
    numbers = r"\b(int|float|bin|str|array|map)\b"
    for kind in (*commands.COMMANDS, *control.CONTROLS, *objects.OBJECTS, commands.HandFrame):
        for field in describe_fields(kind):
            if re.match(numbers, re.sub(r"\[.*?\]\(.*?\)", "", field.type)):
                assert field.bounds, (kind, field)


def test_its_tables_have_as_many_cells_as_columns() -> None:
    rows = [line for line in PAGE.splitlines() if line.startswith("|")]
    assert {line.count("|") for line in rows} == {3, 5, 6}


def test_its_links_lead_somewhere() -> None:
    headings = re.findall(r"^#+ (.*)$", PAGE, re.MULTILINE)
    anchors = [re.sub(r"[^\w -]", "", h.lower()).replace(" ", "-") for h in headings]
    for target in set(re.findall(r"\]\(#(.*?)\)", PAGE)):
        assert anchors.count(target) == 1, target
    for target in set(re.findall(r"\]\(([^#].*?)\)", PAGE)):
        assert (ROOT / "docs" / target.partition("#")[0]).exists(), target


def test_it_has_no_gaps_and_gives_the_limits() -> None:
    assert "{{" not in PAGE
    assert f"{protocol.MAX_COMMAND_BYTES:,} bytes" in PAGE
    for code in get_args(replies.Code):
        assert f"| `{code}` | {replies.CODES[code]} |" in PAGE
    for output in get_args(state.Output):
        assert f"| `{output}` | {state.OUTPUTS[output]} |" in PAGE
    for cause, meaning in CAUSES.items():
        assert f"| `{cause}` | {meaning} |" in PAGE
    assert set(replies.CODES) == set(get_args(replies.Code))


def references(value: Any) -> list[str]:
    if isinstance(value, list):
        return [ref for item in value for ref in references(item)]
    if isinstance(value, dict):
        own = [value["$ref"]] if isinstance(value.get("$ref"), str) else []
        return own + references(list(value.values()))
    return []


def test_the_references_of_the_document_lead_somewhere() -> None:
    for reference in references(DOCUMENT):
        place: Any = DOCUMENT
        for part in reference.removeprefix("#/").split("/"):
            place = place[part]
        assert place


def test_the_document_is_asyncapi_3() -> None:
    """The document follows the rules of https://www.asyncapi.com/docs/reference/specification/v3.0.0 that apply."""
    assert DOCUMENT["asyncapi"] == "3.0.0"
    assert DOCUMENT.keys() <= {
        *("asyncapi", "id", "info", "servers", "defaultContentType"),
        *("channels", "operations", "components"),
    }
    assert {"title", "version"} <= DOCUMENT["info"].keys()
    for operation in DOCUMENT["operations"].values():
        assert operation["action"] in ("send", "receive")
        channel = operation["channel"]["$ref"]
        for message in operation["messages"]:  # must belong to that channel
            assert message["$ref"].startswith(channel + "/messages/")
    assert set(DOCUMENT["channels"]) == set(CHANNELS) == {"command", "control", "state"}
    for schema in DOCUMENT["components"]["schemas"].values():
        jsonschema.Draft7Validator.check_schema(schema)
        assert "discriminator" not in json.dumps(schema)  # has another meaning in AsyncAPI


def textual(value: Any) -> Any:
    """Return a message for JSON Schema, with a character for each byte of a `bin`."""
    if isinstance(value, dict):
        return {key: textual(item) for key, item in value.items()}
    if isinstance(value, list):
        return [textual(item) for item in value]
    return value.decode("latin-1") if isinstance(value, bytes) else value


EXAMPLES = [(m, textual(msgpack.unpackb(encode(m)))) for _, _, m in make_examples()]


def validator(kind: type) -> jsonschema.Draft7Validator:
    whole = DOCUMENT | {"$ref": f"#/components/schemas/{kind.__name__}"}
    return jsonschema.Draft7Validator(whole)


def test_the_schemas_accept_what_the_decoder_accepts() -> None:
    for message, value in EXAMPLES:
        validator(type(message)).validate(value)


def test_the_schemas_refuse_what_is_out_of_bounds() -> None:
    for message, value in EXAMPLES:
        wrong = {"session": "short", "id": -1, "type": "x", "ttl": 61.0, "names": ["x" * 65]}
        for name in value.keys() & wrong.keys():
            with pytest.raises(jsonschema.ValidationError):
                validator(type(message)).validate(value | {name: wrong[name]})


def test_a_bin_is_marked_with_its_bounds_in_bytes() -> None:
    schemas = DOCUMENT["components"]["schemas"]
    poses = schemas["Move"]["properties"]["poses"]
    assert poses == {"type": "string", "maxLength": 28 * 256, "x-msgpack": "bin"}
    for kind in KINDS:
        for field in describe_fields(kind):
            marked = "x-msgpack" in schemas[kind.__name__]["properties"][field.name]
            assert marked == (field.type == "bin"), (kind, field)
    assert "base64" not in json.dumps(schemas)
