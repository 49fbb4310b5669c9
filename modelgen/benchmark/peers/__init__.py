"""Other simulators in the same measurement. Each is an extra, imported when it is asked for."""

from __future__ import annotations

from collections.abc import Mapping

from modelgen.benchmark.peers.drake import DRAKE
from modelgen.benchmark.peers.exudyn import EXUDYN
from modelgen.benchmark.peers.mujoco import MUJOCO
from modelgen.benchmark.peers.peer import Peer, PeerPoints, peer_points
from modelgen.benchmark.peers.siconos import SICONOS
from modelgen.benchmark.peers.simbody import SIMBODY

__all__ = ["PEERS", "Peer", "PeerPoints", "peer_points"]

PEERS: Mapping[str, Peer] = {peer.name: peer for peer in (MUJOCO, DRAKE, EXUDYN, SICONOS, SIMBODY)}
