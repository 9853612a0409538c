"""The units that feeddrive understands, in pint's definition language.

A registry of its own, for two reasons. The angle is a base dimension here, so that rev/min, Hz and rad/s can never be
mixed (in pint's own registry the radian is 1, and rpm -> Hz silently carries 2 pi). And it loads in milliseconds.
"""

from __future__ import annotations

DEFINITIONS: tuple[str, ...] = (
    "pico- = 1e-12 = p-",
    "nano- = 1e-9 = n-",
    "micro- = 1e-6 = µ- = μ- = u-",
    "milli- = 1e-3 = m-",
    "centi- = 1e-2 = c-",
    "deci- = 1e-1 = d-",
    "kilo- = 1e3 = k-",
    "mega- = 1e6 = M-",
    "giga- = 1e9 = G-",
    "meter = [length] = m = metre",
    "second = [time] = s = sec",
    "gram = [mass] = g",
    "ampere = [current] = A",
    "kelvin = [temperature]; offset: 0 = K = delta_degC",
    "radian = [angle] = rad",
    "minute = 60 * second = min",
    "hour = 3600 * second = h",
    "day = 86400 * second",
    "inch = 0.0254 * meter = in",
    "foot = 0.3048 * meter = ft",
    "thou = 2.54e-5 * meter",
    "pound = 0.45359237 * kilogram = lb",
    "degree = 0.017453292519943295 * radian = deg = °",
    "arcminute = degree / 60 = arcmin",
    "arcsecond = degree / 3600 = arcsec",
    "revolution = 6.283185307179586 * radian = rev = turn",
    "revolutions_per_minute = revolution / minute = rpm",
    "hertz = 1 / second = Hz",
    "newton = kilogram * meter / second ** 2 = N",
    "pound_force = 4.4482216152605 * newton = lbf",
    "joule = newton * meter = J",
    "watt = joule / second = W",
    "pascal = newton / meter ** 2 = Pa",
    "bar = 1e5 * pascal",
    "volt = watt / ampere = V",
    "ohm = volt / ampere = Ω = Ohm",
    "henry = volt * second / ampere = H",
    "weber = volt * second = Wb",
    "coulomb = ampere * second = C",
    "farad = coulomb / volt = F",
    "stokes = 1e-4 * meter ** 2 / second = St",
    "poise = 0.1 * pascal * second = P",
    "liter = 1e-3 * meter ** 3 = L = l",
    "degree_Celsius = kelvin; offset: 273.15 = degC = °C = celsius",
    "degree_Fahrenheit = 5 / 9 * kelvin; offset: 255.3722222222222 = degF = °F",
    "percent = 0.01 = %",
    "ppm = 1e-6",
    "decibel = [level] = dB",
)
"""Prefixes, base units and derived units; a line is `name = definition = symbol = aliases`."""

EXAMPLE_UNITS: dict[str, str] = {
    "m": "mm",
    "rad": "deg",
    "rad/s": "rev/min",
    "m/s": "m/min",
    "N/m": "N/µm",
}
"""SI unit -> the unit that a person would write for it."""
