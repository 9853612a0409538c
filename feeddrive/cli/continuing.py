"""From what was typed to the job of `feeddrive diagnose`: a first one, or one that takes up an earlier diagnosis."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from feeddrive.cli.diagnosing import Job, Options, Source
from feeddrive.diagnosis.ledger.continued import Earlier, earlier_run
from feeddrive.diagnosis.ledger.ledger import FileUse, checksum
from feeddrive.effects.tabulated import Tabulated
from feeddrive.errors import InputError
from feeddrive.files import find_plant
from feeddrive.output_folder import finish_interrupted

SPLIT = 0.75
"""Share that is fitted where nothing else is said."""


def first_job(arguments: Sequence[str], options: Options) -> Job:
    """A diagnosis of its own: a plant and its recordings.

    Raises:
        InputError: no recording, or no folder.
    """
    if len(arguments) < 2:
        raise InputError("no recording is given", "", "write: feeddrive diagnose PLANT REC --out DIR")
    if options.out is None:
        raise InputError("--out is missing", "", "give a folder for the report, such as --out report")
    split = SPLIT if options.split is None else options.split
    fitted = tuple(_source(Path(name), options) for name in arguments[1:])
    judged = tuple(_source(path, options) for path in options.validate)
    plant = find_plant(arguments[0])
    return Job(plant, fitted, judged, options.out, split, options.simulate, measured=options.measured)


def continued_job(arguments: Sequence[str], folder: Path, options: Options) -> Job:
    """An earlier diagnosis with recordings added to its own.

    Raises:
        InputError: an earlier diagnosis that cannot be taken up, another plant than its, or a recording it has already.
    """
    finish_interrupted(folder)  # an earlier diagnosis may have been killed at its very end
    earlier = earlier_run(folder)
    names = list(arguments)
    plant = _plant(names[0])
    if plant is not None:
        names = names[1:]
        if checksum(plant) != checksum(earlier.plant):
            mend = "leave the plant out, or diagnose anew"
            raise InputError(
                f"another plant than that of the earlier diagnosis, {earlier.plant.name}", str(plant), mend
            )
    new = tuple(_source(Path(name), options) for name in names)
    if not new and not options.validate:
        raise InputError("no recording to add", str(folder), "name one more recording")
    judged = tuple(_source(path, options) for path in options.validate)
    _refuse_known(earlier, [*new, *judged])
    return Job(
        earlier.plant,
        (*(_known(use) for use in earlier.fit), *new),
        (*(_known(use) for use in earlier.validate), *judged),
        options.out or folder,
        earlier.split if options.split is None else options.split,
        options.simulate,
        tuple(effect for effect in earlier.effects if not isinstance(effect, Tabulated)),
        earlier,
        options.measured,
    )


def _plant(name: str) -> Path | None:
    """The plant that a word names, or None where it names a recording."""
    try:
        path = find_plant(name)
    except InputError:
        return None
    return path if path.suffix.lower() == ".toml" else None


def _source(path: Path, options: Options) -> Source:
    return Source(path, options.mapping, options.decimal)


def _known(use: FileUse) -> Source:
    return Source(use.path, use.mapping, use.decimal)


def _refuse_known(earlier: Earlier, added: Sequence[Source]) -> None:
    known = {use.sha256 for use in (*earlier.fit, *earlier.validate)}
    for source in added:
        if source.path.is_file() and checksum(source.path) in known:
            raise InputError("the earlier diagnosis has this recording already", str(source.path), "name another one")
