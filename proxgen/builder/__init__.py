"""Compiles generated code and runtime with the system's compiler; does again only what changed."""

from proxgen.builder.pipeline import BuildResult, build

__all__ = ["BuildResult", "build"]
