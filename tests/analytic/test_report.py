"""The report and its figures, on made-up diagnoses."""

from __future__ import annotations

import dataclasses
import math
import re
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

from feeddrive.diagnosis.calibration.calibrated_result import CalibratedResult
from feeddrive.diagnosis.judging.effect_results import _why_not
from feeddrive.diagnosis.judging.result import (
    ChannelSeries,
    Diagnosis,
    EffectResult,
    ErrorFigures,
    FileStamp,
    JudgedRecording,
    ParameterResult,
    PossibleEffect,
    RefusedEffect,
    Trial,
    Unexplained,
    error_without,
)
from feeddrive.diagnosis.simulated.simulation_result import SimulationResult
from feeddrive.diagnosis.unexplained.unexplained_result import Above, Carried
from feeddrive.effects.base import Port
from feeddrive.effects.tabulated import TabulatedForce, TabulatedTorque
from feeddrive.errors import InputError
from feeddrive.report.figures.drawing import dress, new_figure
from feeddrive.report.figures.figures import curve_figures, render_figures, report_figures, save_figures
from feeddrive.report.pages.html import STYLE, report_page, write_report
from feeddrive.report.pages.section_certainty import simulation_lines
from feeddrive.report.pages.section_records import Occasion, used_sentence
from feeddrive.report.pages.sections import verdict_section
from feeddrive.report.words.number_text import share_text, times_text
from feeddrive.report.words.verdict import is_noise, verdict_sentences
from feeddrive.report.words.words import plain as words
from feeddrive.units.quantity import percent
from tests.analytic import report_examples as examples

NASTY = '<script>alert("1")</script> & $x_{ $'


@pytest.fixture(scope="module")
def found() -> Diagnosis:
    return examples.diagnosis()


@pytest.fixture(scope="module")
def page(found: Diagnosis) -> str:
    return report_page(found, render_figures(found))


class _Checker(HTMLParser):
    """Collects references and checks that every opened element is closed in order."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.tags: set[str] = set()
        self.references: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.add(tag)
        self.references += [value or "" for key, value in attrs if key in ("src", "href", "srcset", "data")]
        if tag not in ("meta", "img", "br"):
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


def checked(text: str) -> _Checker:
    checker = _Checker()
    checker.feed(text)
    checker.close()
    assert checker.open == []
    return checker


def plain(text: str) -> str:
    """Text with common spaces, so that a test reads like the page."""
    return text.replace("\N{NO-BREAK SPACE}", " ")


def test_page_is_self_contained_and_well_formed(page: str) -> None:
    checker = checked(page)
    assert checker.references
    assert all(reference.startswith("data:image/png;base64,") for reference in checker.references)
    assert not checker.tags & {"script", "link", "iframe", "object"}
    assert "http://" not in page and "https://" not in page and "@import" not in page and "url(" not in page


def test_page_names_every_effect_and_candidate(page: str, found: Diagnosis) -> None:
    for name in [effect.name for effect in found.effects] + [one.name for one in found.refused]:
        assert f"<code>{name}</code>" in page
    assert all(one.reason in page for one in found.refused)


def test_page_keeps_the_order_in_which_an_engineer_asks(page: str) -> None:
    heads = re.findall("<h2>(.*?)</h2>", page)
    assert heads == [
        "Error before and after",
        "Effects found",
        "What these data cannot tell apart",
        "Closed-loop simulation error",
        "Measured and predicted",
        "What is unexplained",
        "What was tried and not taken",
        "The recordings",
        "To reproduce this",
    ]
    assert page.index('class="verdict') < page.index("<h2>")
    assert "ab" * 32 in page and "cd" * 32 in page


def test_verdict_says_what_is_missing_and_how_well_it_is_mended(found: Diagnosis) -> None:
    sentences = [plain(sentence) for sentence in verdict_sentences(found)]
    assert sentences[0].startswith("The declared plant lacks: backlash 7.52 µm [7.40, 7.68]; torque ripple")
    assert "friction level other than declared (table): coulomb factor 1.21 [1.17, 1.25]" in sentences[0]
    assert sentences[1].startswith("Error on data not fitted up to 150 Hz: motor torque 0.1")
    assert "table position 3." in sentences[1] and "(sensor noise 0.0500 µm)" in sentences[1]
    assert "Not confirmed on data not fitted: friction level other than declared." in sentences
    assert any("cannot tell apart: moving mass other than declared and inertia" in one for one in sentences)


def test_the_curve_of_a_law_is_told_apart_from_what_has_no_name(found: Diagnosis) -> None:
    force = TabulatedForce.of(Port.TABLE, "velocity", velocity=(-0.1, 0.1), force=(1.0, -1.0))
    table = Carried("motor_torque", force, {}, {}, {}, True)
    own = dataclasses.replace(table, curve_of="stribeck")
    for carried, said, not_said in (
        (own, "what the catalogue's form misses of Stribeck friction", "no named effect explains"),
        (table, "no named effect explains", "catalogue's form"),
    ):
        left = {"motor_torque": Unexplained(0.1, carried=(carried,))}
        sentences = " ".join(verdict_sentences(dataclasses.replace(found, unexplained=left)))
        assert said in sentences and not_said not in sentences and "over velocity" in sentences
    assert own.record()["curve_of"] == "stribeck" and "curve_of" not in table.record()


def test_a_periodic_table_is_told_over_one_period(found: Diagnosis) -> None:
    torque = TabulatedTorque.of(Port.MOTOR, "periodic_angle", angle=(0.0, 1.0), torque=(1.0, -1.0), period=2.0)
    left = {"motor_torque": Unexplained(0.1, carried=(Carried("motor_torque", torque, {}, {}, {}, True),))}
    said = " ".join(verdict_sentences(dataclasses.replace(found, unexplained=left)))
    assert "a torque on a shaft over one period of the angle." in said


def test_nothing_missing_is_said_plainly() -> None:
    clean = examples.nothing_missing()
    assert verdict_sentences(clean)[0].startswith("Nothing is missing: the declared plant explains the recording")
    text = report_page(clean, render_figures(clean))
    checked(text)
    assert "None: no effect was added" in text and "Nothing above the sensor noise" in text
    assert "→" not in text  # before and after are the same plant, so no pair of figures is shown


@pytest.mark.parametrize(
    ("doubt", "left"),
    [
        (0.17, False),  # half of the error's square above the floor, three standard errors of it are 0.51
        (0.16, True),
    ],
)
def test_what_steps_of_the_sensors_may_hold_is_not_unexplained(doubt: float, left: bool) -> None:
    clean = examples.nothing_missing()
    position = next(one for one in clean.channels if one.name == "table_position")
    rms = 1.6 * position.noise_rms
    coarse = dataclasses.replace(position, after=dataclasses.replace(position.after, rms=rms))
    channels = tuple(coarse if one is position else one for one in clean.channels)
    above = Above(share=0.5, standard_error=doubt, rms=rms, floor=rms * math.sqrt(0.5))
    rest = Unexplained(1e-6, above=above)
    behind_steps = dataclasses.replace(clean, channels=channels, unexplained={"table_position": rest})
    said = verdict_sentences(behind_steps)
    assert said[0].endswith("explains the recording down to the noise and the steps of its sensors.") is not left
    assert any("Still unexplained" in one for one in said) is left
    assert ('class="verdict clean"' in verdict_section(behind_steps)) is not left


@pytest.mark.parametrize(("ci95", "beyond"), [((1.8, 2.6), True), ((1.1, 2.6), False), ((0.5, 0.8), True)])
def test_a_value_beyond_its_tolerance_is_told_where_no_name_says_so(ci95: tuple[float, float], beyond: bool) -> None:
    value = CalibratedResult("axial_stiffness", "axial stiffness", "N/m", 1.0, 0.5 * sum(ci95), ci95, 0.2)
    said = " ".join(verdict_sentences(dataclasses.replace(examples.nothing_missing(), calibrated=(value,))))
    assert ("within their tolerances" in said) is not beyond
    assert ("Calibrated beyond tolerance" in said) is beyond
    assert not beyond or f"axial stiffness {percent(value.value)} of the declared" in said


def test_calm_box_is_for_machines_without_a_fault(found: Diagnosis) -> None:
    """Two faults that are explained down to noise are two faults."""
    clean = examples.nothing_missing()
    quiet = dataclasses.replace(clean, effects=found.effects)
    assert all(is_noise(quiet, channel) for channel in quiet.channels)
    assert 'class="verdict clean"' in verdict_section(clean)
    assert 'class="verdict clean"' not in verdict_section(quiet)


def test_worth_of_an_effect_is_a_factor_of_the_error() -> None:
    # rms 1 with it and 10 without: 1 - 0.01 is explained; the factor is their quotient by definition
    assert error_without(1 - 1 / 10**2) == pytest.approx(10.0, rel=1e-12)
    assert error_without(0.0) == 1.0 and math.isinf(error_without(1.0)) and math.isnan(error_without(math.nan))
    assert plain(times_text(error_without(0.9996))) == "50.0 ×"  # told apart from 0.996, 15.8 ×: both were "100 %"
    assert plain(times_text(error_without(0.996))) == "15.8 ×"
    assert plain(times_text(math.inf)) == "> 1000 ×"
    assert error_without(-3.0) == 0.5  # an effect that makes the judged error larger


def test_page_says_what_was_not_used_and_how_to_make_it_again(found: Diagnosis) -> None:
    series = found.recordings[0].channels[0]
    share = 1 - np.isfinite(series.measured - series.before).mean()
    assert f"{share_text(float(share))} of {words(series.name)}" in used_sentence(found)
    page = report_page(found, (), Occasion('feeddrive diagnose a.toml "b <1>.csv"', "2024-05-06"))
    checked(page)
    assert "feeddrive diagnose a.toml &quot;b &lt;1&gt;.csv&quot;" in page
    assert "2024-05-06" in page and "Serial number" in page and "<dd>axis_x</dd>" in page
    assert page.index("Not used of the judged recordings") < page.index("<h2>")


def test_no_word_is_broken_in_a_narrow_window() -> None:
    """`anywhere` lets a column shrink to one letter; only checksums and command lines may break inside a word."""
    rules = re.findall(r"([^{}]+)\{([^{}]*)\}", STYLE)
    broken = [selector.strip() for selector, body in rules if "overflow-wrap: anywhere" in body]
    assert set(broken) == {"code.hash", "pre"}


def test_numbers_of_a_scale_stand_as_they_are() -> None:
    """Micrometres about 250 mm used to be written as 0.004 under "+2.4999e2"."""
    figure = new_figure(2.0)
    axes = figure.subplots()
    axes.plot([0.0, 1.0], [249.994, 250.0003])
    dress(axes, "time [s]", "position [mm]")
    figure.canvas.draw()
    labels = [one.get_text() for one in axes.get_yticklabels()]
    assert axes.yaxis.get_offset_text().get_text() == "" and any(label.startswith("249.99") for label in labels)


def test_band_is_named_where_it_is_drawn(found: Diagnosis) -> None:
    effect = EffectResult("friction_vs_position", {
        "position": ParameterResult([0.0, 0.1, 0.2], "m"),
        "delta_force": ParameterResult([0.0, 5.0, 0.0], "N"),
    }, {}, True, "")  # fmt: skip
    curve = curve_figures(dataclasses.replace(found, effects=(effect,)))[0]
    assert "band" not in curve.caption and not curve.figure.axes[0].collections
    wide = dataclasses.replace(effect.parameters["delta_force"], ci95=[(-1.0, 1.0), (4.0, 6.0), (-1.0, 1.0)])
    effect = dataclasses.replace(effect, parameters={**effect.parameters, "delta_force": wide})
    curve = curve_figures(dataclasses.replace(found, effects=(effect,)))[0]
    assert "the band is the 95 % interval" in curve.caption and curve.figure.axes[0].collections


@pytest.mark.parametrize(
    ("trial", "others", "words"),
    [
        (Trial(2, "payload", 0.0979, 0.0095, False), [Trial(2, "backlash", 0.55, 0.01, True)], "backlash by 55.00 %"),
        (Trial(2, "payload", 0.01, 0.0095, False), [], "within the scatter of the blocks (1.5 times 0.95 %)"),
        (Trial(2, "payload", 0.0979, 0.0095, False), [], "too small to matter"),
        (Trial(1, "payload", 0.2, 0.01, True), [], "taken in round 1 and no longer paid"),
        (Trial(1, "payload", 0.004, 0.01, False), [], "less than the 0.5 % asked for"),
        (Trial(1, "payload", -0.01, 0.01, False), [], "does not lower"),
    ],
)
def test_reason_of_a_refusal_is_one_reason(trial: Trial, others: list[Trial], words: str) -> None:
    assert words in _why_not(trial, [trial, *others])


def test_no_effect_but_error_above_noise_is_not_called_complete() -> None:
    clean = examples.nothing_missing()
    worse = dataclasses.replace(clean.channels[0], after=ErrorFigures(0.05, 0.2, 0.04))
    sentences = verdict_sentences(dataclasses.replace(clean, channels=(worse,)))
    assert sentences[0].startswith("No known effect was found") and "Nothing is missing" not in " ".join(sentences)
    assert "4.2 times the sensor noise" in " ".join(sentences)  # 0.05 / 0.012


@pytest.mark.parametrize(
    ("times", "said"), [(1.2, "down to sensor noise."), (1.42, "down to 1.4 times the sensor noise.")]
)
def test_an_error_beyond_what_a_noise_is_known_to_is_told_over_it(times: float, said: str) -> None:
    """A noise that is read from a recording is known to a fifth; an error of 1.4 times it is not just that."""
    clean = examples.nothing_missing()
    noise = clean.channels[0].noise_rms
    more = dataclasses.replace(clean.channels[0], after=ErrorFigures(times * noise, 0.2, 0.04))
    told = verdict_sentences(dataclasses.replace(clean, channels=(more, *clean.channels[1:])))[0]
    assert told.startswith("Nothing is missing") and told.endswith(said)


@pytest.mark.parametrize(("kept", "said"), [("motor_torque", "table position"), ("table_position", "motor torque")])
def test_what_a_channel_that_was_not_recorded_would_show_is_told(kept: str, said: str) -> None:
    """A recording without one of the two channels of a motion does not test what that channel alone shows."""
    clean = examples.nothing_missing()
    both = verdict_sentences(clean)
    alone = [channel for channel in clean.channels if channel.name == kept]
    told = verdict_sentences(dataclasses.replace(clean, channels=tuple(alone)))
    assert any(one.startswith(f"No {said} was compared") for one in told)
    assert not any("was compared" in one for one in both)


def test_a_channel_that_became_worse_is_named(found: Diagnosis) -> None:
    channel = found.channels[0]
    worse = dataclasses.replace(channel, after=ErrorFigures(2.0 * channel.before.rms, 1.0, 0.1))
    sentences = verdict_sentences(dataclasses.replace(found, channels=(worse,)))
    assert "Motor torque is predicted worse with the effects than without." in sentences


def test_text_from_files_never_becomes_markup(found: Diagnosis) -> None:
    effect = EffectResult(
        NASTY, {NASTY: ParameterResult(1.0, NASTY, (0.9, 1.1)), "where": ParameterResult(NASTY, "1")},
        {"motor_torque": 0.5, NASTY: 0.1}, True, NASTY, NASTY,
    )  # fmt: skip
    nasty = dataclasses.replace(
        found, plant=NASTY, fit=(FileStamp(NASTY, NASTY),), effects=(effect,), ambiguous=((NASTY, NASTY),),
        refused=(RefusedEffect(NASTY, NASTY),), rehomed=(NASTY,), notes=(NASTY, "\x00\ud800"),
        unexplained={NASTY: Unexplained(0.1)}, trials=(Trial(1, NASTY, 0.1, 0.01, True),),
        channels=(dataclasses.replace(found.channels[0], name=NASTY, unit=NASTY), *found.channels[1:]),
        recordings=tuple(
            dataclasses.replace(one, name=NASTY, channels=(_renamed(one.channels[0]), *one.channels[1:]))
            for one in found.recordings
        ),
    )  # fmt: skip
    text = report_page(nasty, render_figures(nasty))
    assert "script" not in checked(text).tags
    assert "<script" not in text and "&lt;script&gt;alert(&quot;1&quot;)" in text
    text.encode("utf-8")


def _renamed(series: ChannelSeries) -> ChannelSeries:
    return dataclasses.replace(series, name=NASTY, unit=NASTY)


@pytest.mark.parametrize("keep", [0, 1])
def test_one_channel_only(found: Diagnosis, keep: int) -> None:
    alone = _one_channel(found, keep)
    figures = render_figures(alone)
    assert sum(figure.stem.startswith("series") for figure in figures) == 1
    checked(report_page(alone, figures))


def _one_channel(found: Diagnosis, keep: int) -> Diagnosis:
    recordings = tuple(dataclasses.replace(one, channels=(one.channels[keep],)) for one in found.recordings)
    return dataclasses.replace(found, channels=(found.channels[keep],), recordings=recordings, trials=())


def test_series_that_cannot_be_drawn_are_left_away(found: Diagnosis) -> None:
    first = found.recordings[0]
    empty = dataclasses.replace(
        first, channels=tuple(dataclasses.replace(one, measured=one.measured * np.nan) for one in first.channels)
    )
    for recordings in ((), (empty,), (JudgedRecording("none.csv", np.array([]), ()),)):
        figures = render_figures(dataclasses.replace(found, recordings=recordings))
        assert {figure.stem for figure in figures} == {"explains", "curve_friction_vs_position", "tried"}
        checked(report_page(found, figures))


def test_recordings_without_variables_or_of_few_samples(found: Diagnosis) -> None:
    found = _one_channel(found, 0)
    first = found.recordings[0]
    bare = dataclasses.replace(first, variables={})
    stems = {figure.stem for figure in render_figures(dataclasses.replace(found, recordings=(bare,)))}
    assert "spectrum_motor_torque" in stems and "dependence_motor_torque" not in stems
    short = _cut(first, slice(0, 40))
    checked(report_page(found, render_figures(dataclasses.replace(found, recordings=(short,)))))
    still = dataclasses.replace(first, variables={name: 0.0 * one for name, one in first.variables.items()})
    checked(report_page(found, render_figures(dataclasses.replace(found, recordings=(still,)))))


def _cut(recording: JudgedRecording, part: slice) -> JudgedRecording:
    channels = tuple(
        ChannelSeries(one.name, one.unit, one.measured[part], one.before[part], one.after[part])
        for one in recording.channels
    )
    variables = {name: one[part] for name, one in recording.variables.items()}
    return JudgedRecording(recording.name, recording.time[part], channels, variables)


def test_figures_that_are_no_numbers_are_shown_as_dashes(found: Diagnosis) -> None:
    nothing = ErrorFigures(math.nan, math.nan, math.nan)
    unknown = dataclasses.replace(found.channels[0], noise_rms=math.nan, before=nothing, after=nothing)
    effect = EffectResult("payload", {"mass": ParameterResult(math.nan, "kg", (math.nan, 1.0))},
                          {"motor_torque": math.nan}, True, "")  # fmt: skip
    odd = dataclasses.replace(
        found, channels=(unknown, found.channels[1]), effects=(effect,), trials=(Trial(1, "x", math.nan, -1.0, False),)
    )
    text = report_page(odd, render_figures(odd))
    checked(text)
    assert not re.search(r"\bnan\b", re.sub('base64,[^"]*', "", text).lower())


def test_largest_report_stays_small(tmp_path: Path) -> None:
    """Four recordings of 60 000 samples."""
    large = examples.diagnosis(samples=60_000, recordings=4)
    figures = render_figures(large)
    write_report(large, tmp_path / "report.html", figures)
    assert (tmp_path / "report.html").stat().st_size < 3_000_000
    assert max(len(figure.png) for figure in figures) < 150_000
    assert all(f"stroke_{number}.csv" in report_page(large, ()) for number in (1, 2, 3, 4))


def test_figures_are_saved_and_the_report_is_replaced_as_a_whole(found: Diagnosis, tmp_path: Path) -> None:
    figures = render_figures(found)
    paths = save_figures(found, tmp_path / "new" / "figures", figures)
    assert [path.stem for path in paths] == [figure.stem for figure in figures]
    assert all(path.read_bytes().startswith(b"\x89PNG") for path in paths)
    report = tmp_path / "report.html"
    report.write_text("old")
    write_report(found, report, figures)
    assert report.read_text(encoding="utf-8").startswith("<!DOCTYPE html>")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["new", "report.html"]


def test_the_same_diagnosis_gives_the_same_bytes(found: Diagnosis, tmp_path: Path) -> None:
    alone = _one_channel(found, 0)
    for name in ("first.html", "second.html"):
        write_report(alone, tmp_path / name)
    assert (tmp_path / "first.html").read_bytes() == (tmp_path / "second.html").read_bytes()


def test_unwritable_place_is_told_in_one_line(found: Diagnosis, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot be written"):
        write_report(found, tmp_path / "file" / "report.html", ())
    (tmp_path / "folder.html").mkdir()
    with pytest.raises(InputError, match=r"folder\.html: cannot be written"):
        write_report(found, tmp_path / "folder.html", ())
    assert sorted(path.name for path in tmp_path.iterdir()) == ["file", "folder.html"]


@pytest.mark.parametrize("make", [examples.diagnosis, examples.nothing_missing])
def test_every_axis_has_a_label_with_its_unit(make: type[Diagnosis]) -> None:
    for entry in report_figures(make()):
        assert isinstance(entry.figure, Figure) and entry.caption and entry.title
        for axes in entry.figure.axes:
            for axis in (axes.xaxis, axes.yaxis):
                named = all(label.get_text()[:1].isalpha() for label in axis.get_ticklabels())
                # An axis of names (effects, candidates) has no unit; every other one does.
                assert named or re.search(r"\w \[[^\]]+\]$", axis.get_label_text()), (entry.stem, axis)


def test_no_figure_reaches_a_window(found: Diagnosis) -> None:
    import matplotlib.pyplot

    before = matplotlib.pyplot.get_fignums()  # those that other tests have left
    list(report_figures(found))
    assert matplotlib.pyplot.get_fignums() == before


def test_possible_names_are_told_with_their_odds_and_what_settles_them_and_no_headline_holds_them() -> None:
    near = PossibleEffect("payload", 0.25, "", "a recording of the same motion 1.4 times as long")
    rival = PossibleEffect("backlash", 0.5, "stribeck", "an experiment")
    sentences = verdict_sentences(dataclasses.replace(examples.diagnosis(), possible=(near, rival)))
    (told,) = [one for one in sentences if one.startswith("Possible")]
    assert "(odds 1 to 4)" in told and told.endswith("1.4 times as long settles it.")
    assert words(near.name) not in sentences[0] and "payload" not in sentences[0]


def test_the_terminal_says_what_the_simulation_after_holds() -> None:
    """Three figures after are of effects alone or with tables: which is which is said where they differ."""
    (line, _) = simulation_lines(SimulationResult("motor_torque", 0.044, 0.0175, 0.0182, 0.0181, False, "kept"))
    assert "1.75" in line and "with the tables of what no name explains (effects alone: as attributed" in line
    (line, _) = simulation_lines(SimulationResult("motor_torque", 0.044, 0.0181, 0.0182, 0.0181, True, "kept"))
    assert "tables" not in line and "refined" in line
