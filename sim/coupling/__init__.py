"""What passes between materials, and between a material and solids: only here are two materials known.

Each module or package declares by MATERIALS what a scene must have for it to be loaded. `sim.run` imports it.
"""
