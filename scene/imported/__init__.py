"""What mesh files say of the materials of their faces: glTF and GLB, OBJ with MTL, PLY."""
