"""Times of the compiled controller: recorded closed-loop inputs, replayed from C and from Python."""

from proxgen.bench.run import Benchmark, run_benchmark

__all__ = ["Benchmark", "run_benchmark"]
