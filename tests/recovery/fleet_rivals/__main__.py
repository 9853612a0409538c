"""Command line: python -m tests.recovery.fleet_rivals --out DIR [--previous CHECKOUT], DIR being one of the fleet."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from feeddrive.files import write_text_atomically
from tests.recovery.fleet.__main__ import print_line, seeds_of
from tests.recovery.fleet.run import cases_done
from tests.recovery.fleet_rivals.run import rivals_done, run_rivals
from tests.recovery.fleet_rivals.table import section
from tests.recovery.page import with_section
from tests.recovery.suite.rivals import installed


def main(arguments: Sequence[str] | None = None) -> int:
    """Run what is missing, and put the table into the page or print it; 0 when done."""
    options = _parser().parse_args(arguments)
    fleet = list(cases_done(options.out, options.state).values())
    wanted = [record for record in fleet if not options.seeds or record["seed"] in options.seeds]
    if not options.table_only:
        if not installed():
            print("error: PySINDy and scikit-learn are missing: pip install -e '.[recovery]'", file=sys.stderr)
            return 2
        run_rivals(wanted, options.out, options.previous, options.limit, options.minutes, print_line)
    part = section(fleet, rivals_done(options.out), options.previous_name)
    if options.page is None:
        print_line(part)
        return 0
    write_text_atomically(options.page, with_section(options.page.read_text(encoding="utf-8"), part))
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m tests.recovery.fleet_rivals", description=__doc__)
    parser.add_argument("--out", type=Path, required=True, help="folder of the fleet's results.jsonl")
    parser.add_argument("--state", help="of the records that count; all if left out")
    parser.add_argument("--seeds", type=seeds_of, default=[], help="1:40, or 3,17; all if left out")
    parser.add_argument("--previous", type=Path, help="checkout of an earlier state, which diagnoses the same files")
    parser.add_argument("--previous-name", default="-", help="commit of that state, for the table")
    parser.add_argument("--limit", type=float, default=300.0, help="processor seconds of one diagnosis by it")
    parser.add_argument("--minutes", type=float, default=0.0, help="begin no case later than this")
    parser.add_argument("--table-only", action="store_true", help="no runs: the table of the records that are there")
    parser.add_argument("--page", type=Path, help="page that holds the table, such as docs/recovery.md")
    return parser


if __name__ == "__main__":
    sys.exit(main())
