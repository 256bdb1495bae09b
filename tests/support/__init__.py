"""What tests of several folders share: small scenes by material, readers of what a run writes, and checkers."""
