"""The chains that a plant can have, by their name in plant files, and what they are made of."""

from __future__ import annotations

from feeddrive.plant.chain.distributed_screw import DistributedScrew
from feeddrive.plant.chain.linear_chain import Chain, ChainValue, Spring, symbolic
from feeddrive.plant.chain.lumped_chains import Rigid, ThreeInertias

__all__ = ["CHAINS", "Chain", "ChainValue", "DistributedScrew", "Rigid", "Spring", "ThreeInertias", "symbolic"]

CHAINS: dict[str, type[Chain]] = {chain.structure: chain for chain in (Rigid, ThreeInertias, DistributedScrew)}
"""Structure name of plant files to chain."""
