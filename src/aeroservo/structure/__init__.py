"""Structures: sections, assumed shapes, beams and the user's own modes, each giving a ModalModel."""
