"""Reports of runs and comparisons: figures as PNG, tables, one HTML page that opens from disk."""

from proxgen.report.write import write_report

__all__ = ["write_report"]
