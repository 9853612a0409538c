"""Frequency response that SINUMERIK measured (Optimise axis, measuring functions), XML with numbers in base 85.

The file is a dump of objects: signal nodes with their raw series, their spectra, and the cross spectra between them.
Measured on a file with its raw series beside the spectra (they agree to 1e-13): the cross spectrum that stands in node
A with the id of node B is conj(A)·B. So

    H = conj(S) / S_uu   where S stands in the output's node,    H = S / S_uu   where it stands in the input's

Numbers: big-endian doubles, four bytes as five letters to base 85, `.` for four zero bytes; complex as (re, im).
"""

from __future__ import annotations

from dataclasses import dataclass
from xml.etree.ElementTree import Element

import numpy as np

from feeddrive.errors import InputError
from feeddrive.recording.files.opening import FileContent
from feeddrive.recording.frequency_response import FrequencyResponse
from feeddrive.recording.traces.xml_tree import parse_xml
from feeddrive.typing import ComplexArray, FloatArray

NAME = "SINUMERIK frequency response"
_LETTERS = "0123456789abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ!#$`()*+-/:;=?@[]^_{|}~"
_DIGITS = {letter: digit for digit, letter in enumerate(_LETTERS)}
_SPEED_LOOP = "2"  # m_eControlLoopType of a file that is known to be of a speed loop
_ONE_QUANTITY = 0.1  # |H| at the lowest line nearer to 1 than this: input and output are the same quantity


def recognises(head: str) -> bool:
    """Tell by its first letters whether a text is such a file."""
    return head.lstrip("\ufeff \n\t").startswith("<") and ("satclassid" in head or "<ResponseTest" in head)


def read(content: FileContent, text: str) -> FrequencyResponse:
    """Read the response between the two signals that the file calls its input and its output.

    Raises:
        InputError: not whole, or without spectra.
    """
    where = str(content.path)
    root = parse_xml(text, where)
    nodes = [_node(element, where) for element in root.iter("PlatformSignalNode")]
    nodes = [node for node in nodes if node.spectrum is not None]
    if not nodes and any(True for _ in root.iter("FrequencyResponseFunction")):
        return _tuned(root, content, where)
    given, output = _sides(root, nodes, where)
    cross = next(((once.conj(), f) for id_, once, f in output.crosses if id_ == given.id), None)
    if cross is None:
        cross = next(((once, f) for id_, once, f in given.crosses if id_ == output.id), None)
    if cross is None or given.spectrum is None or output.spectrum is None:
        raise InputError(
            "the spectra of the measurement are not in the file",
            where,
            "save them with it (option frequency spectra) at the control",
        )
    values, frequency = cross
    if not values.size == frequency.size == given.spectrum.size == output.spectrum.size or not values.size:
        raise InputError("the spectra differ in length", where, "export it again")
    if not np.all(given.spectrum.real > 0.0):
        raise InputError("the input was not excited at every frequency", where, "measure again")
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        coherence = np.abs(values) ** 2 / (given.spectrum.real * output.spectrum.real)
    names, unit, remarks = _names(root, given, output, (values / given.spectrum.real)[frequency > 0.0])
    notes = (f"{NAME}: from {names[0]} to {names[1]}", *remarks, *_clock(root, frequency, given))
    return FrequencyResponse(content.path.name, *names, unit, frequency, values / given.spectrum.real, coherence,
                             notes, where, content.sha256)  # fmt: skip


def _tuned(root: Element, content: FileContent, where: str) -> FrequencyResponse:
    """Read the plant of the speed loop that automatic servo tuning (AST) keeps, with the coherence beside it.

    The file names neither signals nor units. The speed controller turns speed into torque, so its plant is taken as
    the way from torque to speed, and that is stated.
    """
    found: list[tuple[ComplexArray, FloatArray, FloatArray]] = []
    for parent in root.iter():
        functions = {one.get("name", ""): one for one in parent if one.tag == "FrequencyResponseFunction"}
        plant = _vectors(functions["m_pPlant"], where) if "m_pPlant" in functions else None
        if plant is None or not plant[0].size:
            continue
        beside = _vectors(functions["m_pMeasCoherence"], where) if "m_pMeasCoherence" in functions else None
        fits = beside is not None and beside[0].size == plant[0].size
        coherence = np.abs(beside[0]) if beside is not None and fits else np.full(plant[0].size, np.nan)
        found.append((*plant, coherence))
    if not found:
        raise InputError("the file holds no measured response", where, "save the measurement with it at the control")
    values, frequency, coherence = found[0]
    if values.size != frequency.size:
        raise InputError("the spectra differ in length", where, "export it again")
    notes = [
        f"{NAME}, of automatic servo tuning: the plant of a speed loop, taken as motor_torque to motor_speed",
        "the file does not say the unit of the magnitude: write it in the header of the CSV",
    ]
    if len(found) > 1:
        notes.append(f"{len(found)} responses are in the file; the first is read")
    notes += [
        f"a speed controller of the file has K_p {gain} and T_n {time}, in its own units"
        for gain, time in _controllers(root)
    ]
    return FrequencyResponse(content.path.name, "motor_torque", "motor_speed", "", frequency, values, coherence,
                             tuple(notes), where, content.sha256)  # fmt: skip


def _controllers(root: Element) -> list[tuple[str, str]]:
    """Return gain and integral time of each speed controller, as written, each pair once."""
    pairs = ((_text(one, "m_dKpGain"), _text(one, "m_dIntegralTime")) for one in root.iter())
    return list(dict.fromkeys(pair for pair in pairs if all(pair)))


@dataclass(frozen=True, eq=False)
class _Node:
    """A signal: id, number among its kind, auto spectrum, cross spectra (id, values, frequencies), samples."""

    id: str
    instance: str
    spectrum: ComplexArray | None
    crosses: tuple[tuple[str, ComplexArray, FloatArray], ...]
    samples: int


def _node(element: Element, where: str) -> _Node:
    auto = _named(element, "m_autospectrumInfo")
    crosses = []
    listed = _named(element, "m_crossSpecInfoList")
    for info in listed if listed is not None else ():
        spectrum = _spectrum(info, where)
        if spectrum is not None:
            crosses.append((_text(info, "m_uSignodeId"), *spectrum))
    own = _spectrum(auto, where) if auto is not None else None
    length = _text(element, "m_TimeVector.length", deep=True)
    return _Node(
        _text(element, "m_uNodeId"),
        _text(element, "m_iUniqueInstanceId"),
        own[0] if own else None,
        tuple(crosses),
        int(length) if length.isdigit() else 0,
    )


def _spectrum(info: Element, where: str) -> tuple[ComplexArray, FloatArray] | None:
    for spectrum in info.iter("CrossSpectrum"):
        found = _vectors(spectrum, where)
        if found is not None:
            return found
    return None


def _vectors(element: Element, where: str) -> tuple[ComplexArray, FloatArray] | None:
    """Return complex values and frequencies [Hz] of an object, (n,) each; None where it has none."""
    arrays = {one.get("name"): one for one in element.iter("NumericArray")}
    if "m_ValueVector" not in arrays or "m_FrequencyVector" not in arrays:
        return None
    pairs = _numbers(arrays["m_ValueVector"], where)
    if pairs.size % 2:
        raise InputError("a complex spectrum has half a number", where, "export it again")
    return pairs[0::2] + 1j * pairs[1::2], _numbers(arrays["m_FrequencyVector"], where)


def _numbers(array: Element, where: str) -> FloatArray:
    """Return the doubles of a NumericArray, (n,)."""
    raw = array.find("raw")
    letters = "".join((raw.text or "").split()) if raw is not None else ""
    words = []
    at = 0
    while at < len(letters):
        if letters[at] == ".":
            words.append(0)
            at += 1
            continue
        word = 0
        five = letters[at : at + 5]
        for letter in five:
            word = word * 85 + _DIGITS.get(letter, 1 << 40)
        if len(five) < 5 or word >= 1 << 32:
            raise InputError("numbers of the file are damaged", f"{where}, {array.get('name', '')}", "export it again")
        words.append(word)
        at += 5
    declared = _text(array, "m_length")
    each = 2 if array.get("elementtype") == "ComplexNumber" else 1
    if len(words) % 2 or (declared.isdigit() and len(words) != 2 * each * int(declared)):
        what = f"{len(words) // 2} numbers where {declared} are declared"
        raise InputError(what, f"{where}, {array.get('name', '')}", "export it again")
    return np.array(words, dtype=">u4").view(">f8").astype(np.float64)


def _sides(root: Element, nodes: list[_Node], where: str) -> tuple[_Node, _Node]:
    """Return input and output."""
    by_instance = {node.instance: node for node in nodes}
    for pair in root.iter("PrimaryFreqRespSigNodeData"):
        given = by_instance.get(_text(pair, "m_iInputSigNodeUniqueInstanceID"))
        output = by_instance.get(_text(pair, "m_iOutputSigNodeUniqueInstanceID"))
        if given is not None and output is not None and given is not output:
            return given, output
    raise InputError(
        "the file does not say which signal answers which, or holds no spectra",
        where,
        "save the spectra with the measurement at the control",
    )


def _names(
    root: Element, given: _Node, output: _Node, values: ComplexArray
) -> tuple[tuple[str, str], str, tuple[str, ...]]:
    """Return the two channels, the unit of the magnitude, and what was inferred."""
    loop = _text(root, "m_eControlLoopType")
    if loop == _SPEED_LOOP and values.size and abs(abs(values[0]) - 1.0) < _ONE_QUANTITY:
        note = (
            f"the magnitude at the lowest frequency is {abs(values[0]):.4f}: the closed speed loop, set-point to actual"
        )
        return ("motor_speed_setpoint", "motor_speed"), "1", (note,)
    note = "the file names no signals; write them in the first line of the CSV: # from = motor_torque, to = motor_speed"
    return (f"signal {given.id}", f"signal {output.id}"), "", (note,)


def _clock(root: Element, frequency: FloatArray, given: _Node) -> tuple[str, ...]:
    """Say frequencies that are not the lines of the raw series which stand in the same file."""
    tick = _text(root, "m_dProcessUpdateTime")
    try:
        step = float(tick)
    except ValueError:
        return ()
    remarks = [f"sampled every {step * 1e6:g} µs"] if step > 0.0 else []
    if step > 0.0 and given.samples and frequency.size > 2 and frequency[1] > 0.0:
        off = frequency[1] * given.samples * step - 1.0
        if 1e-6 < abs(off) < 0.1:
            remarks.append(
                f"the frequencies of the file lie {100 * off:+.3f} % off the lines of its own {given.samples} "
                "samples; kept as written"
            )
    return tuple(remarks)


def _named(element: Element, name: str) -> Element | None:
    return next((one for one in element if one.get("name") == name), None)


def _text(element: Element, name: str, deep: bool = False) -> str:
    among = element.iter() if deep else iter(element)
    return next(((one.text or "").strip() for one in among if one.get("name") == name), "")
