"""What writes GLB files from formulas: numbers as accessors, pictures as PNG, surfaces as grids. Standard library only;
the bytes depend on the version of zlib alone."""
import json
import math
import struct
import zlib

blob, views, accessors = bytearray(), [], []


def view(data, target=None):
    while len(blob) % 4:
        blob.append(0)
    views.append({"buffer": 0, "byteOffset": len(blob), "byteLength": len(data)})
    if target:
        views[-1]["target"] = target
    blob.extend(data)
    return len(views) - 1


def accessor(rows, kind, code, component, bounds=False, normalized=False):
    flat = [v for r in rows for v in (r if isinstance(r, tuple) else (r,))]
    a = {"bufferView": view(struct.pack(f"<{len(flat)}{code}", *flat), 34963 if kind == "SCALAR" else 34962),
         "componentType": component, "count": len(rows), "type": kind}
    if bounds:
        a["min"] = [min(c) for c in zip(*rows)]
        a["max"] = [max(c) for c in zip(*rows)]
    if normalized:
        a["normalized"] = True
    accessors.append(a)
    return len(accessors) - 1


def f32(v):
    return struct.unpack("<f", struct.pack("<f", v))[0]


def grid(nu, nv, point, uv=lambda s, t: (s, t), color=None, short_uv=False):
    """A primitive over [0, 1]^2: point(s, t) -> position; normals by differences."""
    rows = [(i / nu, j / nv) for j in range(nv + 1) for i in range(nu + 1)]
    position, normal = [], []
    for s, t in rows:
        e = 1e-4
        p = point(s, t)
        a = [x - y for x, y in zip(point(s + e, t), point(s - e, t))]
        b = [x - y for x, y in zip(point(s, t + e), point(s, t - e))]
        n = (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])
        size = math.sqrt(sum(x * x for x in n)) or 1
        position.append(tuple(f32(x) for x in p))
        normal.append(tuple(x / size for x in n))
    index = []
    for j in range(nv):
        for i in range(nu):
            k = j * (nu + 1) + i
            index += [k, k + 1, k + nu + 2, k, k + nu + 2, k + nu + 1]
    small = len(rows) < 65535
    attributes = {"POSITION": accessor(position, "VEC3", "f", 5126, bounds=True),
                  "NORMAL": accessor(normal, "VEC3", "f", 5126)}
    place = [uv(s, t) for s, t in rows]
    if short_uv:
        attributes["TEXCOORD_0"] = accessor([(round(u * 65535), round(v * 65535)) for u, v in place], "VEC2", "H", 5123,
                                            normalized=True)
    else:
        attributes["TEXCOORD_0"] = accessor(place, "VEC2", "f", 5126)
    if color:
        attributes["COLOR_0"] = accessor([tuple(round(255 * c) for c in color(s, t)) + (255,) for s, t in rows], "VEC4",
                                         "B", 5121, normalized=True)
    return {"attributes": attributes, "indices": accessor(index, "SCALAR", "H" if small else "I", 5123 if small else 5125)}


def png(width, height, pixel, channels=3):
    """pixel(u, v) -> channels, v down; RGB or RGBA."""
    raw = b"".join(b"\0" + bytes(round(255 * min(1, max(0, c))) for x in range(width) for c in pixel(x / width, y / height))
                   for y in range(height))

    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2 if channels == 3 else 6, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(raw, 9)) + chunk(b"IEND", b""))


def mix(a, b, t):
    return tuple(x + (y - x) * t for x, y in zip(a, b))


TAU = 2 * math.pi


def lathe(profile):
    def point(s, t):
        r, y = profile(min(1, max(0, t)))
        r = max(r, 1e-7)
        return (r * math.sin(TAU * s), y, r * math.cos(TAU * s))
    return point


def mesh(name, material, primitive):
    primitive["material"] = material
    return {"name": name, "primitives": [primitive]}


def turn(axis, degrees):
    h = math.radians(degrees) / 2
    return [axis[0] * math.sin(h), axis[1] * math.sin(h), axis[2] * math.sin(h), math.cos(h)]


def look(eye, target):
    """The node matrix of a camera or light at `eye`."""
    z = [e - t for e, t in zip(eye, target)]
    size = math.sqrt(sum(c * c for c in z))
    z = [c / size for c in z]
    x = [z[2], 0, -z[0]]
    size = math.hypot(x[0], x[2])
    x = [c / size for c in x]
    y = [z[1] * x[2] - z[2] * x[1], z[2] * x[0] - z[0] * x[2], z[0] * x[1] - z[1] * x[0]]
    return [*x, 0, *y, 0, *z, 0, *eye, 1]


def write(path, document):
    while len(blob) % 4:
        blob.append(0)
    document["bufferViews"], document["accessors"] = views, accessors
    document["buffers"] = [{"byteLength": len(blob)}]
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    with open(path, "wb") as out:
        out.write(struct.pack("<III", 0x46546C67, 2, 12 + 8 + len(text) + 8 + len(blob)))
        out.write(struct.pack("<II", len(text), 0x4E4F534A) + text)
        out.write(struct.pack("<II", len(blob), 0x004E4942) + blob)
