from __future__ import annotations

import dataclasses
import math
import pickle
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

import pacinian as pc
from pacinian.acoustics.air import iso_9613_1

# ISO 9613-2, table 2: attenuation [dB/km] at 63 Hz .. 8 kHz, by temperature [degC] and humidity.
TABLE = {
    (10, 0.70): (0.1, 0.4, 1.0, 1.9, 3.7, 9.7, 32.8, 117),
    (20, 0.70): (0.1, 0.3, 1.1, 2.8, 5.0, 9.0, 22.9, 76.6),
    (30, 0.70): (0.1, 0.3, 1.0, 3.1, 7.4, 12.7, 23.1, 59.3),
    (15, 0.20): (0.3, 0.6, 1.2, 2.7, 8.2, 28.2, 88.8, 202),
    (15, 0.50): (0.1, 0.5, 1.2, 2.2, 4.2, 10.8, 36.2, 129),
    (15, 0.80): (0.1, 0.3, 1.1, 2.4, 4.1, 8.3, 23.7, 82.8),
}


def test_air_is_that_of_a_room_by_default() -> None:
    air = pc.Air()
    assert air == pc.Air(temperature=22.0, humidity=0.5)
    # Cramer, JASA 93 (1993), for the speed; CIPM-2007 for the density
    assert air.speed_of_sound == pytest.approx(345.2, abs=0.3)
    assert air.density == pytest.approx(1.1905, abs=1e-3)
    assert air.wavelength(40e3) == pytest.approx(air.speed_of_sound / 40e3)
    assert air.wavenumber(40e3) == pytest.approx(2 * math.pi * 40e3 / air.speed_of_sound)


def test_speed_and_density_are_of_one_and_the_same_air() -> None:
    """Sound is adiabatic: rho c^2 is gamma times the ambient pressure. gamma is 1.40 for dry air, less with vapour."""
    for air in (pc.Air(), pc.Air(temperature=5.0), pc.Air(temperature=35.0, ambient_pressure=8e4)):
        assert 1.39 < air.density * air.speed_of_sound**2 / air.ambient_pressure < 1.401


def test_where_only_a_speed_is_given_the_temperature_is_not_known() -> None:
    air = pc.Air(speed_of_sound=340.0)
    assert air.temperature is None
    assert air.density == pc.Air().density
    assert pc.Air(density=1.0).temperature == pc.Air().temperature


@pytest.mark.parametrize(
    ("temperature", "speed", "density"),
    [(0.0, 331.3, 1.2922), (15.0, 340.3, 1.2250), (20.0, 343.2, 1.2041)],
)
def test_dry_air_has_the_speed_and_density_of_the_textbooks(
    temperature: float, speed: float, density: float
) -> None:
    air = pc.Air(temperature=temperature, humidity=0.0)
    assert air.speed_of_sound == pytest.approx(speed, abs=0.06)
    assert air.density == pytest.approx(density, abs=2e-4)


def test_humid_air_is_slightly_faster_and_lighter() -> None:
    dry, humid = (pc.Air(temperature=20.0, humidity=h) for h in (0.0, 1.0))
    # Cramer, JASA 93 (1993): 343.99 at 50 %, 344.6 m/s at 100 %; CIPM-2007: 1.1936 kg/m^3 at 100 %.
    assert 1.0 < humid.speed_of_sound - dry.speed_of_sound < 1.6
    assert humid.density == pytest.approx(1.1936, rel=1e-3)


def test_what_is_given_overrides_the_ideal_gas() -> None:
    air = pc.Air(temperature=30.0, speed_of_sound=346.0, density=1.1)
    assert (air.speed_of_sound, air.density) == (346.0, 1.1)


def test_a_replaced_temperature_changes_what_was_not_given() -> None:
    room = pc.Air(temperature=20.0, humidity=0.3)
    copied = pickle.loads(pickle.dumps(room))
    read = pc.Air(**dataclasses.asdict(room, dict_factory=leave_out_exponent))  # as from a file
    for air in (room, copied, read):
        assert dataclasses.replace(air, temperature=30.0) == pc.Air(temperature=30.0, humidity=0.3)
        assert dataclasses.replace(air, humidity=0.9) == pc.Air(temperature=20.0, humidity=0.9)
        assert dataclasses.replace(air) == air
    given_both = pc.Air(temperature=20.0, speed_of_sound=344.0, density=1.1)
    warmer = dataclasses.replace(given_both, temperature=30.0)
    assert (warmer.speed_of_sound, warmer.density) == (344.0, 1.1)
    assert dataclasses.replace(room, speed_of_sound=340.0).speed_of_sound == 340.0
    assert "_computed" not in repr(room)


def leave_out_exponent(items: list[tuple[str, Any]]) -> dict[str, Any]:
    return {name: value for name, value in items if name != "exponent"}


@given(st.floats(-40.0, 50.0), st.floats(5e4, 1.5e5))
def test_the_speed_in_dry_air_does_not_depend_on_its_pressure(
    temperature: float, pressure: float
) -> None:
    air = pc.Air(temperature=temperature, humidity=0.0, ambient_pressure=pressure)
    assert air.speed_of_sound == pytest.approx(
        331.3 * math.sqrt(1 + temperature / 273.15), rel=2e-4
    )


@pytest.mark.parametrize(("temperature", "humidity"), list(TABLE))
def test_absorption_is_that_of_the_standard_s_table(temperature: int, humidity: float) -> None:
    for octave, printed in zip(range(-4, 4), TABLE[temperature, humidity], strict=True):
        frequency = 1000.0 * 10.0 ** (0.3 * octave)  # the exact midband frequency [Hz]
        half_a_digit = 0.51 if printed >= 100 else 0.052
        assert 1e3 * iso_9613_1(frequency, temperature, humidity) == pytest.approx(
            printed, abs=half_a_digit
        )


def test_absorption_is_1_32_decibels_a_metre_at_40_kilohertz() -> None:
    assert iso_9613_1(40e3, 20.0, 0.5) == pytest.approx(1.32, abs=5e-3)
    beta = pc.Air(attenuation="absorbing", temperature=20.0).beta(40e3)
    assert 20 * math.log10(math.exp(beta)) == pytest.approx(1.32, abs=5e-3)


@given(st.floats(-20.0, 40.0), st.floats(0.05, 0.4), st.floats(1e3, 1e5), st.floats(0.5, 2.0))
def test_absorption_grows_with_pressure_where_frequency_and_vapour_do_too(
    temperature: float, humidity: float, frequency: float, k: float
) -> None:
    """Absorption divided by pressure depends only on frequency and vapour, both divided by pressure."""
    here = iso_9613_1(frequency, temperature, humidity)
    there = iso_9613_1(k * frequency, temperature, k * humidity, k * 101325.0)
    assert there == pytest.approx(k * here, rel=1e-9)


def test_absorption_follows_the_temperature_humidity_and_pressure_of_the_air() -> None:
    air = pc.Air(attenuation="absorbing", temperature=10.0, humidity=0.7)
    assert air.beta(3981.07) * 20 / math.log(10) == pytest.approx(32.8e-3, abs=5e-5)
    high = pc.Air(attenuation="absorbing", temperature=5.0, humidity=0.3, ambient_pressure=7e4)
    expected = iso_9613_1(40e3, 5.0, 0.3, 7e4)
    assert high.beta(40e3) * 20 / math.log(10) == pytest.approx(expected)


def test_in_thin_air_without_vapour_only_classical_and_nitrogen_absorption_remain() -> None:
    # Far above relaxation it is alpha = 8.686 f^2 1.84e-11 (pr / p) + 8.686 (0.01275 e^-7.638 24 p).
    value = iso_9613_1(1e6, 20.0, 0.0)
    relaxation = (
        0.01275 * math.exp(-2239.1 / 293.15) * 24.0 + 0.1068 * math.exp(-3352 / 293.15) * 9.0
    )
    assert value == pytest.approx(8.6859 * (18.4 + relaxation), rel=1e-5)


@pytest.mark.parametrize(
    ("attenuation", "exponent", "singular"),
    [
        ("spherical", 1.0, True),
        ("none", 0.0, False),
        ("absorbing", 1.0, True),
        (0.5, 0.5, True),
        (0, 0.0, False),
    ],
)
def test_attenuation_gives_the_exponent_of_the_distance(
    attenuation: Any, exponent: float, singular: bool
) -> None:
    air = pc.Air(attenuation=attenuation)
    assert (air.exponent, air.singular) == (exponent, singular)


def test_only_absorbing_air_absorbs_unless_told() -> None:
    assert pc.Air().beta(40e3) == pc.Air(attenuation="none").beta(40e3) == 0.0
    assert pc.Air(attenuation="none", absorption=0.3).beta(40e3) == 0.3
    assert pc.Air(attenuation="absorbing", absorption=0.0).beta(40e3) == 0.0


@pytest.mark.parametrize(
    ("argument", "values"),
    {
        "temperature": (-80.1, 100.1, math.nan),
        "humidity": (-0.01, 1.01, None),
        "ambient_pressure": (1.0, 1e9),
        "speed_of_sound": (-1.0, math.inf),
        "density": (-1.0, "light"),
        "attenuation": ("spheric", -1.0, 9.0, math.nan, None),
        "absorption": (-0.1, 1e4),
    }.items(),
)
def test_a_bad_argument_is_refused_by_name(argument: str, values: Any) -> None:
    for value in values:
        with pytest.raises(pc.ArgumentError, match=f"^`{argument}`") as caught:
            pc.Air(**{argument: value})
        assert caught.value.argument == argument


def test_a_number_given_as_text_is_kept_as_a_number() -> None:
    given_as = {"temperature": "20", "humidity": "0.5", "speed_of_sound": "343", "absorption": "1"}
    made: Any = pc.Air(**given_as)  # type: ignore[arg-type]
    assert made == pc.Air(temperature=20.0, humidity=0.5, speed_of_sound=343.0, absorption=1.0)


def test_vapour_of_more_than_the_ambient_pressure_is_refused() -> None:
    with pytest.raises(pc.ArgumentError, match="boils"):
        pc.Air(temperature=100.0, humidity=1.0, ambient_pressure=1e4)


@pytest.mark.parametrize(
    "air",
    [pc.Air(), pc.Air(temperature=0.0, humidity=0.0), pc.Air(speed_of_sound=340.0, density=1.2)],
)
def test_the_impedance_is_density_times_speed(air: pc.Air) -> None:
    assert air.impedance == air.density * air.speed_of_sound
    assert 380.0 < air.impedance < 450.0
