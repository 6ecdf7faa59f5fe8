"""The arms of `arms.py` with collision geometry of every kind on their links, and the URDF alone."""

from pathlib import Path

from arms import ArmRecipe, write_arm

SHAPES = (
    '<cylinder radius="0.05" length="0.2"/>',
    '<box size="0.08 0.12 0.18"/>',
    '<sphere radius="0.07"/>',
    '<mesh filename="wedge.obj" scale="0.001 0.001 0.001"/>',
)
WEDGE = """v -40 -30 0
v 40 -30 0
v 40 30 0
v -40 30 0
v -20 0 180
v 20 0 180
f 1 2 3
f 1 3 4
f 1 2 6
f 1 6 5
f 2 3 6
f 3 4 5
f 3 5 6
f 4 1 5
"""


def write_solid_urdf(recipe: ArmRecipe, folder: Path) -> Path:
    """Write the arm's URDF, with a shape on every moving link.

    Returns:
        The URDF.
    """
    write_arm(recipe, folder).unlink()
    (folder / "wedge.obj").write_text(WEDGE)
    urdf = folder / f"{recipe.name}.urdf"
    text = urdf.read_text()
    for index in range(1, len(recipe.joints) + 1):
        shape = SHAPES[(index + recipe.seed) % len(SHAPES)]
        origin = '<origin xyz="0.01 0 0.09" rpy="0.1 0.2 0.3"/>'
        solid = (
            f'<link name="link_{index}"><collision>{origin}<geometry>{shape}</geometry></collision></link>'
        )
        text = text.replace(f'<link name="link_{index}"/>', solid)
    urdf.write_text(text)
    return urdf
