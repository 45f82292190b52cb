"""A third shot after two that have failed, as the second after one."""

from dcone_cosim.phases.second_shot import FurtherShot

PHASE = FurtherShot("third_shot", ("second_shot",))
