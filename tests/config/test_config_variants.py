"""Variants of a loaded configuration: what is replaced, what is switched off, what is refused."""

import pytest

from proxgen.config import load
from proxgen.config.hashing import config_hash
from proxgen.config.schema import Config
from proxgen.config.variants import override, with_method, with_noise
from proxgen.errors import ConfigError


def test_only_what_is_named_changes(iiwa7_config: Config) -> None:
    variant = override(iiwa7_config, {"avoidance.d_r": "15 cm", "task.posture.joints": {"joint_1": 0.1}})
    assert variant.avoidance.d_r == 0.15
    assert variant.task.posture is not None
    same = override(variant, {"avoidance.d_r": 0.17, "task.posture": None})
    assert config_hash(same) == config_hash(iiwa7_config)
    assert same.source == iiwa7_config.source
    assert same.urdf_path == iiwa7_config.urdf_path


def test_a_variant_is_checked_like_a_file(iiwa7_config: Config) -> None:
    with pytest.raises(ConfigError, match=r"avoidance\.d_r: d_r = 0\.3 m must be less than d_0l = 0\.22 m"):
        override(iiwa7_config, {"avoidance.d_r": 0.3})
    with pytest.raises(ConfigError, match="unknown"):
        override(iiwa7_config, {"avoidance.d_x": 0.3})


@pytest.mark.parametrize("method", ["repulsive", "tangential"])
@pytest.mark.parametrize("name", ["iiwa7", "iiwa7_improved", "iiwa7_dense"])
def test_other_methods_do_without_what_only_the_proposed_one_has(
    method: str, name: str, iiwa7_config: Config
) -> None:
    config = load(iiwa7_config.source.with_name(f"{name}.yaml"))
    variant = with_method(config, method)
    assert variant.avoidance.method == method
    assert variant.relaxation.mode == "staged"
    assert not variant.avoidance.circulation.enabled
    assert not variant.avoidance.self_collision.points
    assert variant.skin == config.skin
    assert with_method(variant, method) is variant


def test_noise_reaches_every_sensor(iiwa7_config: Config) -> None:
    cuffs = iiwa7_config.model_dump(mode="json")["skin"]["cuffs"]
    sensors = {"tof": {"range": 0.5}, "capacitive": {}}
    own = override(iiwa7_config, {"skin.cuffs": [cuff | sensors for cuff in cuffs]})
    worse = with_noise(own, 0.005, 0.05).model_dump(mode="json")["skin"]
    for part in (worse, *worse["cuffs"]):
        assert (part["tof"]["noise"], part["tof"]["dropout"]) == (0.005, 0.05)
        assert part["capacitive"]["dropout"] == 0.05
    assert [cuff["tof"]["range"] for cuff in worse["cuffs"]] == [0.5] * len(cuffs)
    kept = with_noise(with_noise(own, 0.005, 0.05), None, 0.1).skin
    assert kept.tof is not None
    assert (kept.tof.noise, kept.tof.dropout) == (0.005, 0.1)
