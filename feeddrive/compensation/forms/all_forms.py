"""All forms of tables, by the names of `--form`."""

from __future__ import annotations

from dataclasses import replace

from feeddrive.compensation.forms import fanuc
from feeddrive.compensation.forms.control import Control
from feeddrive.compensation.forms.csv_table import CSV
from feeddrive.compensation.forms.heidenhain_table import HEIDENHAIN
from feeddrive.compensation.forms.isg import ISG
from feeddrive.compensation.forms.linuxcnc_table import LINUXCNC
from feeddrive.compensation.forms.sinumerik import SINUMERIK_CEC, SINUMERIK_ENC
from feeddrive.compensation.table import CompensationTable
from feeddrive.errors import InputError
from feeddrive.schema.toml_text import nearest
from feeddrive.units.quantity import format_quantity

HEAT = "sinumerik-temp"
"""The one form that is no table of positions, see `compensation.temperature`."""

_TABLES = {one.name: one for one in (LINUXCNC, SINUMERIK_ENC, SINUMERIK_CEC, ISG, HEIDENHAIN, CSV)}
FORMS = ("linuxcnc", "sinumerik-enc", "sinumerik-cec", HEAT, "isg", "heidenhain-csv", "fanuc-parameters", "csv")
"""Names, in the order in which help lists them."""


def control(form: str, resolution: float | None = None) -> Control:
    """The control of a form of table, one of `FORMS` but `HEAT`; its values at the usual resolution or a given one [m].

    Raises InputError: no such form, or a resolution that it cannot hold.
    """
    if form == "fanuc-parameters":
        return fanuc.writer(resolution or fanuc.UNIT)
    if form not in _TABLES:
        raise InputError(f'no form "{form}"', "form", nearest(form, FORMS))
    found = _TABLES[form]
    if resolution is None:
        return found
    if resolution < found.resolution * (1 - 1e-9):
        mend = f"write {format_quantity(found.resolution, 'm')} or more"
        raise InputError(f"the form holds no steps of {format_quantity(resolution, 'm')}", "resolution", mend)
    return replace(found, resolution=resolution)


def as_held(wanted: Control, table: CompensationTable) -> CompensationTable:
    """The table as a control holds it: rounded to its steps, within its limits, its play apart where it has to be.

    Raises:
        InputError: beyond the limits of the control.
    """
    if wanted.name == "fanuc-parameters":
        held = fanuc.as_applied(table, wanted.resolution)
    else:
        held = table.rounded(wanted.resolution)
    if not wanted.directions and wanted.name != "fanuc-parameters":
        half = 0.5 * wanted.resolution * round(table.play / wanted.resolution)
        mean = wanted.resolution * (table.mean / wanted.resolution).round()
        held = CompensationTable(table.positions, mean - half, mean + half, table.reference, table.step)
    wanted.refuse_beyond_limits(held)
    return held
