#!/usr/bin/env python3
"""Writes terrace.glb: a folding screen of stained glass among ivy and trellises, from formulas alone.

    python3 graphs/data/terrace.py graphs/data/terrace.glb

It uses what glTF 2.0 says of alpha: glass by BLEND with a texture whose lead is opaque and whose panes are not, leaves
and trellis by MASK, each with its cutoff, and two-sided materials.
"""
import math
import random
import sys

from glb import accessor, f32, grid, lathe, look, mesh, mix, png, turn, view, write

# ----- pictures, sRGB and opacity

PANES = [(0.78, 0.10, 0.12), (0.93, 0.66, 0.12), (0.10, 0.36, 0.70), (0.12, 0.55, 0.30), (0.55, 0.22, 0.62), (0.92, 0.86, 0.70)]
LEAD = (0.10, 0.10, 0.11, 1.0)


def stained(u, v):
    """A rose above an upright lattice of diamonds, in a frame."""
    if min(u, 1 - u) < 0.045 or min(v, 1 - v) < 0.022:
        return LEAD
    x, y = (u - 0.5) * 2, (v - 0.27) * 4
    r, angle = math.hypot(x, y), math.atan2(y, x) / (2 * math.pi) + 0.5
    if r < 0.86:
        petal = (angle * 8) % 1
        if abs(r - 0.82) < 0.04 or abs(r - 0.26) < 0.035 or (r > 0.26 and min(petal, 1 - petal) * r < 0.035):
            return LEAD
        color = PANES[1] if r < 0.26 else PANES[int(angle * 8) % 2 * 2]
        return (*color, 0.62)
    a, b = u * 4 + v * 8, u * 4 - v * 8
    if min(a % 1, 1 - a % 1) < 0.07 or min(b % 1, 1 - b % 1) < 0.07:
        return LEAD
    return (*PANES[(math.floor(a) * 3 + math.floor(b) * 5) % len(PANES)], 0.55)


def leaf(u, v):
    """Five lobes on a stalk below; opacity falls over a few texels, so that a cutoff of a half is its outline."""
    x, y = (u - 0.5) * 2, (0.44 - v) * 2
    r, angle = math.hypot(x, y), math.atan2(x, y)
    edge = (0.58 + 0.30 * abs(math.cos(2.5 * angle)) ** 0.8) * (1 - 0.18 * abs(angle) / math.pi)
    stalk = abs(x) < 0.035 and -1 < y < 0
    alpha = max(min(1, max(0, 0.5 + 10 * (edge - r))), 1.0 if stalk else 0.0)
    vein = abs(math.sin(2.5 * angle)) * r
    green = mix((0.72, 0.82, 0.42), (0.30, 0.52, 0.20), min(1, 0.1 + 0.6 * r + 4 * min(vein, 0.12)))
    return (*green, alpha)


def trellis(u, v):
    bar = min(abs((u + v) * 1 % 1 - 0.5), abs((u - v) % 1 - 0.5))
    return (*mix((0.94, 0.92, 0.87), (0.72, 0.69, 0.62), min(1, bar / 0.11)), min(1, max(0, 0.5 + 30 * (0.10 - bar))))


def flags(u, v):
    joint = min(u % 1, 1 - u % 1, v % 1, 1 - v % 1) < 0.025
    grain = 0.5 + 0.5 * math.sin(31 * u + 7 * math.sin(17 * v)) * math.sin(23 * v + 5 * math.sin(13 * u))
    return (0.30, 0.29, 0.27) if joint else mix((0.55, 0.52, 0.47), (0.63, 0.60, 0.54), grain)


images = [{"bufferView": view(data), "mimeType": "image/png"}
          for data in (png(128, 256, stained, 4), png(96, 96, leaf, 4), png(64, 64, trellis, 4), png(96, 96, flags))]

# ----- shapes, y up


def panel(width, height):
    return grid(1, 1, lambda s, t: (width * (s - 0.5), height * t, 0), lambda s, t: (s, 1 - t))


def lattice(width, height, cells):
    return grid(1, 1, lambda s, t: (width * (s - 0.5), height * t, 0), lambda s, t: (cells * s, cells * height / width * (1 - t)))


def ivy(leaves, seed):
    """Leaves around a pole of height 2.4, turned outwards and down, each bent along its middle."""
    rng = random.Random(seed)
    position, normal, uv, index = [], [], [], []
    for k in range(leaves):
        h = 2.4 * (k + rng.random()) / leaves
        around = 2.399963 * k + 0.5 * rng.random()
        out = (math.sin(around), 0, math.cos(around))
        side = (out[2], 0, -out[0])
        size, sag = 0.11 + 0.07 * rng.random(), 0.75 + 0.6 * rng.random()
        along = tuple(math.cos(sag) * o - (math.sin(sag) if i == 1 else 0) for i, o in enumerate(out))
        reach = 0.04 + 0.26 * rng.random() ** 1.5
        root = (reach * out[0], h + 0.15, reach * out[2])
        first = len(position)
        for s, t in ((-1, 0), (0, 0), (1, 0), (-1, 2), (0, 2), (1, 2)):
            lift = -0.28 * abs(s)
            p = tuple(r + size * (s * a + t * b) for r, a, b in zip(root, side, along))
            p = (p[0] + size * lift * out[0], p[1] + size * lift * 0.5, p[2] + size * lift * out[2])
            n = tuple(math.sin(sag) * o + (math.cos(sag) if i == 1 else 0) + 0.35 * s * a
                      for i, (o, a) in enumerate(zip(out, side)))
            length = math.sqrt(sum(c * c for c in n))
            position.append(tuple(f32(c) for c in p))
            normal.append(tuple(c / length for c in n))
            uv.append(((s + 1) / 2, 1 - t / 2))
        for a, b, c, d in ((0, 1, 4, 3), (1, 2, 5, 4)):
            index += [first + a, first + b, first + c, first + a, first + c, first + d]
    return {"attributes": {"POSITION": accessor(position, "VEC3", "f", 5126, bounds=True),
                           "NORMAL": accessor(normal, "VEC3", "f", 5126), "TEXCOORD_0": accessor(uv, "VEC2", "f", 5126)},
            "indices": accessor(index, "SCALAR", "H", 5123)}


def sphere(t):
    return 0.5 * math.sin(math.pi * t), 0.5 - 0.5 * math.cos(math.pi * t)


def urn(t):
    return 0.14 + 0.30 * math.sin(math.pi * min(1, 0.08 + 0.86 * t)) ** 1.5 + 0.10 * max(0, t - 0.85) / 0.15, 1.15 * t


meshes = [mesh("ground", 0, grid(1, 1, lambda s, t: (14 * (s - 0.5), 0, 10 * (0.5 - t)), lambda s, t: (14 * s, 10 * t))),
          mesh("pane", 1, panel(1.15, 2.3)),
          mesh("ivy", 2, ivy(170, 1)),
          mesh("trellis", 3, lattice(2.2, 2.6, 7)),
          mesh("ball", 4, grid(48, 24, lathe(sphere))),
          mesh("urn", 5, grid(48, 32, lathe(urn))),
          mesh("pole", 6, grid(16, 2, lathe(lambda t: (0.03, 2.6 * t))))]


def material(name, color=(1, 1, 1), metallic=0.0, roughness=0.6, picture=None, **more):
    pbr = {"baseColorFactor": [*color, 1], "metallicFactor": metallic, "roughnessFactor": roughness}
    if picture is not None:
        pbr["baseColorTexture"] = {"index": picture}
    return {"name": name, "pbrMetallicRoughness": pbr, **more}


def place(mesh_index, x, z, degrees=0):
    return {"mesh": mesh_index, "translation": [x, 0, z], "rotation": turn((0, 1, 0), degrees)}


nodes = [{"name": "terrace", "children": list(range(1, 16))},
         place(0, 0, 0),
         place(1, -1.08, 0.22, 24), place(1, 0, 0.22, -20), place(1, 1.06, 0.22, 22),
         place(3, -2.9, -1.7, 12), place(3, 0.1, -2.1), place(3, 3.0, -1.7, -12),
         place(4, -0.75, -0.85), place(5, 0.55, -0.9),
         place(2, -2.0, 0.55), place(6, -2.0, 0.55), place(2, 2.05, 0.3, 130), place(6, 2.05, 0.3),
         {"name": "sun", "matrix": look((-2.5, 5, 4), (0, 0, 0)), "extensions": {"KHR_lights_punctual": {"light": 0}}},
         {"name": "front", "camera": 0, "matrix": look((1.3, 1.75, 6.6), (0, 1.12, 0))}]

write(sys.argv[1], {
    "asset": {"version": "2.0", "generator": "graphs/data/terrace.py of frustum"},
    "extensionsUsed": ["KHR_lights_punctual"],
    "scene": 0, "scenes": [{"name": "terrace", "nodes": [0]}], "nodes": nodes, "meshes": meshes,
    "materials": [material("flags", roughness=0.8, picture=3),
                  material("glass", roughness=0.2, picture=0, alphaMode="BLEND", doubleSided=True),
                  material("leaves", roughness=0.55, picture=1, alphaMode="MASK", doubleSided=True),
                  material("trellis", roughness=0.8, picture=2, alphaMode="MASK", alphaCutoff=0.5, doubleSided=True),
                  material("brass", (0.91, 0.73, 0.36), 0.55, 0.38),
                  material("clay", (0.72, 0.36, 0.22), 0, 0.6, doubleSided=True),
                  material("pole", (0.25, 0.2, 0.15), 0, 0.7)],
    "textures": [{"source": 0, "sampler": 0}, {"source": 1, "sampler": 0}, {"source": 2, "sampler": 1},
                 {"source": 3, "sampler": 1}],
    "samplers": [{"wrapS": 33071, "wrapT": 33071}, {"wrapS": 10497, "wrapT": 10497}],
    "images": images,
    "cameras": [{"name": "front", "type": "perspective",
                 "perspective": {"yfov": 0.5, "znear": 0.1, "zfar": 60, "aspectRatio": 16 / 9}}],
    "extensions": {"KHR_lights_punctual": {"lights": [
        {"name": "sun", "type": "directional", "color": [1, 0.95, 0.85], "intensity": 2.6}]}}})
