"""Command line: python -m tests.recovery.suite [run | table | sizes | list | state]; see --help."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from feeddrive.files import write_text_atomically
from tests.recovery.page import with_sections_of
from tests.recovery.suite import sizes
from tests.recovery.suite.cases import all_cases, smoke_cases
from tests.recovery.suite.planting import MACHINES
from tests.recovery.suite.store import code_state, kept, run_missing
from tests.recovery.suite.table import document
from tests.recovery.suite.verdict import Verdict

ROOT = Path(__file__).resolve().parents[3]


def main(arguments: Sequence[str] | None = None) -> int:
    """Run what is asked for; 0 when done."""
    options = _parser().parse_args(arguments)
    if options.what == "state":
        _say(code_state())
        return 0
    if options.what == "sizes":
        sizes.write(tuple(options.machine or MACHINES), options.effect)
        return 0
    cases = [case for case in all_cases() if all(word in case.label for word in options.only)]
    if options.smoke:
        cases = [case for case in smoke_cases() if all(word in case.label for word in options.only)]
    if options.what == "list":
        for case in cases:
            _say(f"{case.digest}  {case.label}")
        return 0
    if options.what == "run":
        chosen = [case for case in cases if case.in_half or not options.half]
        run_missing(chosen, options.records, options.workers, _say)
    _write_table(options.records, options.table)
    return 0


def _write_table(records: Path, path: Path) -> None:
    cases, code = all_cases(), code_state()
    found = [Verdict(record) for case in cases if (record := kept(records, case, code)) is not None]
    before = path.read_text(encoding="utf-8") if path.exists() else ""
    write_text_atomically(path, with_sections_of(document(cases, found), before))
    _say(f"{path}: {len(found)} of {len(cases)} cases")


def _say(text: str) -> None:
    print(text, flush=True)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m tests.recovery.suite", description="the recovery suite")
    parser.add_argument("what", nargs="?", default="run", choices=("run", "table", "sizes", "list", "state"))
    parser.add_argument("--workers", type=int, default=2, help="processes")
    parser.add_argument("--records", type=Path, default=ROOT / "build" / "recovery", help="folder of one file a case")
    parser.add_argument("--table", type=Path, default=ROOT / "docs" / "recovery.md", help="where the table goes")
    parser.add_argument("--only", action="append", default=[], help="cases whose label holds this word, repeatable")
    parser.add_argument("--smoke", action="store_true", help="one case an effect")
    parser.add_argument(
        "--half", action="store_true", help="every other single: each size once an axis and once a noise"
    )
    parser.add_argument("--machine", action="append", help="sizes: of this machine only, repeatable")
    parser.add_argument("--effect", default="", help="sizes: of this effect only")
    return parser


if __name__ == "__main__":
    sys.exit(main())
