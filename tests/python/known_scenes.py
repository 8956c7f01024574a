"""Scenes of the tests of the Python module, whose light and view factors are known."""
import pathlib

import numpy as np

import luxel

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
CORNELL_BOX = ROOT / "scenes" / "cornell-box.glb"
CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
FACES = {"floor": (0, 1, 5, 4), "ceiling": (2, 6, 7, 3), "left": (0, 2, 3, 1), "right": (4, 5, 7, 6),
         "back": (0, 4, 6, 2), "front": (1, 3, 7, 5)}  # counter-clockwise from inside


def cube(color=0.5, emission=0.0):
    """A room of 1 m, each wall a mesh of its own."""
    scene = luxel.Scene()
    grey = scene.add_material("grey", color, emission=emission)
    for name, quad in FACES.items():
        scene.add_mesh(CORNERS[list(quad)], [(0, 1, 2), (0, 2, 3)], grey, name=name)
    return scene


def square():
    """A square metre at y = 0 that faces up."""
    scene = luxel.Scene()
    grey = scene.add_material("grey", 0.5)
    scene.add_mesh([(0, 0, 0), (1, 0, 0), (1, 0, -1), (0, 0, -1)], [(0, 1, 2), (0, 2, 3)], grey)
    return scene
