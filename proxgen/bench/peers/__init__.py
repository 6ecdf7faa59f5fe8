"""The same arm, states and obstacles through other controllers, each in an environment of its own."""

from proxgen.bench.peers.measure import PeerBenchmark, run_peers

__all__ = ["PeerBenchmark", "run_peers"]
