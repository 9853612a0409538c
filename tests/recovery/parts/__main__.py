"""Command line: python -m tests.recovery.parts --out DIR [--resume] [--page docs/recovery.md]; see --help."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from feeddrive.files import write_text_atomically
from tests.recovery.page import with_section
from tests.recovery.parts.cases import MACHINES, NULLS, PUBLISHED, WHAT, Case
from tests.recovery.parts.run import RESULTS, records_of, run_missing
from tests.recovery.parts.table import section


def main(arguments: Sequence[str] | None = None) -> int:
    """Run what is asked for; 0 when done."""
    options = _parser().parse_args(arguments)
    if not (options.resume or options.table_only) and (options.out / RESULTS).exists():
        print(f"error: {options.out} holds results; say --resume to go on, or name another folder", file=sys.stderr)
        return 2
    if not options.table_only:
        nulls = range(options.draw + 1, options.draw + options.nulls)
        cases = [Case(m, what, options.draw) for what in options.what for m in options.machines]
        cases += [Case(m, "nothing", draw) for draw in nulls for m in options.machines]
        run_missing(cases, options.out, options.limit, options.minutes, options.resume, _say)
    if options.page:
        part = section(list(records_of(options.out).values()))
        write_text_atomically(options.page, with_section(options.page.read_text(encoding="utf-8"), part))
    return 0


def _say(text: str) -> None:
    print(text, flush=True)


def _parser() -> argparse.ArgumentParser:
    def names(text: str) -> list[str]:
        return text.split(",")

    parser = argparse.ArgumentParser(prog="python -m tests.recovery.parts", description=__doc__)
    parser.add_argument("--machines", type=names, default=[*MACHINES])
    parser.add_argument("--what", type=names, default=[*WHAT], help=", ".join(WHAT))
    parser.add_argument(
        "--draw", type=int, default=PUBLISHED, help=f"of sizes and noise; below {PUBLISHED} for development"
    )
    parser.add_argument("--nulls", type=int, default=NULLS, help="machines with nothing planted, of each")
    parser.add_argument("--out", type=Path, required=True, help=f"folder of {RESULTS}")
    parser.add_argument("--resume", action="store_true", help="go on where it stopped, in the same state of the code")
    parser.add_argument("--table-only", action="store_true", help="no runs: the table of the records that are there")
    parser.add_argument("--page", type=Path, help="page that holds the table, such as docs/recovery.md")
    parser.add_argument("--limit", type=float, default=900.0, help="processor seconds of one diagnosis")
    parser.add_argument("--minutes", type=float, default=0.0, help="begin no case later than this")
    return parser


if __name__ == "__main__":
    sys.exit(main())
