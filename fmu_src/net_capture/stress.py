"""The ends of a shot's range that belong to no part: bullets, and the steps that a master takes."""

from fmu_src.extremes import Extreme

EXTREMES = (
    *(
        Extreme(
            f"bullets at {speed:g} m/s",
            "fast shots: the opening, the impact and the strain of the threads follow the speed",
            "energy_gained",
            {"bullets.speed": speed},
            duration=duration,
            chief=speed == 100.0,
        )
        for speed, duration in ((0.3, 0.0), (20.0, 4.0), (100.0, 2.0))
    ),
    Extreme(
        "bullets of 10 kg",
        "bullets thirty times as heavy as the net",
        "energy_gained",
        {"bullets.mass": 10.0},
    ),
    *(
        Extreme(
            f"macro steps of {step:g} s",
            "what comes out hangs on no step of the master",
            "same",
            macro_step=step,
            duration=duration,
        )
        for step, duration in ((1e-6, 0.02), (1e-3, 2.0), (1.0, 0.0), (100.0, 100.0))
    ),
)
