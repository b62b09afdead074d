#!/usr/bin/env python3
"""Bonded chains and blocks, statically and in free vibration: reference values of the cases `chain/bending-vibration`
and `block/tension-*`. Linear stiffness of the parallel bond, six unknowns a sphere, conjugate gradients; nothing is
shared with the engine. Needs no packages; takes half a minute."""

import math


def chain_frequency(links, kappa, multiplier):
    """Lowest bending frequency of a clamped chain times sqrt(m/K_n): inverse iteration; lengths in spacings."""
    shear, bending, inertia = kappa, (0.5 * multiplier) ** 2 / 4, 0.1
    size = 2 * links
    matrix = [[0.0] * size for _ in range(size)]

    def spring(row, stiffness):
        for i, a in row:
            for j, b in row:
                if i >= 0 and j >= 0:
                    matrix[i][j] += stiffness * a * b

    for k in range(links):
        here = 2 * k - 2 if k else -1
        turn = here + 1 if k else -1
        spring([(here, -1.0), (turn, -0.5), (2 * k, 1.0), (2 * k + 1, -0.5)], shear)
        spring([(turn, -1.0), (2 * k + 1, 1.0)], bending)
    masses = [1.0, inertia] * links

    def solve(right):
        rows = [row[:] + [value] for row, value in zip(matrix, right)]
        for pivot in range(size):
            for row in rows[pivot + 1:]:
                factor = row[pivot] / rows[pivot][pivot]
                if factor:
                    for column in range(pivot, size + 1):
                        row[column] -= factor * rows[pivot][column]
        found = [0.0] * size
        for k in reversed(range(size)):
            found[k] = (rows[k][size] - sum(rows[k][c] * found[c] for c in range(k + 1, size))) / rows[k][k]
        return found

    shape = [float((k // 2 + 1) ** 2) if k % 2 == 0 else 2.0 * (k // 2 + 1) for k in range(size)]
    for _ in range(30):
        load = [m * s for m, s in zip(masses, shape)]
        found = solve(load)
        square = sum(f * s for f, s in zip(load, shape)) / sum(f * u for f, u in zip(load, found))
        shape = [u / found[-2] for u in found]
    return math.sqrt(square)


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def block(cells, kappa=1 / 3):
    """Modulus from grip to grip and within over that of the lattice, and Poisson's ratio in the middle; a = K_n = 1."""
    sites = [(x, y, z) for z in range(2 * cells[2]) for y in range(2 * cells[1]) for x in range(2 * cells[0])
             if (x + y + z) % 2 == 0]
    index = {site: k for k, site in enumerate(sites)}
    radius = 0.5 / math.sqrt(2)
    bending = radius * radius / 4
    torsion = 2 * kappa * bending
    bonds = []
    for i, site in enumerate(sites):
        for step in ((1, 1, 0), (1, -1, 0), (1, 0, 1), (1, 0, -1), (0, 1, 1), (0, 1, -1)):
            j = index.get(tuple(s + d for s, d in zip(site, step)))
            if j is not None:
                bonds.append((i, j, tuple(d / math.sqrt(2) for d in step)))

    def resistance(u):
        out = [0.0] * len(u)
        for i, j, n in bonds:
            a, b = 6 * i, 6 * j
            rolling = cross([radius * (u[a + 3 + c] + u[b + 3 + c]) for c in range(3)], n)
            gap = [u[b + c] - u[a + c] - rolling[c] for c in range(3)]
            turn = [u[b + 3 + c] - u[a + 3 + c] for c in range(3)]
            along, twist = dot(gap, n), dot(turn, n)
            force = [kappa * g + (1 - kappa) * along * c for g, c in zip(gap, n)]
            couple = [bending * t + (torsion - bending) * twist * c for t, c in zip(turn, n)]
            arm = cross(n, [radius * f for f in force])
            for c in range(3):
                out[a + c] -= force[c]
                out[b + c] += force[c]
                out[a + 3 + c] -= arm[c] + couple[c]
                out[b + 3 + c] -= arm[c] - couple[c]
        return out

    top, strain = 2 * cells[2] - 1, 1.0
    held = [False] * (6 * len(sites))
    u = [0.0] * len(held)
    for k, site in enumerate(sites):
        # About the middle, so that nothing moves as a whole.
        for c in range(3):
            stretch = strain if c == 2 else -0.2 * strain
            u[6 * k + c] = stretch * 0.5 * (site[c] - 0.5 * (2 * cells[c] - 1))
        held[6 * k + 2] = site[2] in (0, top)
    rest = [0.0 if h else -f for h, f in zip(held, resistance(u))]
    way, square = rest[:], sum(r * r for r in rest)
    goal = 1e-18 * square
    while square > goal:
        back = resistance(way)
        step = square / sum(w * b for w, b in zip(way, back))
        for k in range(len(u)):
            u[k] += step * way[k]
            rest[k] -= 0.0 if held[k] else step * back[k]
        before, square = square, sum(r * r for r in rest)
        way = [r + square / before * w for r, w in zip(rest, way)]
    forces = resistance(u)
    pull = sum(forces[6 * k + 2] for k, site in enumerate(sites) if site[2] == top)
    modulus = pull / (cells[0] * cells[1]) / strain / (4 * (1 + 3 * kappa) / (3 + kappa))

    def layer(z):
        moved = [u[6 * k + 2] for k, site in enumerate(sites) if site[2] == z]
        return sum(moved) / len(moved)

    low, high = cells[2] // 2, 2 * cells[2] - 1 - cells[2] // 2
    within = (layer(high) - layer(low)) / (0.5 * (high - low))
    middle = [(0.5 * site[0], u[6 * k]) for k, site in enumerate(sites) if site[2] in (top // 2, top // 2 + 1)]
    x, v = (sum(point[c] for point in middle) / len(middle) for c in range(2))
    slope = sum((p - x) * (q - v) for p, q in middle) / sum((p - x) ** 2 for p, _ in middle)
    return modulus, modulus * strain / within, -slope / within


if __name__ == "__main__":
    print("chain of 10, kappa 0.4, bond radius 0.4 l: %.12f" % chain_frequency(10, 0.4, 0.8))
    for cells in ((3, 3, 3), (4, 4, 6), (5, 5, 8)):
        print("block", cells, "E grip to grip %.6f, within %.6f, Poisson's ratio %.6f" % block(cells), flush=True)
