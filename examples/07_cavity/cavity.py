#!/usr/bin/env python3
"""Steady laminar flow in a square cavity whose lid and floor slide: a small CFD code to make cases with.

    cavity.py OUTPUT --cases 50 --cells 24     # OUTPUT/cases.csv, OUTPUT/centres.csv, OUTPUT/<case>.csv
    cavity.py --check                          # against Ghia, Ghia & Shin (1982) at Re = 100

Equations: u . grad(w) = nu laplace(w), w = -laplace(psi), u = d psi / dz, v = -d psi / dx, in a square of side 0.1 m; central
differences on the nodes of a uniform grid, Thom's formula for w at the walls, Newton's method to a residual of 1e-10.
Fields in the cells between nodes: velocities from the mean slopes of psi along their faces, so that each cell's flows balance
exactly, and pressure from the balance of momentum on the faces, by least squares, its mean 0.
"""
import argparse
import csv
import pathlib
import sys

try:
    import numpy as np
except ImportError:
    print("this needs numpy: apt install python3-numpy, or PYTHON=... for another Python")
    sys.exit(77)

SIDE = 0.1  # m
DENSITY = 1000.0  # kg/m3


class Cavity:
    """psi on the nodes of n x n cells; index [z, x]."""

    def __init__(self, n):
        self.n, self.h = n, SIDE / n
        m = n - 1  # inner nodes a side
        self.inner = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)[1:-1, 1:-1].ravel()
        h, size = self.h, (n + 1) ** 2
        # Vorticity on all nodes is linear in psi on the inner ones: w = A psi + walls.
        a = np.zeros((size, m * m))
        column = -np.ones(size, int)
        column[self.inner] = np.arange(m * m)
        for k in self.inner:
            a[k, column[k]] = 4 / h**2
            for neighbour in (k - 1, k + 1, k - n - 1, k + n + 1):
                if column[neighbour] >= 0:
                    a[k, column[neighbour]] = -1 / h**2
        for i in range(1, n):  # Thom: w = -2 psi_1 / h2 on walls at rest
            for wall, beside in ((i, i + n + 1), (n * (n + 1) + i, (n - 1) * (n + 1) + i),
                                 (i * (n + 1), i * (n + 1) + 1), (i * (n + 1) + n, i * (n + 1) + n - 1)):
                a[wall, column[beside]] = -2 / h**2
        inner = self.inner
        self.a = a
        self.slope_x = (a[inner + 1] - a[inner - 1]) / (2 * h)
        self.slope_z = (a[inner + n + 1] - a[inner - n - 1]) / (2 * h)
        self.laplace = (a[inner + 1] + a[inner - 1] + a[inner + n + 1] + a[inner - n - 1] - 4 * a[inner]) / h**2
        # u = d psi / dz and v = -d psi / dx on inner nodes.
        self.u, self.v = np.zeros((m * m, m * m)), np.zeros((m * m, m * m))
        for row, k in enumerate(inner):
            for neighbour, matrix, sign in ((k + n + 1, self.u, 1), (k - n - 1, self.u, -1), (k + 1, self.v, -1),
                                            (k - 1, self.v, 1)):
                if column[neighbour] >= 0:
                    matrix[row, column[neighbour]] = sign / (2 * h)

        # Pressure: differences between neighbouring cells, by least squares; the mean is held at 0.
        cells = np.arange(n * n).reshape(n, n)
        pairs = np.concatenate([np.stack([cells[:, :-1].ravel(), cells[:, 1:].ravel()], axis=1),
                                np.stack([cells[:-1].ravel(), cells[1:].ravel()], axis=1)])
        self.difference = np.zeros((len(pairs), n * n))
        rows = np.arange(len(pairs))
        self.difference[rows, pairs[:, 0]], self.difference[rows, pairs[:, 1]] = -1, 1
        self.to_pressure = np.linalg.inv(self.difference.T @ self.difference + 1 / n**2) @ self.difference.T

    def walls(self, lid, floor):
        """Vorticity at moving walls, beside what psi gives."""
        w = np.zeros((self.n + 1) ** 2)
        w[self.n * (self.n + 1) + 1:-1] = -2 * lid / self.h
        w[1:self.n] = 2 * floor / self.h
        return w

    def solve(self, lid, floor, nu):
        """psi on the inner nodes. Speeds in m/s, nu in m2/s."""
        n, h, inner = self.n, self.h, self.inner
        wall = self.walls(lid, floor)
        x = (wall[inner + 1] - wall[inner - 1]) / (2 * h)
        z = (wall[inner + n + 1] - wall[inner - n - 1]) / (2 * h)
        lap = (wall[inner + 1] + wall[inner - 1] + wall[inner + n + 1] + wall[inner - n - 1] - 4 * wall[inner]) / h**2
        psi = np.linalg.solve(self.laplace, -lap)  # Stokes flow
        for _ in range(30):
            u, v = self.u @ psi, self.v @ psi
            wx, wz = self.slope_x @ psi + x, self.slope_z @ psi + z
            residual = u * wx + v * wz - nu * (self.laplace @ psi + lap)
            scale = nu * np.abs(lap).max()
            if np.abs(residual).max() <= 1e-10 * scale:
                return psi
            jacobian = (u[:, None] * self.slope_x + wx[:, None] * self.u + v[:, None] * self.slope_z
                        + wz[:, None] * self.v - nu * self.laplace)
            psi = psi - np.linalg.solve(jacobian, residual)
        sys.exit(f"no steady flow found for lid {lid} m/s, floor {floor} m/s, nu {nu} m2/s")

    def on_nodes(self, psi, lid, floor):
        """psi, u and v on all nodes, [z, x]."""
        full = np.zeros((self.n + 1) ** 2)
        full[self.inner] = psi
        full = full.reshape(self.n + 1, self.n + 1)
        u, v = np.zeros_like(full), np.zeros_like(full)
        u[1:-1, 1:-1] = (self.u @ psi).reshape(self.n - 1, -1)
        v[1:-1, 1:-1] = (self.v @ psi).reshape(self.n - 1, -1)
        u[-1], u[0] = lid, floor
        return full, u, v

    def in_cells(self, psi, lid, floor, nu):
        """velocity_x [m/s], velocity_z [m/s], pressure [Pa] of each cell, [z, x]."""
        n, h = self.n, self.h
        full, u, v = self.on_nodes(psi, lid, floor)
        w = (self.a @ psi + self.walls(lid, floor)).reshape(n + 1, n + 1)
        velocity_x = ((full[1:, :-1] + full[1:, 1:]) - (full[:-1, :-1] + full[:-1, 1:])) / (2 * h)
        velocity_z = -((full[:-1, 1:] + full[1:, 1:]) - (full[:-1, :-1] + full[1:, :-1])) / (2 * h)
        # Slopes of H = p / rho + |u|^2 / 2 on the faces between cells: dH/dx = v w - nu dw/dz, dH/dz = -u w + nu dw/dx.
        up = lambda q: (q[:-1, 1:-1] + q[1:, 1:-1]) / 2
        across = lambda q: (q[1:-1, :-1] + q[1:-1, 1:]) / 2
        slope_x = up(v) * up(w) - nu * (w[1:, 1:-1] - w[:-1, 1:-1]) / h
        slope_z = -across(u) * across(w) + nu * (w[1:-1, 1:] - w[1:-1, :-1]) / h
        total = self.to_pressure @ (h * np.concatenate([slope_x.ravel(), slope_z.ravel()]))
        pressure = DENSITY * (total.reshape(n, n) - (velocity_x**2 + velocity_z**2) / 2)
        return velocity_x, velocity_z, pressure - pressure.mean()


def check():
    """Ghia, Ghia & Shin, J. Comput. Phys. 48 (1982), tables I and II, Re = 100, 129 x 129 nodes."""
    z = [0.0547, 0.0625, 0.0703, 0.1016, 0.1719, 0.2813, 0.4531, 0.5, 0.6172, 0.7344, 0.8516, 0.9531, 0.9609, 0.9688, 0.9766]
    u = [-0.03717, -0.04192, -0.04775, -0.06434, -0.10150, -0.15662, -0.21090, -0.20581, -0.13641, 0.00332, 0.23151,
         0.68717, 0.73722, 0.78871, 0.84123]
    x = [0.0625, 0.0703, 0.0781, 0.0938, 0.1563, 0.2266, 0.2344, 0.5, 0.8047, 0.8594, 0.9063, 0.9453, 0.9531, 0.9609, 0.9688]
    v = [0.09233, 0.10091, 0.10890, 0.12317, 0.16077, 0.17507, 0.17527, 0.05454, -0.24533, -0.22445, -0.16914, -0.10313,
         -0.08864, -0.07391, -0.05906]
    worst = []
    for n in (16, 32):
        cavity = Cavity(n)
        _, u_nodes, v_nodes = cavity.on_nodes(cavity.solve(1.0, 0.0, SIDE / 100), 1.0, 0.0)
        nodes = np.linspace(0, 1, n + 1)  # over the side
        # Between nodes as straight lines would cut the peaks: a cubic through four nodes instead.
        error = max(np.abs(between(nodes, u_nodes[:, n // 2], z) - u).max(),
                    np.abs(between(nodes, v_nodes[n // 2], x) - v).max())
        worst.append(error)
        print(f"{n} x {n} cells: largest difference from Ghia et al. (1982) at Re = 100: {error:.4f} of the lid's speed")
    if worst[1] > 0.02 or worst[1] > 0.6 * worst[0]:
        sys.exit("the solver does not converge to the published values")


def between(nodes, values, places):
    result = []
    for place in places:
        first = int(np.clip(np.searchsorted(nodes, place) - 2, 0, len(nodes) - 4))
        part = slice(first, first + 4)
        result.append(np.polyval(np.polyfit(nodes[part] - place, values[part], 3), 0))
    return np.array(result)


def inputs(n_cases, seed):
    """A Latin hypercube: lid [m/s], floor [m/s], Reynolds number of the lid; each row a case."""
    random = np.random.default_rng(seed)
    low, high = np.array([0.5, -0.6, 30]), np.array([1.5, 0.6, 300])
    places = np.stack([(random.permutation(n_cases) + random.random(n_cases)) / n_cases for _ in low], axis=1)
    return low + (high - low) * places


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("output", nargs="?", type=pathlib.Path, help="folder to write to")
    parser.add_argument("--cases", type=int, default=50, help="every fifth is named test_*")
    parser.add_argument("--cells", type=int, default=24, help="of each side")
    parser.add_argument("--check", action="store_true", help="compare with published values instead")
    arguments = parser.parse_args()
    if arguments.check:
        return check()
    if arguments.output is None:
        parser.error("OUTPUT is missing")
    arguments.output.mkdir(parents=True, exist_ok=True)
    cavity = Cavity(arguments.cells)
    middle = (np.arange(arguments.cells) + 0.5) * cavity.h
    x, z = (grid.ravel() for grid in np.meshgrid(middle, middle))  # x fastest
    places = [f"{a:.10g},0,{b:.10g}" for a, b in zip(x, z)]
    (arguments.output / "centres.csv").write_text("\n".join(["x [m],y [m],z [m]"] + places) + "\n")
    with open(arguments.output / "cases.csv", "w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["case", "lid_speed [m/s]", "floor_speed [m/s]", "reynolds_number"])
        for i, values in enumerate(inputs(arguments.cases, 1)):
            name = f"{'test' if i % 5 == 4 else 'train'}_{i:03d}"
            written = [f"{value:.6g}" for value in values]
            table.writerow([name] + written)
            lid, floor, reynolds = map(float, written)
            nu = lid * SIDE / reynolds
            fields = [field.ravel() for field in cavity.in_cells(cavity.solve(lid, floor, nu), lid, floor, nu)]
            lines = ["x [m],y [m],z [m],velocity_x [m/s],velocity_z [m/s],pressure [Pa]"]
            lines += [place + "".join(f",{value:.8g}" for value in values) for place, *values in zip(places, *fields)]
            (arguments.output / f"{name}.csv").write_text("\n".join(lines) + "\n")
    print(f"{arguments.cases} cases of {arguments.cells} x {arguments.cells} cells in {arguments.output}")


if __name__ == "__main__":
    main()
