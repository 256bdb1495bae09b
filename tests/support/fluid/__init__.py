"""What tests of fluids share."""
