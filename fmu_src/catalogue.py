"""The models there are, by name."""

from collections.abc import Mapping

from fmu_src.interface import Model
from fmu_src.net_capture.interface import MODEL as NET_CAPTURE
from fmu_src.reel_control.interface import MODEL as REEL_CONTROL
from fmu_src.tethered_deorbit.interface import MODEL as TETHERED_DEORBIT

MODELS: Mapping[str, Model] = {model.name: model for model in (NET_CAPTURE, TETHERED_DEORBIT, REEL_CONTROL)}
