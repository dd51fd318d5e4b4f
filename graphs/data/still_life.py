#!/usr/bin/env python3
"""Writes still_life.glb: a table with a vase, a globe, a ring and a screen, from formulas alone.

    python3 graphs/data/still_life.py graphs/data/still_life.glb

It uses what glTF 2.0 readers have to know: six materials, three of them with textures (PNG, in the file), one
unlit and two-sided, nested and mirrored nodes, indices of 16 and 32 bits, normalised texture coordinates, vertex
colours, a perspective camera, and lights of KHR_lights_punctual. Standard library only; the bytes depend on the
version of zlib alone.
"""
import json
import math
import struct
import sys
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


def png(width, height, pixel):
    raw = b"".join(b"\0" + bytes(round(255 * min(1, max(0, c))) for x in range(width) for c in pixel(x / width, y / height))
                   for y in range(height))

    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(raw, 9)) + chunk(b"IEND", b""))


# ----- pictures, sRGB

def mix(a, b, t):
    return tuple(x + (y - x) * t for x, y in zip(a, b))


def wood(u, v):
    plank = math.floor(v * 5)
    ring = 0.5 + 0.5 * math.sin(40 * (v * 5 - plank) + 6 * math.sin(3 * u * math.pi + 2.4 * plank) + plank * 1.7)
    seam = 0.55 if (v * 5) % 1 < 0.03 else 1
    return tuple(seam * c for c in mix((0.50, 0.30, 0.16), (0.68, 0.45, 0.26), ring))


def glaze(u, v):
    wave = 0.5 + 0.06 * math.sin(2 * math.pi * 6 * u)
    if abs(v - wave) < 0.05 or abs(v - wave - 0.14) < 0.015 or abs(v - wave + 0.14) < 0.015:
        return (0.93, 0.89, 0.80)
    petal = (6 * u) % 1 - 0.5, (v - 0.8) * 6
    if petal[0] ** 2 + petal[1] ** 2 < 0.1:
        return (0.85, 0.36, 0.25)
    return mix((0.07, 0.24, 0.42), (0.13, 0.42, 0.56), v)


def chart(u, v):
    lines = min(abs((12 * u + 0.5) % 1 - 0.5), abs((6 * v + 0.5) % 1 - 0.5) * 2)
    land = math.sin(7 * u * 2 * math.pi / 2 + 3 * math.sin(9 * v)) + math.sin(13 * v + 4 * math.cos(2 * math.pi * u)) - 0.35
    base = (0.80, 0.72, 0.52) if land > 0.12 else (0.62, 0.55, 0.38) if land > 0 else (0.36, 0.56, 0.62)
    return mix(base, (0.25, 0.22, 0.18), 0.6) if lines < 0.03 else base


images = []
for picture in (png(256, 256, wood), png(384, 256, glaze), png(384, 192, chart)):
    images.append({"bufferView": view(picture), "mimeType": "image/png"})

# ----- shapes, y up

TAU = 2 * math.pi


def lathe(profile):
    def point(s, t):
        r, y = profile(min(1, max(0, t)))
        r = max(r, 1e-7)
        return (r * math.sin(TAU * s), y, r * math.cos(TAU * s))
    return point


def vase(t):
    return 0.16 + 0.36 * math.sin(math.pi * (0.12 + 0.80 * t)) ** 1.6 + 0.13 * max(0, t - 0.82) / 0.18, 1.55 * t


def ball(t):
    return 0.62 * math.sin(math.pi * t), -0.62 * math.cos(math.pi * t)


def ring(s, t):
    r = 0.42 + 0.13 * math.cos(TAU * t)
    return (r * math.cos(TAU * s), 0.13 * math.sin(TAU * t), -r * math.sin(TAU * s))


def table(s, t):
    return (5.2 * (s - 0.5), 0, 3.6 * (0.5 - t))


def screen(s, t):
    return (3.4 * (s - 0.5), 1.7 * t, 0.28 * math.sin(3 * TAU * s))


def dusk(s, t):
    return mix((0.95, 0.55, 0.30), (0.16, 0.20, 0.42), t)


def mesh(name, material, primitive):
    primitive["material"] = material
    return {"name": name, "primitives": [primitive]}


meshes = [mesh("table", 0, grid(8, 8, table, lambda s, t: (2 * s, 2 * t))),
          mesh("vase", 1, grid(56, 40, lathe(vase), lambda s, t: (s, 1 - t), short_uv=True)),
          mesh("globe", 2, grid(56, 28, lathe(ball), lambda s, t: (s, 1 - t), short_uv=True)),
          mesh("ring", 3, grid(56, 20, ring)),
          mesh("screen", 4, grid(72, 12, screen, color=dusk)),
          mesh("stand", 5, grid(48, 6, lathe(lambda t: (0.46 - 0.30 * t ** 0.5, 0.14 * t))))]


def texture(i):
    return {"index": i, "extensions": {"KHR_texture_transform": {"scale": [1.5, 1.5], "rotation": 0.0}}} if i == 0 else {"index": i}


def material(name, color=(1, 1, 1), metallic=0.0, roughness=0.6, texture_index=None, **more):
    pbr = {"baseColorFactor": [*color, 1], "metallicFactor": metallic, "roughnessFactor": roughness}
    if texture_index is not None:
        pbr["baseColorTexture"] = texture(texture_index)
    return {"name": name, "pbrMetallicRoughness": pbr, **more}


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


nodes = [{"name": "room", "children": [1, 2, 3, 5, 6, 7, 8, 9, 10, 11]},
         {"name": "table", "mesh": 0},
         {"name": "vase", "mesh": 1, "translation": [-1.15, 0, -0.2]},
         {"name": "globe on its stand", "translation": [0.55, 0, -0.35], "children": [4, 12]},
         {"name": "globe", "mesh": 2, "translation": [0, 0.74, 0], "rotation": turn((0, 0, 1), -23.4)},
         {"name": "ring", "mesh": 3, "translation": [1.55, 0.131, 0.55]},
         {"name": "upright ring", "mesh": 3, "translation": [-0.35, 0.39, 0.75], "rotation": turn((1, 0, 0), 90),
          "scale": [0.71, 0.71, -0.71]},
         {"name": "screen", "mesh": 4, "translation": [0, 0, -1.45]},
         {"name": "front", "camera": 0, "matrix": look((1.6, 2.1, 5.4), (0.05, 0.62, 0))},
         {"name": "window", "matrix": look((-3, 4, 3), (0, 0, 0)), "extensions": {"KHR_lights_punctual": {"light": 0}}},
         {"name": "lamp", "translation": [2.2, 2.4, 1.6], "extensions": {"KHR_lights_punctual": {"light": 1}}},
         {"name": "sky", "matrix": look((2, 5, -3), (0, 0, 0)), "extensions": {"KHR_lights_punctual": {"light": 2}}},
         {"name": "stand", "mesh": 5}]

document = {
    "asset": {"version": "2.0", "generator": "graphs/data/still_life.py of frustum"},
    "extensionsUsed": ["KHR_lights_punctual", "KHR_materials_unlit", "KHR_texture_transform"],
    "scene": 0, "scenes": [{"name": "still life", "nodes": [0]}], "nodes": nodes, "meshes": meshes,
    "materials": [material("wood", roughness=0.7, texture_index=0),
                  material("glaze", roughness=0.25, texture_index=1, doubleSided=True),
                  material("chart", roughness=0.5, texture_index=2),
                  material("brass", (0.91, 0.73, 0.36), 0.55, 0.38),
                  material("paper", (0.55, 0.55, 0.55), doubleSided=True, extensions={"KHR_materials_unlit": {}}),
                  material("ebony", (0.09, 0.07, 0.06), 0, 0.3)],
    "textures": [{"source": 0, "sampler": 0}, {"source": 1, "sampler": 1}, {"source": 2, "sampler": 1}],
    "samplers": [{"wrapS": 10497, "wrapT": 33648}, {"wrapS": 10497, "wrapT": 33071}],
    "images": images,
    "cameras": [{"name": "front", "type": "perspective",
                 "perspective": {"yfov": 0.42, "znear": 0.1, "zfar": 50, "aspectRatio": 16 / 9}}],
    "extensions": {"KHR_lights_punctual": {"lights": [
        {"name": "window", "type": "directional", "color": [1, 0.96, 0.88], "intensity": 2.4},
        {"name": "lamp", "type": "point", "color": [1, 0.72, 0.42], "intensity": 9},
        {"name": "sky", "type": "directional", "color": [0.55, 0.7, 1], "intensity": 0.9}]}},
    "bufferViews": views, "accessors": accessors, "buffers": [{"byteLength": 0}]}

while len(blob) % 4:
    blob.append(0)
document["buffers"][0]["byteLength"] = len(blob)
text = json.dumps(document, separators=(",", ":")).encode()
text += b" " * (-len(text) % 4)
with open(sys.argv[1], "wb") as out:
    out.write(struct.pack("<III", 0x46546C67, 2, 12 + 8 + len(text) + 8 + len(blob)))
    out.write(struct.pack("<II", len(text), 0x4E4F534A) + text)
    out.write(struct.pack("<II", len(blob), 0x004E4942) + blob)
