"""The medium: speed of sound, density and attenuation in air."""

from __future__ import annotations

import functools
import math
from dataclasses import InitVar, dataclass, field

from pacinian.argument_checks import check_number
from pacinian.errors import ArgumentError

GAS_CONSTANT = 8.314462618  # [J/(mol K)]
MOLAR_MASS_DRY_AIR = 0.0289647  # [kg/mol]
MOLAR_MASS_WATER = 0.01801528  # [kg/mol]
ATMOSPHERE = 101_325.0  # [Pa]
# Default temperature, of a heated or cooled room (19 to 25) [degC]. These docs repeat it: concepts.md, scene-files.md,
# server.md, studies.md.
ROOM_TEMPERATURE = 22.0
HUMIDITY = 0.5  # default relative humidity, of such a room
EXPONENTS = {"spherical": 1.0, "none": 0.0, "absorbing": 1.0}


@dataclass(frozen=True, kw_only=True)
class Air:
    """Air at rest, with its attenuation a(r) = r^-n exp(-beta r).

    temperature: [degC], 22 by default. Measure it at the array: an error of 10 degrees costs 31 % of the pressure at a
        focus of nine units, and moves the focus by 6 mm (docs/concepts.md). None if only `speed_of_sound` is given.
    humidity: relative, 0..1. ambient_pressure: [Pa].
    speed_of_sound: [m/s]. density: [kg/m^3]. By default, computed from these three, as for an ideal gas.
    attenuation: "spherical" (n = 1), "none" (n = 0, the paper's experiment), an exponent n, or
        "absorbing" (n = 1 and beta from ISO 9613-1 at the transducers' frequency).
    absorption: beta [1/m], used instead of the computed value.
    exponent: n, from `attenuation`.
    `dataclasses.replace` computes speed and density anew, unless they were given.
    Raises ArgumentError.
    """

    temperature: float | None = None
    humidity: float = HUMIDITY
    ambient_pressure: float = ATMOSPHERE
    speed_of_sound: float = 0.0
    density: float = 0.0
    attenuation: str | float = "spherical"
    absorption: float | None = None
    exponent: float = field(init=False)
    # speed and density of an ideal gas, which `dataclasses.replace` passes on
    _computed: InitVar[tuple[float, float]] = (0.0, 0.0)

    def __post_init__(self, _computed: tuple[float, float]) -> None:
        set_ = functools.partial(object.__setattr__, self)
        for name, before in zip(("speed_of_sound", "density"), _computed, strict=True):
            if getattr(self, name) == before:
                set_(name, 0.0)
        set_("humidity", check_number("humidity", self.humidity, low=0.0, high=1.0))
        set_(
            "ambient_pressure",
            check_number("ambient_pressure", self.ambient_pressure, low=1e3, high=1e7),
        )
        if self.temperature is not None:
            set_(
                "temperature", check_number("temperature", self.temperature, low=-80.0, high=100.0)
            )
        elif not self.speed_of_sound:
            set_("temperature", ROOM_TEMPERATURE)
        c, rho = _ideal_gas(self._celsius, self.humidity, self.ambient_pressure)
        set_("_computed", (c, rho))
        if self.speed_of_sound:
            c = check_number("speed_of_sound", self.speed_of_sound, low=10.0, high=1e4)
        set_("speed_of_sound", c)
        set_("density", check_number("density", self.density, low=0.0) or rho)
        if self.absorption is not None:
            set_("absorption", check_number("absorption", self.absorption, low=0.0, high=1e3))
        if not isinstance(self.attenuation, str):
            exponent = check_number("attenuation", self.attenuation, low=0.0, high=2.0)
        elif self.attenuation in EXPONENTS:
            exponent = EXPONENTS[self.attenuation]
        else:
            known = ", ".join(map(repr, EXPONENTS))
            raise ArgumentError(
                "attenuation", f"must be {known} or an exponent, not {self.attenuation!r}"
            )
        set_("exponent", exponent)

    @property
    def impedance(self) -> float:
        """Characteristic acoustic impedance rho c [Pa s/m], some 410 in a room: p / v of a plane wave."""
        return self.density * self.speed_of_sound

    def wavenumber(self, frequency: float) -> float:
        """Return the wavenumber k = 2 pi f / c [rad/m] at `frequency` [Hz]."""
        return 2.0 * math.pi * frequency / self.speed_of_sound

    def wavelength(self, frequency: float) -> float:
        """Return the wavelength c / f [m] at `frequency` [Hz]."""
        return self.speed_of_sound / frequency

    def beta(self, frequency: float) -> float:
        """Return the absorption coefficient of the amplitude [1/m] at `frequency` [Hz]."""
        if self.absorption is not None:
            return self.absorption
        if self.attenuation != "absorbing":
            return 0.0
        decibels = iso_9613_1(frequency, self._celsius, self.humidity, self.ambient_pressure)
        return decibels * math.log(10.0) / 20.0

    @property
    def _celsius(self) -> float:
        return ROOM_TEMPERATURE if self.temperature is None else self.temperature

    @property
    def singular(self) -> bool:
        """Whether the attenuation is infinite at a transducer."""
        return self.exponent > 0.0


def iso_9613_1(
    frequency: float, temperature: float, humidity: float, ambient_pressure: float = ATMOSPHERE
) -> float:
    """Return the atmospheric attenuation of sound [dB/m], by ISO 9613-1:1993, equations (3) to (5), (B.1) to (B.3).

    frequency: [Hz]. temperature: [degC]. humidity: relative, 0..1. ambient_pressure: [Pa].
    The standard's table ends at 10 kHz; above, its formula is used (1.32 dB/m at 40 kHz, 20 degC, 50 %).
    """
    kelvin = temperature + 273.15
    T = kelvin / 293.15  # relative to 20 degC
    p = ambient_pressure / ATMOSPHERE
    h = 100.0 * humidity * _saturation(kelvin) / p  # molar concentration of water vapour [%]
    oxygen = p * (24.0 + 4.04e4 * h * (0.02 + h) / (0.391 + h))  # relaxation frequency [Hz]
    # relaxation frequency of nitrogen [Hz]
    nitrogen = p * T**-0.5 * (9.0 + 280.0 * h * math.exp(-4.170 * (T ** (-1.0 / 3.0) - 1.0)))
    f2 = frequency * frequency
    classical = 1.84e-11 / p * T**0.5
    relaxation = 0.01275 * math.exp(-2239.1 / kelvin) / (oxygen + f2 / oxygen)
    relaxation += 0.1068 * math.exp(-3352.0 / kelvin) / (nitrogen + f2 / nitrogen)
    return float(20.0 / math.log(10.0) * f2 * (classical + T**-2.5 * relaxation))


def _saturation(kelvin: float) -> float:
    """Return the saturation vapour pressure of water, relative to one atmosphere, by ISO 9613-1 (B.2), (B.3)."""
    return float(10.0 ** (-6.8346 * (273.16 / kelvin) ** 1.261 + 4.6151))


def _ideal_gas(temperature: float, humidity: float, ambient_pressure: float) -> tuple[float, float]:
    """Return speed of sound [m/s] and density [kg/m^3] of moist air, as a mixture of ideal gases.

    The molar heat capacities are 7/2 R (dry air) and 4 R (water vapour). Dry air at 20 degC has 343.2 m/s.
    """
    kelvin = temperature + 273.15
    x = humidity * _saturation(kelvin) * ATMOSPHERE / ambient_pressure  # mole fraction of water
    if x >= 1.0:
        raise ArgumentError(
            "humidity", f"of {humidity:g} at {temperature:g} degC boils at {ambient_pressure:g} Pa"
        )
    mass = (1.0 - x) * MOLAR_MASS_DRY_AIR + x * MOLAR_MASS_WATER  # [kg/mol]
    capacity = (1.0 - x) * 3.5 + x * 4.0  # Cp / R
    gamma = capacity / (capacity - 1.0)
    density = ambient_pressure * mass / (GAS_CONSTANT * kelvin)
    return math.sqrt(gamma * GAS_CONSTANT * kelvin / mass), density
