"""The fingerprint of a configuration: what generated code was made from."""

import hashlib
import json

from proxgen.config.schema import Config


def config_hash(config: Config) -> str:
    """SHA-256 of all values of the configuration and of the bytes of the robot description, hexadecimal.

    Paths, comments, units and the order of keys make no difference; every value that is used does, whether
    it was written or is a default.
    """
    values = config.model_dump(mode="json")
    del values["robot"]["urdf"]
    text = json.dumps(values, sort_keys=True, ensure_ascii=True, allow_nan=False)
    digest = hashlib.sha256(text.encode("ascii"))
    digest.update(config.urdf_path.read_bytes())
    return digest.hexdigest()
