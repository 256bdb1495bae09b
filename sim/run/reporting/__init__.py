"""What a run tells of itself: numbers for the summary, progress, and what was not done as it was asked for."""
