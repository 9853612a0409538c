"""`python -m tests.fuzz [MODULE ...] --cases 2000 --seed 1`: fuzz, print every case that breaks the promise, count."""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter

from tests.fuzz.harness import modules, run_cases, share_of


def main() -> int:
    """Run what was asked for; the exit status is 1 where a case broke the promise."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("modules", nargs="*", help=f"of {', '.join(modules())}; all if none is named")
    parser.add_argument("--cases", type=int, default=2000, help="of each module; a slow one runs fewer")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", type=int, help="the number of one case, to look at it")
    asked = parser.parse_args()
    broken = 0
    for name in asked.modules or modules():
        numbers = range(max(1, round(asked.cases * share_of(name)))) if asked.only is None else (asked.only,)
        statuses: Counter[str] = Counter()
        started, slowest = time.monotonic(), 0.0
        for outcome in run_cases(name, asked.seed, numbers):
            statuses[str(outcome.status)] += 1
            slowest = max(slowest, outcome.seconds)
            if outcome.fault or asked.only is not None:
                broken += bool(outcome.fault)
                print(f"{name} seed {asked.seed} case {outcome.number} ({outcome.what}): {outcome.fault or 'kept'}")
                print(f"    {outcome.line[:1500]}", flush=True)
        counted = ", ".join(f"{count} of status {status}" for status, count in sorted(statuses.items()))
        print(f"{name}: seed {asked.seed}, {sum(statuses.values())} cases: {counted}; slowest {slowest:.2f} s, "
              f"all {time.monotonic() - started:.0f} s", flush=True)  # fmt: skip
    print(f"{broken} cases broke the promise")
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(main())
