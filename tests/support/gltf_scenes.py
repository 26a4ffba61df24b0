"""glTF scenes written by hand, accessor by accessor."""

import base64
import json
import struct

import numpy as np

_CODES = {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123, "u4": 5125, "f4": 5126}
_KINDS = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}


class GltfScene:
    """A document that grows, with one buffer."""

    def __init__(self, **more):
        self.blob = b""
        self.document = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": []}], "nodes": []}
        self.document |= {"meshes": [], "accessors": [], "bufferViews": [], **more}

    def view(self, array):
        """A view of the numbers, four bytes aligned."""
        self.blob += b"\0" * (-len(self.blob) % 4)
        at, data = len(self.blob), array.tobytes()
        self.blob += data
        self.document["bufferViews"].append({"buffer": 0, "byteOffset": at, "byteLength": len(data)})
        return len(self.document["bufferViews"]) - 1

    def accessor(self, values, kind="f4", **more):
        """An accessor of (n,) or (n, width) numbers."""
        array = np.asarray(values).astype("<" + kind)
        view = {"bufferView": self.view(array)}
        return self.told(len(array), array.size // max(len(array), 1), kind, **view, **more)

    def told(self, count, width, kind="f4", **more):
        """An accessor as it is said."""
        told = {"componentType": _CODES[kind], "count": count, "type": _KINDS[width]}
        self.document["accessors"].append(told | more)
        return len(self.document["accessors"]) - 1

    def sparse(self, count, rows, values, width=3, kind="f4", index="u2", base=None):
        """An accessor of which only some rows are said, over a ``base`` or zeros."""
        places = {
            "count": len(rows),
            "indices": {
                "bufferView": self.view(np.asarray(rows).astype("<" + index)),
                "componentType": _CODES[index],
            },
            "values": {"bufferView": self.view(np.asarray(values).astype("<" + kind))},
        }
        more = {} if base is None else {"bufferView": self.view(np.asarray(base).astype("<" + kind))}
        return self.told(count, width, kind, sparse=places, **more)

    def mesh(self, V, F, weights=None, **part):
        """A mesh of one primitive; V may be an accessor."""
        position = V if isinstance(V, int) else self.accessor(V)
        attributes = {"POSITION": position, **part.pop("attributes", {})}
        indices = self.accessor(np.asarray(F).ravel(), "u4")
        mesh = {"primitives": [{"attributes": attributes, "indices": indices, **part}]}
        self.document["meshes"].append(mesh if weights is None else {**mesh, "weights": weights})
        return len(self.document["meshes"]) - 1

    def node(self, root=True, **told):
        """A node, by default at the top of the first scene."""
        self.document["nodes"].append(told)
        k = len(self.document["nodes"]) - 1
        if root:
            self.document["scenes"][0]["nodes"].append(k)
        return k

    def write(self, path):
        """Write the scene as GLB or text, as the path says."""
        document = {**self.document, "buffers": [{"byteLength": len(self.blob)}]}
        if path.suffix == ".gltf":
            coded = base64.b64encode(self.blob).decode()
            document["buffers"][0]["uri"] = "data:application/octet-stream;base64," + coded
            path.write_text(json.dumps(document, indent=1))
            return path
        text = json.dumps(document).encode()
        text += b" " * (-len(text) % 4)
        blob = self.blob + b"\0" * (-len(self.blob) % 4)
        chunks = struct.pack("<I4s", len(text), b"JSON") + text
        chunks += struct.pack("<I4s", len(blob), b"BIN\0") + blob
        path.write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks)
        return path
