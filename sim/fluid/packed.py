"""What the fourth component of packed vectors is: it lies beside the other three, so that one load brings all."""

Q = 3
"""Of `position`: p / rho^2 [m^5/(kg s^2)]."""
DENSITY = 3
"""Of `velocity`, of `normal` of surface tension, and of the velocities that implicit viscosity looks for [kg/m^3]."""
DISTANCE = 3
"""Of a `face`: from the half-space beyond it [m]; the others are its normal."""
VOLUME = 3
"""Of a sample of a sheet: weighted volume [m^3]; the others are its place."""
