"""A robot's YAML file to a frozen, validated configuration; every mistake with its line."""

from proxgen.config.loader import load
from proxgen.config.schema import Config

__all__ = ["Config", "load"]
