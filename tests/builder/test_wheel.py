"""The package as it is installed from a wheel, without the checkout."""

import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def test_a_wheel_carries_runtime_templates_and_examples(tmp_path: Path) -> None:
    checkout, site = tmp_path / "checkout", tmp_path / "site"
    checkout.mkdir()
    for name in ("pyproject.toml", "setup.py", "MANIFEST.in", "LICENSE"):
        shutil.copy(ROOT / name, checkout)
    (checkout / "README.md").write_text("the long description")
    for name in ("proxgen", "runtime", "examples"):
        shutil.copytree(ROOT / name, checkout / name, ignore=shutil.ignore_patterns("__pycache__", ".*"))
    options = ["--no-deps", "--no-build-isolation", "--disable-pip-version-check", "--quiet"]
    subprocess.run(
        [sys.executable, "-m", "pip", "install", *options, "--target", site, checkout],
        check=True,
        cwd=tmp_path,
    )
    installed = site / "proxgen"
    assert (installed / "_runtime" / "LICENSE").read_text() == (ROOT / "LICENSE").read_text()
    for part in ("include", "src", "bench"):
        expected = {path.name for path in (ROOT / "runtime" / part).rglob("*") if path.is_file()}
        assert {p.name for p in (installed / "_runtime" / part).rglob("*") if p.is_file()} == expected
    for templates in ROOT.glob("proxgen/*/templates/*"):
        assert (site / templates.relative_to(ROOT)).is_file(), templates
    scenes = sorted(path.stem for path in (ROOT / "examples" / "scenes").glob("*.yaml"))
    script = (
        f"import sys; sys.path.insert(0, {str(site)!r}); "
        "import proxgen; from proxgen.builder import build, sources; "
        f"assert proxgen.__file__.startswith({str(site)!r}); "
        f"assert str(sources.runtime_directory()).startswith({str(site)!r}); "
        "from proxgen.config.examples import examples_directory; "
        "from proxgen.config.scene import load_scene, scene_names; "
        f"assert str(examples_directory()).startswith({str(site)!r}); "
        f"assert load_scene('gap').obstacles and scene_names() == {scenes!r}; "
        "assert proxgen.load(examples_directory() / 'iiwa7' / 'iiwa7.yaml').robot.name == 'iiwa7'; "
        "config = proxgen.load(examples_directory() / 'planar2' / 'planar2.yaml'); "
        f"proxgen.build(config, {str(tmp_path / 'built')!r}, backend='daqp').reset()"
    )
    subprocess.run([sys.executable, "-P", "-c", script], check=True, cwd=tmp_path)
