"""What falls freely: a step of Euler's kind takes it g dt^2 / 2 further than it should go. The mean of its velocities
before and after is exact, but would let what swings swing more and more, so that it has to do nothing but fall."""

OTHERS = 0.5
"""What other forces do, over gravity, from which on nothing is taken for falling; where there are none, all is."""
