"""Materials: friction and restitution."""

from __future__ import annotations

from dataclasses import dataclass, replace

from voxshell.base.arguments import as_fraction, as_not_negative
from voxshell.base.calls import explain_calls
from voxshell.errors import InputTypeError


@explain_calls
@dataclass(frozen=True)
class Material:
    """Friction and restitution of a body; many bodies may share one material.

    Args:
        friction: Coulomb's coefficient; Bullet multiplies those of both bodies.
        restitution: 0 to 1; Bullet multiplies those of both bodies.
        rolling_friction: Lever arm of the torque that resists rolling, meters; see
            :attr:`Body.rolling_friction`.
        spinning_friction: Lever arm of the torque that resists spinning about the contact's normal,
            meters. Bullet applies it only together with rolling friction.

    Raises:
        SettingsError: A number is out of range.

    Example:
        >>> import voxshell as vx
        >>> rubber = vx.Material(friction=1.0, restitution=0.6)
        >>> world = vx.World()
        >>> ball = world.add(vx.Sphere(0.1), material=rubber)
        >>> dull = world.add(vx.Sphere(0.1), material=rubber, restitution=0.1)
        >>> ball.material == rubber
        True
        >>> dull.material
        Material(friction=1.0, restitution=0.1, rolling_friction=0.0, spinning_friction=0.0)
    """

    friction: float = 0.5
    restitution: float = 0.0
    rolling_friction: float = 0.0
    spinning_friction: float = 0.0

    def __post_init__(self) -> None:
        for name in ("friction", "rolling_friction", "spinning_friction"):
            object.__setattr__(self, name, as_not_negative(getattr(self, name), name))
        object.__setattr__(self, "restitution", as_fraction(self.restitution, "restitution"))


def as_material(material: Material, **given: float | None) -> Material:
    """Return a copy of a material with some properties replaced.

    Raises:
        InputTypeError: ``material`` has another type.
        SettingsError: A number is out of range.
    """
    if not isinstance(material, Material):
        raise InputTypeError(f"material must be a Material, not {type(material).__name__}")
    changes = {name: value for name, value in given.items() if value is not None}
    return replace(material, **changes) if changes else material
