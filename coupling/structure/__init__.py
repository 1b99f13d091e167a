"""The diaphragm of a scene as the structure of a coupled run: the cloth behind its port."""
