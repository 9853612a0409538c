"""Command line: python -m tests.claims [check | page]; see --help."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from feeddrive.files import write_text_atomically
from tests.claims.book import CLAIMS
from tests.claims.run import run_all, targets_of
from tests.claims.table import page, table
from tests.state import ROOT


def main(arguments: Sequence[str] | None = None) -> int:
    """Do what is asked for; 0 where no claim is outside its bound, otherwise 2."""
    options = _parser().parse_args(arguments)
    if options.what == "page":
        write_text_atomically(ROOT / "docs" / "claims.md", page())
        return 0
    claims = [claim for claim in CLAIMS.values() if all(word in claim.key for word in options.only)]
    outcomes = run_all(targets_of(claims), options.records, options.workers, _say)
    text, outside = table(claims, outcomes)
    _say("\n" + text)
    return 2 if outside else 0


def _say(text: str) -> None:
    print(text, flush=True)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m tests.claims", description="the claims and their bounds")
    parser.add_argument(
        "what", nargs="?", default="check", choices=("check", "page"), help="page: write docs/claims.md"
    )
    parser.add_argument("--workers", type=int, default=2, help="processes")
    parser.add_argument("--records", type=Path, default=ROOT / "build" / "claims", help="folder of the outcomes")
    parser.add_argument("--only", action="append", default=[], help="claims whose key holds this word, repeatable")
    return parser


if __name__ == "__main__":
    sys.exit(main())
