"""The configuration file."""

from __future__ import annotations

from pathlib import Path

import msgspec
import pytest
from click.testing import CliRunner

from pacinian.acoustics.air import Air
from pacinian.cli.serve import _override, serve
from pacinian.errors import ArgumentError, SceneFileError
from pacinian.serving.ipc.launch_config import LaunchConfig
from pacinian.serving.settings import Network, Security, Settings, load

ZONE = "[[safety.zones]]\nposition = [0, 0, 0.2]\npressure = 1"
EXAMPLE = Path(__file__).parents[3] / "packaging" / "server.toml"


def written(folder: Path, text: str) -> Path:
    path = folder / "server.toml"
    path.write_text(text)
    return path


def test_an_empty_file_holds_the_defaults(tmp_path: Path) -> None:
    assert load(written(tmp_path, "")) == Settings()


def test_the_example_says_what_the_defaults_are() -> None:
    from msgspec.structs import replace

    told, usual = load(EXAMPLE), Settings()
    assert told.medium.make() == usual.medium.make()
    assert replace(told, medium=usual.medium) == usual


def test_what_the_example_switches_off_can_be_switched_on(tmp_path: Path) -> None:
    lines = EXAMPLE.read_text().splitlines()
    on = [
        line[2:] if line.startswith("# ") and (" = " in line or "[" in line) else line
        for line in lines
    ]
    told = load(written(tmp_path, "\n".join(on[2:])))
    assert told.workspace is not None
    assert told.power == 800.0
    assert len(told.safety.zones) == 1


def test_the_example_names_every_key() -> None:
    text = EXAMPLE.read_text()
    for name in Settings.__struct_fields__:
        assert f"{name} =" in text or f"[{name}" in text, name
        part = getattr(Settings(), name)
        if isinstance(part, msgspec.Struct) and name not in ("array", "medium", "sampling"):
            for key in part.__struct_fields__:
                assert f"{key} =" in text or f".{key}]" in text, (name, key)


@pytest.mark.parametrize(
    ("text", "key", "words"),
    [
        ("[safety]\nleese = 0.2", "$.safety", "did you mean `lease`"),
        ("ratte = 2", "", "did you mean `rate`"),
        ("[log]\ncolour = 1", "$.log", "there are"),
        ("[log]\nformat = 'xml'", "$.log.format", "there are console, json"),
        ("[safety]\nlease = 11", "$.safety", "`lease` must be 0.05 or more and at most 10"),
        ("[safety]\nlease = nan", "$.safety", "finite"),
        ("[safety]\npressure = 0", "$.safety", "more than 0"),
        ("[safety]\nframe_timeout = 1e-4", "$.safety", "0.002"),
        ("[network]\nhost = 'example.org'", "$.network", "IP address"),
        ("[network]\ncontrol = 70000", "$.network.control", "65535"),
        ("[network]\nhost = '0.0.0.0'", "", "pacinian keys server"),
        ("[network]\nhost = '::'", "", "`security.keys`"),
        ("[clients]\nmax_sessions = 0", "$.clients.max_sessions", ">= 1"),
        ("[clients]\nmax_command_bytes = 9999999", "$.clients.max_command_bytes", "<="),
        ("[log]\nformat = 'xml'", "$.log.format", "xml"),
        ("gain = 1.5", "", "at most 1"),
        ("power = 0", "", "1e-12"),
        ("state_rate = 0", "", "1 or more"),
        ("[[safety.zones]]\nposition = [0, 0]\npressure = 1", "$.safety.zones", "length"),
        (f"{ZONE}\n{ZONE.replace('0.2]', '200]')}", "$.safety.zones[1]", "not millimetres"),
        (ZONE.replace("0.2]", "10.2]"), "$.safety.zones[0]", "10.2 m from the array's centre"),
        (f"{ZONE}\nradius = 0.5", "$.safety.zones[0]", "make the zone smaller, or move it"),
        ("[array]\ntype = 'lattice'\nwidth = -1.0\nheight = 0.1", "$.array", "width"),
        ("[medium]\nhumidity = 7.0", "$.medium", "humidity"),
        ("rate = ", "", "is not TOML"),
    ],
)
def test_what_cannot_be_meant_is_refused_by_file_and_key(
    tmp_path: Path, text: str, key: str, words: str
) -> None:
    path = written(tmp_path, text)
    with pytest.raises(SceneFileError) as caught:
        load(path)
    assert str(path) in str(caught.value)
    assert words in str(caught.value)
    assert caught.value.key.startswith(key)


def test_paths_are_relative_to_the_file(tmp_path: Path) -> None:
    text = "connection = 'c.json'\n[security]\nkeys = 'keys'\n[network]\nhost = '10.0.0.7'"
    told = load(written(tmp_path, text))
    assert told.security.keys == str(tmp_path / "keys")
    assert told.connection == str(tmp_path / "c.json")


def test_a_file_that_is_not_there_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(SceneFileError, match="not there"):
        load(tmp_path / "none.toml")


@pytest.mark.parametrize(
    ("host", "loopback", "bound", "local"),
    [
        ("127.0.0.1", True, "tcp://127.0.0.1:5", "tcp://127.0.0.1:5"),
        ("127.9.9.9", True, "tcp://127.9.9.9:5", "tcp://127.9.9.9:5"),
        ("::1", True, "tcp://[::1]:5", "tcp://[::1]:5"),
        ("0.0.0.0", False, "tcp://0.0.0.0:5", "tcp://127.0.0.1:5"),
        ("::", False, "tcp://[::]:5", "tcp://[::1]:5"),
        ("192.168.1.2", False, "tcp://192.168.1.2:5", "tcp://192.168.1.2:5"),
    ],
)
def test_endpoints(host: str, loopback: bool, bound: str, local: str) -> None:
    network = Network(host=host)
    assert network.loopback is loopback
    assert network.endpoint(5) == bound
    assert network.endpoint(5, local=True) == local


def test_elsewhere_without_keys_cannot_be_made_in_code_either() -> None:
    with pytest.raises(ArgumentError, match="keys"):
        Settings(network=Network(host="10.0.0.1"))
    Settings(network=Network(host="10.0.0.1"), security=Security("keys"))


def test_options_of_the_command_go_before_the_file() -> None:
    given = {
        "host": "127.0.0.2",
        "control": 0,
        "state": 7,
        "solver": "gs",
        "keys": "k",
        "metrics": 9,
        "log_format": "json",
        "quiet": True,
        "backend": None,
        "connection": None,
    }
    told = _override(load(EXAMPLE), given)
    assert (told.network.host, told.network.control, told.network.state) == ("127.0.0.2", 0, 7)
    assert (told.solver, told.backend, told.security.keys) == ("gs", "simulated", "k")
    assert (told.metrics.port, told.log.format, told.log.level) == (9, "json", "warning")
    assert _override(load(EXAMPLE), {"quiet": False, "backend": None}) == load(EXAMPLE)
    with pytest.raises(ArgumentError, match="keys"):
        _override(Settings(), {"host": "0.0.0.0"})


def test_the_command_names_what_is_wrong_with_its_file(tmp_path: Path) -> None:
    result = CliRunner().invoke(serve, [str(written(tmp_path, "[safety]\nleese = 1"))])
    assert isinstance(result.exception, SceneFileError)
    assert "lease" in str(result.exception)


def test_children_are_told_the_same_settings() -> None:
    told = LaunchConfig("/folder", load(EXAMPLE), {"token": "x"})
    assert msgspec.json.decode(msgspec.json.encode(told), type=LaunchConfig) == told


def test_as_many_frames_make_a_region_as_in_a_renderer() -> None:
    from pacinian.rendering.frame_cycle import MAX_FRAMES

    assert Settings().max_cycle_frames == MAX_FRAMES


def test_a_temperature_goes_before_the_speed_and_density_of_the_file(tmp_path: Path) -> None:
    path = written(tmp_path, "[medium]\nspeed_of_sound = 340.0\ndensity = 1.2\nhumidity = 0.3")
    made = _override(load(path), {"temperature": 26.0, "quiet": False}).medium.make()
    assert made == Air(temperature=26.0, humidity=0.3)
    with pytest.raises(ArgumentError, match="temperature"):
        _override(Settings(), {"temperature": 300.0})


def test_the_capabilities_tell_the_air_that_is_computed_with() -> None:
    from pacinian.acoustics.array import autd
    from pacinian.cli.status import air, describe_air
    from pacinian.serving.control.state_builder import describe_sound

    for medium, said in (
        (Air(temperature=26.0), "26 °C, 347.7 m/s"),
        (Air(speed_of_sound=340.0), "340.0 m/s"),
        (Air(), "22 °C, 345.1 m/s"),
    ):
        told = describe_sound(autd(), medium)
        assert describe_air(told) == said
        assert air(told) == {
            "temperature": medium.temperature,
            "speed_of_sound": medium.speed_of_sound,
        }
    assert describe_air(None) == "not reported"
    assert air(None) == {}
