"""How a cable scene is varied in a study: other elements, stiffness and constraints."""
