"""Faces cut where a lightmap parts them."""
import bmesh
import numpy

from . import matching


def split_along(mesh, triangles, lines_of):
    """Cuts the faces of these triangles (a mask) along the lines of their triangles. `lines_of`: the triangles of the
    mesh as they were exported, as (face, three vertices) each."""
    wanted = {}
    for number in numpy.flatnonzero(triangles):
        wanted.setdefault(lines_of[number][0], [])
    for face, vertices in lines_of:
        if face in wanted:
            wanted[face].append(vertices)
    work = bmesh.new()
    work.from_mesh(mesh)
    work.verts.ensure_lookup_table()
    work.faces.ensure_lookup_table()
    faces = {number: work.faces[number] for number in wanted}
    for number, pieces in wanted.items():
        parts = [faces[number]]
        sides = {frozenset((edge.verts[0].index, edge.verts[1].index)) for edge in faces[number].edges}
        lines = {frozenset(pair) for a, b, c in pieces for pair in ((a, b), (b, c), (c, a))} - sides
        for line in lines:
            ends = [work.verts[vertex] for vertex in line]
            part = next(face for face in parts if all(end in face.verts for end in ends))
            other, _ = bmesh.utils.face_split(part, *ends)
            parts.append(other)
    work.to_mesh(mesh)
    work.free()


def pieces_of(triangle, pieces):
    """The numbers of the pieces (n, 3, 3) that lie in a triangle. Those of its back lie there, too, and face the other
    way."""
    same_side = matching.normals_of(pieces) @ matching.normals_of(triangle[None])[0] > 0
    return numpy.flatnonzero(same_side & matching.lies_in(pieces.mean(axis=1), triangle))


def replace_by_pieces(mesh, faces, pieces):
    """Where walls stand on a surface luxel cuts its triangles. The faces (number -> its triangles' corners (n, 3, 3))
    are replaced by the pieces (n, 3, 3) that lie in them, in the mesh's own coordinates. Faces without pieces stay."""
    work = bmesh.new()
    work.from_mesh(mesh)
    work.faces.ensure_lookup_table()
    places = {tuple(vertex.co): vertex for vertex in work.verts}
    found = [(work.faces[number], triangles) for number, triangles in faces.items()]
    old = []
    for face, triangles in found:
        inside = {int(one) for triangle in triangles for one in pieces_of(triangle, pieces)}
        made = 0
        for piece in sorted(inside):
            made += add_piece(work, face, pieces[piece], places)
        if made:
            old.append(face)
    bmesh.ops.delete(work, geom=old, context="FACES_ONLY")
    work.to_mesh(mesh)
    work.free()


def add_piece(work, face, corners, places):
    """A triangle with all that the face has. False: there is such a face."""
    vertices = []
    for corner in corners:
        place = tuple(float(one) for one in corner)
        if place not in places:
            places[place] = work.verts.new(place)
            copy_interpolated(places[place], face)
        vertices.append(places[place])
    try:
        made = work.faces.new(vertices, face)
    except ValueError:
        return False
    for loop in made.loops:
        copy_interpolated(loop, face)
    return True


def copy_interpolated(item, face):
    """What a face has at the place of a loop or a vertex."""
    try:
        item.copy_from_face_interp(face)
    except SystemError:  # Blender 3.4 wants its arguments in a tuple
        item.copy_from_face_interp((face,))
