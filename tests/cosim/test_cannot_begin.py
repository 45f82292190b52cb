"""Scenes that cannot begin are told so before anything is built, with the key at fault."""

import pytest

from dcone_cosim.errors import InputError
from dcone_cosim.loading import load

MUZZLE = "capture.chaser.start_position"
ALONG = "capture.shot.axis=[0.0,1.0,0.0]"


@pytest.mark.parametrize("place", ['["0 m","0 m","0 m"]', '["0 m","-0.2 m","0 m"]', '["0 m","-1 m","0 m"]'])
@pytest.mark.parametrize("axis", [(), (ALONG,)])
def test_a_muzzle_within_the_target(place: str, axis: tuple[str, ...]) -> None:
    """In its centre of mass too, whether the axis is told or follows."""
    with pytest.raises(InputError) as error:
        load("table1-capture", (f"{MUZZLE}={place}", *axis))
    told = str(error.value)
    assert MUZZLE in told
    assert ("names no direction" if not axis and "-" not in place else "would begin inside it") in told
    load("table1-capture", (f'{MUZZLE}=["0 m","-12 m","0 m"]', *axis))


def test_a_perigee_within_the_earth() -> None:
    """a (1 - e) = R: with a of 7178.137 km at e = 0.11145; before it any orbit may begin."""
    for altitude, least in (("800 km", 0.11145), ("100000 km", 0.94004)):
        setting = f"orbit.altitude={altitude}"
        load("table2-deorbit", (setting, f"orbit.eccentricity={least - 1e-4}"))
        with pytest.raises(InputError, match=f"eccentricity.*below the equatorial radius.*at most {least:.3g}"):
            load("table2-deorbit", (setting, f"orbit.eccentricity={least + 1e-4}"))


@pytest.mark.parametrize(
    ("scene", "setting", "bound"),
    [
        ("table1-capture", "capture.net.youngs_modulus=1e-300 GPa", "1e-09 to 1e[+]20 Pa"),
        ("table1-capture", "capture.net.density=1e-300 kg/m3", "1e-20 to 1e[+]06 kg/m3"),
        ("table1-capture", "capture.chaser.mass=1e300 kg", "1e-15 to 1e[+]24 kg"),
        ("table2-deorbit", "removal.chaser.mass=1e-300 kg", "1e-15 to 1e[+]24 kg"),
        ("table2-deorbit", "removal.tether.youngs_modulus=1e-300 GPa", "1e-09 to 1e[+]20 Pa"),
    ],
)
def test_a_quantity_that_no_body_has(scene: str, setting: str, bound: str) -> None:
    key = setting.partition("=")[0]
    with pytest.raises(InputError, match=f"{key} = .*no such quantity of a body or a material: {bound}"):
        load(scene, (setting,))
