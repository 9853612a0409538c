"""The documentation site: its blocks run, and the pages that are written from the package say what the package has."""

from __future__ import annotations

import importlib.util
import re
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from xml.etree import ElementTree

import pytest

import feeddrive as fd
from feeddrive.cli.main import COMMANDS, load
from feeddrive.effects.catalogue import EFFECTS, THERMAL_EFFECTS
from feeddrive.interface.shown import Listing

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
WRITTEN = [
    path for path in sorted(DOCS.rglob("*.md")) if not {"_build", "generated"} & set(path.relative_to(DOCS).parts)
]
QUICK = ("start.md", "tutorials/axis_from_parts.md")
"""Pages whose blocks take a few seconds together; the others are slow tests."""
EVERY_EFFECT = {**EFFECTS, **THERMAL_EFFECTS}


@pytest.fixture(scope="module")
def extensions() -> Iterator[None]:
    """The modules of docs/_ext, as the site imports them."""
    sys.path.insert(0, str(DOCS / "_ext"))
    yield
    sys.path.remove(str(DOCS / "_ext"))


def module(name: str) -> ModuleType:
    """A module of docs/_ext."""
    return importlib.import_module(name)


def pages_that_run() -> list[object]:
    """Pages with blocks that run, the slow ones marked."""
    found = []
    for path in WRITTEN:
        name = path.relative_to(DOCS).as_posix()
        if re.search(r"^```\{(run|terminal)\}", path.read_text(encoding="utf-8"), re.MULTILINE):
            found.append(pytest.param(name, marks=() if name in QUICK else pytest.mark.slow))
    return found


@pytest.mark.usefixtures("extensions")
@pytest.mark.parametrize("name", pages_that_run())
def test_blocks_run(name: str) -> None:
    """In order, in one folder; a block that fails ends the test with its own error."""
    text = (DOCS / name).read_text(encoding="utf-8")
    shown = module("page_runner").run_page(text, name)
    captions = len(re.findall(r"^:caption:", text, re.MULTILINE))
    assert sum(len(one.figures) for one in shown) == captions, "each figure has a caption, and each caption a figure"
    assert all(png.startswith(b"\x89PNG") for one in shown for png in one.figures)


@pytest.mark.usefixtures("extensions")
def test_a_block_that_fails_is_no_page(tmp_path: Path) -> None:
    runner = module("page_runner")
    with pytest.raises(fd.InputError, match="bench_axis"):
        runner.run_page('```{run}\nimport feeddrive as fd\nfd.load("bensh_axis")\n```\n', "page")
    with pytest.raises(RuntimeError, match="ends with 2"):
        runner.run_page("```{terminal}\nfeeddrive show bensh_axis\n```\n", "page")


@pytest.mark.usefixtures("extensions")
@pytest.mark.parametrize("name", EVERY_EFFECT)
def test_page_of_an_effect_says_what_its_file_says(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pages, effect = module("effect_pages"), EVERY_EFFECT[name]
    # pictures and tables of scenarios take seconds an effect; the site makes them
    monkeypatch.setattr(pages.planted, "drawn", lambda folder, one: {"rows": SCENARIOS})
    text = pages.page(effect, tmp_path, pages.recovery_rates(DOCS / "recovery.md"))
    document = sys.modules[effect.__module__].__doc__ or ""
    equation = next(line for line in document.splitlines() if line.startswith("    "))
    assert equation in text
    for parameter in effect.parameters:
        assert f"| `{parameter.key}` | {parameter.unit} |" in text
    assert all(other in EVERY_EFFECT for other in re.findall(r"\]\((\w+)\.md\)", text))


SCENARIOS = [
    {"scenario": "lost_motion", "declared": 40.0, "imitated": {"presliding": 30.0}},
    {"scenario": "friction_map", "declared": 50.0, "imitated": {"presliding": 0.2}},
]


@pytest.mark.usefixtures("extensions")
def test_verdict_names_the_nearest_imitator() -> None:
    pages = module("effect_pages")
    assert "`lost_motion` distinguishes it: its nearest imitator, `presliding`, leaves 30 times" in pages.scenarios_of(
        SCENARIOS
    )
    assert "no shipped scenario settles it" in pages.scenarios_of(SCENARIOS[1:])


@pytest.mark.usefixtures("extensions")
def test_sizes_of_pictures_are_effects() -> None:
    """Each is one that a plant file may hold; a searched effect without one has a page without a picture, said here."""
    planted = module("planted")
    assert set(planted.SIZES) <= set(EVERY_EFFECT)
    assert all(planted.planted(name).name == name for name in planted.SIZES)
    searched = {one.name for one in module("effect_pages").CANDIDATES} | set(THERMAL_EFFECTS)
    assert searched - set(planted.SIZES) == set()


@pytest.mark.slow
@pytest.mark.usefixtures("extensions")
def test_picture_of_backlash_is_that_of_backlash(tmp_path: Path) -> None:
    """Strokes to and fro: the table lags by the play, half of it to either side."""
    planted = module("planted")
    effect = planted.planted("backlash")
    seen, runs = planted.seen_by_scenarios(effect, planted.imitators_of(effect)[:1])
    assert {one.scenario for one in seen} == set(runs)
    # 7.5 µm to either side against 5.3 nm of noise is 700 times it; both channels together about two thirds of that
    assert max(one.declared for one in seen) > 300
    assert all(one.imitated["presliding"] <= one.declared for one in seen)
    assert planted.residual_figure(effect, runs[seen[0].scenario]).axes


@pytest.mark.usefixtures("extensions")
def test_commands_are_all_shown_with_their_options() -> None:
    text = module("written_pages_text").commands_page()
    for name in COMMANDS:
        assert f"## `{name}`" in text
        for parameter in load(name).params:
            assert all(option in text for option in parameter.opts if option.startswith("--"))


@pytest.mark.usefixtures("extensions")
def test_keys_are_shown_where_the_package_lists_them(monkeypatch: pytest.MonkeyPatch) -> None:
    listed = {
        "": FakeKeys("all files", (), {"plant": "machine"}),
        "plant": FakeKeys("machine", (), {"plant.table": "what moves", "plant.effect.backlash": "free play"}),
        "plant.table": FakeKeys("what moves", (("mass", "kg", "a|b"),), {}),
    }
    monkeypatch.setattr(fd, "keys", listed.__getitem__, raising=False)
    text = module("written_pages_text").files_page()
    assert "### `plant.table`" in text and "| `mass` | a\\|b | kg |" in text
    assert "backlash" not in text.split("## Shipped")[0]


@dataclass(frozen=True)
class FakeKeys:
    """What `fd.keys` answers: the keys of a section, and the sections inside it."""

    meaning: str
    rows: tuple[tuple[str, str, str], ...]
    sections: dict[str, str]

    def listing(self) -> Listing:
        records = [{"key": row[0]} for row in self.rows] + [{"section": path} for path in self.sections]
        rows = [*self.rows, *((path, "section", "") for path in self.sections)]
        return Listing(self.meaning, ("key", "unit", "meaning"), rows, records)


@pytest.mark.usefixtures("extensions")
def test_interface_shows_every_public_name() -> None:
    text = module("written_pages_text").interface_page()
    shown = re.findall(r"^\.\. auto(?:class|function):: feeddrive\.(\w+)", text, re.MULTILINE)
    assert sorted(shown) == sorted(set(fd.__all__) - {"__version__"})


@pytest.mark.usefixtures("extensions")
def test_house_has_every_folder_and_nothing_hangs_from_above() -> None:
    house = module("house")
    order = house.order_of(ROOT / "CONTRIBUTING.md")
    folders = {path.name for path in (ROOT / "feeddrive").iterdir() if (path / "__init__.py").is_file()}
    assert folders <= set(order)
    floors = house.floors_of(ROOT / "feeddrive", order)
    for number, floor in enumerate(floors):
        assert set(floor.imports) <= set(order[:number]), floor.name
        assert floor.words, f"{floor.name}: say in the first line of its __init__.py what happens there"
    drawn = ElementTree.fromstring(house.house(ROOT))
    texts = {one.text for one in drawn.iter("{http://www.w3.org/2000/svg}text")}
    assert set(order) <= texts


def test_start_prints_what_the_readme_prints() -> None:
    """The values of the demo, which the list of claims holds to what is measured."""
    shown = re.findall(r"[\d.]+ (?:µm|mm|N) \[[\d., ]+\]", (DOCS / "start.md").read_text(encoding="utf-8"))
    readme = " ".join((ROOT / "README.md").read_text(encoding="utf-8").split())
    assert len(shown) == 3 and all(value in readme for value in shown)


def test_gallery_holds_figures_of_every_kind() -> None:
    text = (DOCS / "gallery.md").read_text(encoding="utf-8")
    assert len(re.findall(r"^:caption:", text, re.MULTILINE)) >= 16


def test_every_page_is_in_the_list_of_pages() -> None:
    index = (DOCS / "index.md").read_text(encoding="utf-8")
    for path in WRITTEN:
        name = path.relative_to(DOCS).with_suffix("").as_posix()
        assert name == "index" or re.search(rf"^{name}$", index, re.MULTILINE), f"{name} is in no list of docs/index.md"


@pytest.mark.slow
def test_site_builds_without_a_warning(tmp_path: Path) -> None:
    """The whole site; what it shows is computed, so the first time takes minutes."""
    if importlib.util.find_spec("furo") is None or importlib.util.find_spec("myst_parser") is None:
        pytest.skip("the site needs the extra docs: pip install -e '.[docs]'")
    # by itself: what the builder's own extensions are told of later versions is no warning of the site
    command = [sys.executable, "-m", "sphinx", "-W", "--keep-going", "-n", "-q"]
    built = subprocess.run(
        [*command, str(DOCS), str(tmp_path / "html"), "-d", str(tmp_path / "d")],
        capture_output=True,
        text=True,
        check=False,
    )
    assert built.returncode == 0, built.stderr
    assert (tmp_path / "html" / "generated" / "effects" / "backlash.html").is_file()
