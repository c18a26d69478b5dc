"""Keys and secrets. control/test_process_rejections.py tests on real sockets that they keep strangers out."""

from __future__ import annotations

import os
import stat
from typing import TYPE_CHECKING

import pytest
import zmq
from click.testing import CliRunner
from zmq.auth import load_certificate

from pacinian.cli.keys import keys as command
from pacinian.errors import ArgumentError, ServerError
from pacinian.serving.ipc import auth
from pacinian.serving.ipc.auth import (
    ClientAuthenticator,
    make_client_keys,
    make_secrets,
    make_server_keys,
    write_remote_connection,
)
from pacinian.serving.settings import Network, Security, Settings
from pacinian.wire.connection_file import Connection

if TYPE_CHECKING:
    from pathlib import Path


def mode(path: Path) -> int:
    return stat.S_IMODE(path.stat().st_mode)


@pytest.mark.skipif(os.name != "posix", reason="file permissions")
def test_secret_keys_are_for_their_owner_only_whatever_the_umask(tmp_path: Path) -> None:
    """`zmq.auth.create_certificates` alone would write them with mode 0644."""
    before = os.umask(0o022)
    try:
        pairs = [
            make_server_keys(tmp_path / "keys"),
            make_client_keys(tmp_path / "keys", "tablet"),
        ]
    finally:
        os.umask(before)
    assert [mode(secret) for _, secret in pairs] == [0o600, 0o600]
    assert sorted(str(p.relative_to(tmp_path)) for p in tmp_path.rglob("*") if p.is_file()) == [
        "keys/clients/tablet.key",
        "keys/server.key",
        "keys/server.key_secret",
        "keys/tablet.key_secret",
    ]
    for public, secret in pairs:
        assert load_certificate(public) == (load_certificate(secret)[0], None)
        assert b"secret-key" not in public.read_bytes()


def test_keys_are_never_overwritten(tmp_path: Path) -> None:
    make_client_keys(tmp_path, "tablet")
    with pytest.raises(ServerError, match="already"):
        make_client_keys(tmp_path, "tablet")


@pytest.mark.parametrize("name", ["", "a/b", "..", "x" * 65, "a b", "server", "\0"])
def test_names_that_are_no_files_are_refused(tmp_path: Path, name: str) -> None:
    with pytest.raises(ArgumentError):
        make_client_keys(tmp_path, name)


def test_a_folder_that_cannot_be_written_is_an_error(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(ServerError):
        make_client_keys(tmp_path / "file", "tablet")


def test_on_loopback_each_run_has_a_token_of_its_own() -> None:
    first, second = make_secrets(Settings()), make_secrets(Settings())
    assert first.keys() == {"token"}
    assert len(first["token"]) == 64
    assert first != second


def test_elsewhere_the_servers_keys_are_read_and_a_local_client_is_made(tmp_path: Path) -> None:
    settings = Settings(network=Network(host="0.0.0.0"), security=Security(str(tmp_path)))
    with pytest.raises(ServerError, match="pacinian keys server"):
        make_secrets(settings)
    public, secret = make_server_keys(tmp_path)
    first, second = make_secrets(settings), make_secrets(settings)
    assert first["server_key"] == second["server_key"] == load_certificate(public)[0].decode()
    assert first["secret_key"] != second["secret_key"]
    if os.name == "posix":
        secret.chmod(0o644)
        with pytest.raises(ServerError, match="chmod 600"):
            make_secrets(settings)


def test_the_allow_list_is_read_again_when_it_changes(tmp_path: Path) -> None:
    make_server_keys(tmp_path)
    settings = Settings(network=Network(host="0.0.0.0"), security=Security(str(tmp_path)))
    secrets = make_secrets(settings)
    with zmq.Context() as context:
        gate = ClientAuthenticator(context, secrets, str(tmp_path))
        assert gate.callback("", secrets["public_key"].encode())
        assert not gate.callback("", zmq.curve_keypair()[0])
        public, _ = make_client_keys(tmp_path, "tablet")
        key = load_certificate(public)[0]
        assert gate.callback("", key)
        assert gate.name_user(key.decode()) == "tablet"
        (tmp_path / "clients" / "broken.key").write_text("nothing")
        (tmp_path / "clients" / "folder.key").mkdir()
        if os.name == "posix":
            (tmp_path / "clients" / "nowhere.key").symlink_to(tmp_path / "nowhere")
        assert gate.callback("", key), "one broken file keeps nobody else out"
        assert not gate.callback("", b"")
        public.unlink()
        assert not gate.callback("", key)
        assert len(gate.take_unknown_keys()) == 3
        assert gate.take_unknown_keys() == []


def test_a_connection_file_for_another_machine(tmp_path: Path) -> None:
    make_server_keys(tmp_path)
    make_client_keys(tmp_path, "tablet")
    path = write_remote_connection(tmp_path, "tablet", "10.0.0.7", (1, 2, 3))
    made = Connection.read(path)
    assert (made.control, made.command, made.state) == tuple(
        f"tcp://10.0.0.7:{n}" for n in (1, 2, 3)
    )
    assert made.public_key == load_certificate(tmp_path / "clients" / "tablet.key")[0].decode()


def test_the_command_makes_keys(tmp_path: Path) -> None:
    folder = str(tmp_path / "keys")
    run = CliRunner().invoke
    assert run(command, ["server", "--folder", folder]).exit_code == 0
    told = run(
        command,
        ["client", "tablet", "--folder", folder, "--host", "10.0.0.7", "--ports", "1", "2", "3"],
    )
    assert told.exit_code == 0, told.output
    assert "tablet.json" in told.output
    assert load_certificate(tmp_path / "keys" / "tablet.key_secret")[1].decode() not in told.output
    assert run(command, ["client", "x", "--folder", folder, "--host", "a"]).exit_code == 2


def test_a_message_of_too_many_parts_is_skipped_a_few_at_a_time() -> None:
    """So that its receiver can stop the output, and end, in between."""
    with (
        zmq.Context() as context,
        context.socket(zmq.ROUTER) as router,
        context.socket(zmq.DEALER) as dealer,
    ):
        dealer.sndhwm = dealer.linger = 0
        router.bind("inproc://parts")
        dealer.connect("inproc://parts")
        dealer.send_multipart([b""] * (3 * auth.MAX_SKIPPED))
        dealer.send(b"next")
        taken = [auth.receive(router) for _ in range(3)]
        assert taken[:2] == [None, None]
        assert taken[2] is not None
        assert taken[2][2] == b"next"
        dealer.send_multipart([b"two", b"parts"])
        whole = auth.receive(router)
        assert whole is not None
        assert whole[2] == b""
        assert auth.receive(router) is None
