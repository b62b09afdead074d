#!/usr/bin/env python3
"""One sphere against a rigid plane, integrated in two dimensions: the golden values of `verify/oblique.rs`.

An implementation of its own: overlap, slip and spin are scalars, nothing is shared with the engine. Velocity Verlet
with forces at the half-step velocity, t_c/4000. The lever arm of the contact is R - h/2, the limit of a sphere of
infinite radius; with `arm_is_radius` it is R, which is what most published values use.
"""
import math


def impact(R, E, nu, rho, mu, e, vn, vt, w=0.0, rescaled=False, clamp=False, arm_is_radius=False, parts=4000):
    m = 4 / 3 * math.pi * R**3 * rho
    inertia = 0.4 * m * R * R
    k_normal = 4 / 3 * E / (1 - nu * nu) * math.sqrt(R)
    k_shear = 8 * (E / 2 / (1 + nu)) / (2 - nu) * math.sqrt(R)
    log = math.log(e)
    factor = 2 * math.sqrt(5 / 6) * -log / math.sqrt(math.pi**2 + log * log)
    h_max = (5 * m * vn * vn / 4 / k_normal) ** 0.4
    t_c = 2.9432752 * h_max / vn
    dt = t_c / parts
    h, dh, v, t = 0.0, vn, vt, 0.0
    normal = shear = moment = 0.0
    slip = stiffness = 0.0
    while h > 0 or t < 0.2 * t_c:
        dh -= 0.5 * dt * normal / m
        v += 0.5 * dt * shear / m
        w += 0.5 * dt * moment / inertia
        h += dt * dh
        t += dt
        if h <= 0:
            break
        arm = R if arm_is_radius else R - 0.5 * h
        root = math.sqrt(h)
        normal = k_normal * h * root + factor * math.sqrt(1.5 * k_normal * root * m) * dh
        if clamp:
            normal = max(normal, 0.0)
        before, stiffness = stiffness, k_shear * root
        if rescaled and stiffness > before:
            slip *= before / stiffness
        slip += (v - w * arm) * dt
        limit = mu * max(normal, 0.0)
        if stiffness * abs(slip) > limit:
            slip = math.copysign(limit / stiffness, slip)
        shear = -stiffness * slip
        moment = -shear * arm
        dh -= 0.5 * dt * normal / m
        v += 0.5 * dt * shear / m
        w += 0.5 * dt * moment / inertia
    return v, w, -dh


def table(name, rows):
    print(f"{name}:")
    for row in rows:
        print("    (" + ", ".join(f"{x:.6g}" if i == 0 else f"{x:.5f}" for i, x in enumerate(row)) + "),")


if __name__ == "__main__":
    for name, E, nu, rho in (("aluminium oxide", 3.8e11, 0.23, 4000), ("aluminium alloy", 7e10, 0.33, 2700)):
        for rescaled in (False, True):
            rows = []
            for angle in (2, 5, 10, 15, 20, 25, 30, 35, 40, 45, 50, 60, 70, 80, 85):
                a = math.radians(angle)
                vn, vt = 3.9 * math.cos(a), 3.9 * math.sin(a)
                v, w, _ = impact(0.0025, E, nu, rho, 0.092, 0.98, vn, vt, rescaled=rescaled)
                v0, w0, _ = impact(0.0025, E, nu, rho, 0.092, 0.98, vn, vt, rescaled=rescaled, arm_is_radius=True)
                rows.append((angle, v / vt, w, v0 / vt, w0))
            table(f"test 4, {name}, {'rescaled' if rescaled else 'displacement'}: angle, e_t, omega; with R", rows)
    for rescaled in (False, True):
        rows = []
        for psi in (0.35, 0.68, 1, 1.5, 2, 2.5, 3, 4, 5, 6, 10, 20):
            v, w, _ = impact(1e-5, 2.08e11, 0.3, 7850, 0.3, 1.0, 5, psi * 1.5, rescaled=rescaled)
            v0, w0, _ = impact(1e-5, 2.08e11, 0.3, 7850, 0.3, 1.0, 5, psi * 1.5, rescaled=rescaled, arm_is_radius=True)
            rows.append((psi, -1e-5 * w / 1.5, (v - 1e-5 * w) / 1.5, -1e-5 * w0 / 1.5, (v0 - 1e-5 * w0) / 1.5))
        table(f"test 5, steel, {'rescaled' if rescaled else 'displacement'}: psi, R omega, slip; with R", rows)
    for name, E, nu, rho in (("aluminium alloy", 7e10, 0.33, 2700), ("nylon", 2.5e9, 0.4, 1000)):
        rows = []
        for s in (0.187, 0.55, 0.765, 0.979, 1.214, 1.492, 2.09, 2.99, 4.51, 7.84, 24):
            vt = 3.5 * 0.4 * 1.5 * 0.2 / s
            row = [s]
            for arm_is_radius in (False, True):
                v, w, _ = impact(0.1, E, nu, rho, 0.4, 0.5, 0.2, 0, -vt / 0.1, clamp=True, arm_is_radius=arm_is_radius)
                row.append(-(v - 0.1 * w) / vt)
            rows.append(row)
        table(f"test 6, {name}, clamped: s, beta; with R", rows)
