#!/usr/bin/env python3
"""An OBJ file's triangles as a mesh2 of POV-Ray: mesh.py NAME < FILE.obj > FILE.inc"""
import sys

vertices, normals, faces, of_normals = [], [], [], []
for words in map(str.split, sys.stdin):
    if words[:1] == ["v"]:
        vertices.append(words[1:4])
    elif words[:1] == ["vn"]:
        normals.append(words[1:4])
    elif words[:1] == ["f"]:
        corners = [[int(index) - 1 for index in (corner.split("/")[0], corner.split("/")[-1])] for corner in words[1:]]
        for second, third in zip(corners[1:], corners[2:]):
            faces.append([str(corner[0]) for corner in (corners[0], second, third)])
            of_normals.append([str(corner[1]) for corner in (corners[0], second, third)])
print(f"#declare {sys.argv[1]} = mesh2 {{")
lists = [("vertex_vectors", vertices), ("normal_vectors", normals), ("face_indices", faces), ("normal_indices", of_normals)]
for name, rows in lists:
    if rows:
        print(f"{name} {{ {len(rows)}")
        print("\n".join(f", <{', '.join(row)}>" for row in rows))
        print("}")
print("}")
