"""Fixtures of the report's tests."""

import pytest

from proxgen.report import style


@pytest.fixture
def coarse(monkeypatch: pytest.MonkeyPatch) -> None:
    """Few pixels, so that many figures can be drawn."""
    monkeypatch.setattr(style, "DPI", 40)
