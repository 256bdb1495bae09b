"""What a scene places, before anything is built that steps: where it all is, and how far it reaches."""
