#!/usr/bin/env python3
"""Writes still_life.glb: a table with a vase, a globe, a ring and a screen, from formulas alone.

    python3 graphs/data/still_life.py graphs/data/still_life.glb

It uses what glTF 2.0 readers have to know: six materials, three of them with textures (PNG, in the file), one
unlit and two-sided, nested and mirrored nodes, indices of 16 and 32 bits, normalised texture coordinates, vertex
colours, a perspective camera, and lights of KHR_lights_punctual. Standard library only; the bytes depend on the
version of zlib alone.
"""
import math
import sys

from glb import TAU, grid, lathe, look, mesh, mix, png, turn, view, write

# ----- pictures, sRGB

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
        {"name": "sky", "type": "directional", "color": [0.55, 0.7, 1], "intensity": 0.9}]}}}

write(sys.argv[1], document)
