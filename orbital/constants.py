"""Physical constants, each with its unit and its source.

Only the standard library is imported here, so that any floor, a packaging script or a page can read the numbers without
numba. A value is changed only together with its source; derived values are written as the expression they come from.
"""

import math

# Gravitational parameter of the Earth, atmosphere included [m^3/s^2].
# IERS Conventions 2010, table 1.1: 3.986004418e14 +- 8e5 (TCG-compatible); also the value of WGS 84.
EARTH_MU = 3.986004418e14

# Equatorial radius [m]. WGS 84, NGA.STND.0036 table 3.1. The reference the paper's altitudes are taken above.
EARTH_EQUATORIAL_RADIUS = 6378137.0

# Flattening of the ellipsoid [-]. WGS 84, NGA.STND.0036 table 3.1. NRLMSIS counts its altitude from that.
EARTH_FLATTENING = 1.0 / 298.257223563

# Second zonal harmonic, unnormalised [-]. EGM96: -sqrt(5) C20 with C20 = -4.84165371736e-4, in the tide-free
# system (Lemoine et al., NASA/TP-1998-206861).
EARTH_J2 = math.sqrt(5.0) * 4.84165371736e-4

# Third and fourth zonal harmonics, unnormalised [-]. EGM96: -sqrt(7) C30 and -sqrt(9) C40 with C30 = 9.57254173792e-7,
# C40 = 5.39873863789e-7 (Lemoine et al., NASA/TP-1998-206861).
EARTH_J3 = -math.sqrt(7.0) * 9.57254173792e-7
EARTH_J4 = -3.0 * 5.39873863789e-7

# Sidereal rotation rate of the Earth [rad/s]. WGS 84, NGA.STND.0036 table 3.1. Drives an atmosphere that turns with it.
EARTH_ROTATION_RATE = 7.292115e-5

# Standard acceleration of free fall [m/s^2], exact by definition, 3rd CGPM (1901). Turns specific impulse into
# exhaust speed.
STANDARD_GRAVITY = 9.80665

# Day [s], exact: 86400 SI seconds (IAU 1976).
DAY = 86400.0

# Julian year [s], exact: 365.25 days (IAU). The year in which durations such as "3.16 years" are quoted.
JULIAN_YEAR = 365.25 * DAY

# Mean tropical year at J2000 [s]: 365.242190402 days. Simon et al., Astronomy and Astrophysics 282 (1994) 663.
TROPICAL_YEAR = 365.242190402 * DAY

# Mean motion of the mean Sun along the equator, the rate a sun-synchronous node must keep [rad/s].
SUN_MEAN_MOTION = 2.0 * math.pi / TROPICAL_YEAR

# Solar radiation pressure on a perfect absorber at one astronomical unit [Pa]: 1361 W/m^2 over c = 299792458 m/s.
# IAU 2015 Resolution B3, nominal total solar irradiance.
SOLAR_RADIATION_PRESSURE = 1361.0 / 299792458.0

# Gravitational parameters of Sun and Moon [m^3/s^2]. DE440 (Park et al., Astronomical Journal 161 (2021) 105).
SUN_MU = 1.3271244004127942e20
MOON_MU = 4.902800118e12

# Astronomical unit [m], exact: IAU 2012 Resolution B2.
ASTRONOMICAL_UNIT = 149597870700.0

# Radius of the Sun [m]. IAU 2015 Resolution B3, nominal.
SUN_RADIUS = 695700000.0
