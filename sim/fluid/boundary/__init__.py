"""What the fluid meets: to a particle every solid is the half-space beyond the nearest point of its surface."""
