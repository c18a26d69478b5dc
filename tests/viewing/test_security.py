"""Which requests reach the feed, and the security headers for the browser."""

from __future__ import annotations

import http.client
from typing import TYPE_CHECKING
from urllib.parse import urlsplit

import pytest
from starlette.datastructures import Headers
from websockets.exceptions import InvalidStatus

import pacinian as pc
from pacinian.errors import ServerError
from pacinian.viewing import app as app_module
from pacinian.viewing.app import is_allowed
from pacinian.viewing.run import bind

from .watching import Page, viewer

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path


@pytest.fixture(scope="module")
def url(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    with viewer(tmp_path_factory.mktemp("none") / "no server") as address:
        yield address


def test_only_the_token_opens_the_feed_and_it_is_another_each_time(
    url: str, tmp_path: Path
) -> None:
    with Page(url) as page:
        assert page.next("hello")["version"] == 2
    place, _, token = url.partition("?token=")
    assert len(token) >= 43  # 32 bytes
    for wrong in (
        "",
        "?token=",
        f"?token={token[:-1]}",
        f"?token={token}x",
        "?token=%C3%A9",
        f"?t={token}",
    ):
        with pytest.raises(InvalidStatus, match="403"):
            Page(place + wrong)
    with viewer(tmp_path / "no server") as other:
        assert other.partition("?token=")[2] != token
        with pytest.raises(InvalidStatus, match="403"):
            Page(other.partition("?")[0] + f"?token={token}")


@pytest.mark.parametrize(
    "origin",
    ["http://evil.example", "null", "https://127.0.0.1", "http://127.0.0.1:1", "http://localhost"],
)
def test_no_other_sites_page_gets_in_even_with_the_token(url: str, origin: str) -> None:
    with pytest.raises(InvalidStatus, match="403"):
        Page(url, origin=origin)


def asked(url: str, host: str, path: str = "/") -> http.client.HTTPResponse:
    parts = urlsplit(url)
    assert parts.hostname
    connection = http.client.HTTPConnection(parts.hostname, parts.port)
    connection.putrequest("GET", path, skip_host=True)
    connection.putheader("Host", host.replace("PORT", str(parts.port)))
    connection.endheaders()
    response = connection.getresponse()
    response.body = response.read()  # type: ignore[attr-defined]
    connection.close()
    return response


@pytest.mark.parametrize(
    "host", ["evil.example", "evil.example:PORT", "127.0.0.1.evil.example", "", "[", "0.0.0.0"]
)
def test_no_name_that_another_gave_this_machine_gets_an_answer(url: str, host: str) -> None:
    assert asked(url, host).status == 403


@pytest.mark.parametrize(
    "host", ["127.0.0.1:PORT", "localhost:PORT", "[::1]:PORT", "localhost:8080"]
)
def test_this_machines_own_names_do(url: str, host: str) -> None:
    response = asked(url, host)
    assert response.status in (200, 503)
    policy = response.getheader("content-security-policy")
    assert policy is not None
    rules = dict(rule.strip().split(" ", 1) for rule in policy.split(";"))
    assert rules["default-src"] == "'self'"
    assert rules["frame-ancestors"] == rules["object-src"] == rules["base-uri"] == "'none'"
    assert "unsafe" not in policy
    assert response.getheader("referrer-policy") == "no-referrer"
    assert response.getheader("x-content-type-options") == "nosniff"
    assert response.getheader("server") is None


@pytest.mark.parametrize(
    "path", ["/../app.py", "/%2e%2e/app.py", "/..%2fapp.py", "//etc/passwd", "/%00"]
)
def test_no_file_but_the_pages_is_served(url: str, path: str) -> None:
    response = asked(url, "localhost", path)
    assert response.status in (400, 404, 503)
    assert b"import" not in response.body  # type: ignore[attr-defined]


def test_a_missing_page_says_what_to_do(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(app_module, "PAGE", tmp_path)
    with viewer(tmp_path / "no server") as url:
        response = asked(url, "localhost")
        assert response.status == 503
        assert b"npm" in response.body  # type: ignore[attr-defined]


def test_a_name_and_an_origin_go_together() -> None:
    assert is_allowed(Headers({"host": "localhost:5", "origin": "http://localhost:5"}))
    assert is_allowed(Headers({"host": "localhost:5"}))
    assert not is_allowed(Headers({"host": "localhost:5", "origin": "http://127.0.0.1:5"}))
    assert not is_allowed(Headers({"host": "localhost:5", "origin": ""}))
    assert not is_allowed(Headers({}))


@pytest.mark.parametrize("host", ["0.0.0.0", "192.168.1.1", "::", "example.org", ""])
def test_it_listens_on_this_machine_only(host: str) -> None:
    with pytest.raises(pc.ArgumentError, match="of this machine alone"):
        bind(host, 0)


def test_a_port_that_is_taken_is_told() -> None:
    with bind("localhost", 0) as first, pytest.raises(ServerError, match="cannot be bound"):
        bind("127.0.0.1", first.getsockname()[1])
