"""Command line: python -m tests.recovery.fleet --seeds 1:40 --out DIR [--resume]; see --help."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from feeddrive.files import write_text_atomically
from tests.recovery.fleet.case import encoder_null_seeds
from tests.recovery.fleet.run import cases_done, run_missing
from tests.recovery.fleet.state import fleet_state
from tests.recovery.fleet.table import section
from tests.recovery.fleet.verdict import Verdict
from tests.recovery.page import with_section


def main(arguments: Sequence[str] | None = None) -> int:
    """Run what is asked for; 0 when done."""
    options = _parser().parse_args(arguments)
    options.seeds += options.encoder_nulls
    if options.write:
        from tests.recovery.fleet.case import case

        for seed in options.seeds:
            case(seed).write(options.out / str(seed))
        return 0
    if options.table_only:
        return write_table(options.out, options.page)
    if not options.resume and cases_done(options.out):
        print(f"error: {options.out} holds results; say --resume to go on, or name another folder", file=sys.stderr)
        return 2
    run_missing(
        options.seeds, options.out, options.workers, options.limit, options.minutes, print_line, options.most_rows
    )
    return write_table(options.out, options.page) if options.page else 0


def write_table(folder: Path, page: Path | None) -> int:
    """Put the section of the fleet into a page, or print it."""
    state = fleet_state()
    verdicts = [Verdict(record) for record in cases_done(folder, state).values()]
    part = section(verdicts, state)
    if page is None:
        print_line(part)
        return 0
    old = page.read_text(encoding="utf-8") if page.exists() else "# Recovery\n"
    write_text_atomically(page, with_section(old, part))
    print_line(f"{page}: {len(verdicts)} cases of state {state}")
    return 0


def print_line(text: str) -> None:
    """Print at once, also into a file."""
    print(text, flush=True)


def seeds_of(text: str) -> list[int]:
    """Return the seeds of "1:40" (both included) or "3,17,29"."""
    result: list[int] = []
    for part in text.split(","):
        first, _, last = part.partition(":")
        result += range(int(first), int(last or first) + 1)
    return result


def encoder_nulls_of(text: str) -> list[int]:
    """Return the seeds of the machines "0:9" of every encoder."""
    numbers = seeds_of(text)
    return encoder_null_seeds(numbers[0], numbers[-1])


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m tests.recovery.fleet", description=__doc__)
    parser.add_argument("--seeds", type=seeds_of, default=[], help="1:40, or 3,17; below 100000 for development")
    parser.add_argument(
        "--encoder-nulls", type=encoder_nulls_of, default=[],
        help="0:9: machines with nothing planted, of every encoder from 12 to 24 bits; from 500 on for publication",
    )  # fmt: skip
    parser.add_argument("--out", type=Path, required=True, help="folder of results.jsonl")
    parser.add_argument("--resume", action="store_true", help=f"go on where it stopped (state {fleet_state()})")
    parser.add_argument("--write", action="store_true", help="write plant, recordings and truth of each seed, no more")
    parser.add_argument("--table-only", action="store_true", help="no runs: the table of the records that are there")
    parser.add_argument("--page", type=Path, help="page that holds the table, such as docs/recovery.md")
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--limit", type=float, default=300.0, help="processor seconds of one diagnosis")
    parser.add_argument("--most-rows", type=int, default=0, help="leave out cases with longer recordings")
    parser.add_argument("--minutes", type=float, default=0.0, help="begin no case later than this")
    return parser


if __name__ == "__main__":
    sys.exit(main())
