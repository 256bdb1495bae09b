"""Files of other programs: glTF, OBJ and MTL, and pictures, as far as more than one stage reads them."""
