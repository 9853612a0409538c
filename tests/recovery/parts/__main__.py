"""Command line: python -m tests.recovery.parts --out DIR [--draw D] [--resume] [--page docs/recovery.md]; see --help.

Recordings of the machines of parts, their frequency responses, and recordings beside the lumped file; the page is
written after each.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

from feeddrive.files import write_text_atomically
from tests.recovery.fleet.run import Record
from tests.recovery.page import with_section
from tests.recovery.parts.cases import MACHINES, NULLS, PUBLISHED, WHAT, Case
from tests.recovery.parts.responses import WHAT as RESPONSES
from tests.recovery.parts.responses import ResponseCase
from tests.recovery.parts.run import RESULTS, Asked, parts_state, records_of, run_missing
from tests.recovery.parts.table import row_of, section

KINDS = ("recording", "response", "lumped")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run what is asked for; 0 when done."""
    options = _parser().parse_args(arguments)
    if not (options.resume or options.table_only) and (options.out / RESULTS).exists():
        print(f"error: {options.out} holds results; say --resume to go on, or name another folder", file=sys.stderr)
        return 2

    state = parts_state()

    def said(record: Record) -> None:
        print(row_of(record).line, flush=True)
        _write(options.page, options.out, state)

    if not options.table_only:
        chosen = [
            one for one in asked(options.draw, options.nulls, options.what)
            if one.kind in options.kinds and one.machine in options.machines
        ]  # fmt: skip
        run_missing(chosen, options.out, options.limit, options.minutes, options.resume, said)
    _write(options.page, options.out, state)
    return 0


def asked(draw: int, nulls: int = NULLS, what: Sequence[str] = ()) -> list[Asked]:
    """Everything on every machine, so many nulls of the machines in turn, responses with a further mode, lumped nulls.

    Args:
        draw: the first; what is planted has this one.
        nulls: recordings, and frequency responses, with nothing planted.
        what: is planted; the whole table where nothing is said.
    """
    turns = [(machine, draw + turn) for turn in range(-(-nulls // len(MACHINES))) for machine in MACHINES][:nulls]
    cases: list[Asked] = []
    for one in what or WHAT:
        if one != "nothing":
            cases += [Case(machine, one, draw) for machine in MACHINES if one in WHAT]
            continue
        cases += [Case(machine, one, each) for machine, each in turns]
        cases += [ResponseCase(machine, one, each) for machine, each in turns]
        cases += [Case(machine, one, draw, lumped=True) for machine in MACHINES]
    planted = [one for one in what or ("mode",) if one in RESPONSES[1:]]
    return cases + [ResponseCase(machine, one, draw) for one in planted for machine in MACHINES]


def _write(page: Path | None, folder: Path, state: str) -> None:
    """The records of this state on a page; where there are none, all that are there."""
    if page:
        records = records_of(folder, state) or records_of(folder)
        write_text_atomically(page, with_section(page.read_text(encoding="utf-8"), section([*records.values()])))


def _parser() -> argparse.ArgumentParser:
    def names_of(known: Sequence[str]) -> Callable[[str], list[str]]:
        def names(text: str) -> list[str]:
            chosen = text.split(",")
            for one in chosen:
                if one not in known:
                    raise argparse.ArgumentTypeError(f"{one!r} is none of {', '.join(known)}")
            return chosen

        return names

    every = [*dict.fromkeys((*WHAT, *RESPONSES))]
    parser = argparse.ArgumentParser(prog="python -m tests.recovery.parts", description=__doc__)
    parser.add_argument("--machines", type=names_of(MACHINES), default=[*MACHINES], help=", ".join(MACHINES))
    parser.add_argument("--kinds", type=names_of(KINDS), default=[*KINDS], help=", ".join(KINDS))
    whole = f"{', '.join(every)}; the whole table if not said"
    parser.add_argument("--what", type=names_of(every), default=[], help=whole)
    parser.add_argument(
        "--draw", type=int, default=PUBLISHED, help=f"of sizes and noise; below {PUBLISHED} for development"
    )
    parser.add_argument("--nulls", type=int, default=NULLS, help="recordings, and responses, with nothing planted")
    parser.add_argument("--out", type=Path, required=True, help=f"folder of {RESULTS}")
    parser.add_argument("--resume", action="store_true", help="go on where it stopped, in the same state of the code")
    parser.add_argument("--table-only", action="store_true", help="no runs: the table of the records that are there")
    parser.add_argument("--page", type=Path, help="page that holds the table, such as docs/recovery.md")
    parser.add_argument("--limit", type=float, default=900.0, help="processor seconds of one diagnosis")
    parser.add_argument("--minutes", type=float, default=0.0, help="begin no case later than this")
    return parser


if __name__ == "__main__":
    sys.exit(main())
