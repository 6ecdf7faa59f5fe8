"""Compiles generated code and runtime with the system's compiler; does again only what changed."""

from proxgen.builder.pipeline import BuildResult, build, default_directory, other_owner

__all__ = ["BuildResult", "build", "default_directory", "other_owner"]
