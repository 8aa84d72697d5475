"""Other ways to the same end, each as those who know it use it, on the recordings and nominal models that a diagnosis
is given."""

from harness.proof.peers.ask import PEERS, compare_peers, to_ask

__all__ = ["PEERS", "compare_peers", "to_ask"]
