"""A conducting sphere of one wavelength radius by the electric equation: Fredholm beside bempp-cl, at the same error.

    pip install numpy scipy numba bempp-cl
    cargo build --release
    python3 benches/beside_bempp.py [level]

bempp-cl has 12 4^level unknowns (768 for 3, 3,072 for 4, the default). Both find the field that the sphere scatters to
360 points 25 m from its middle, and are held against the series of Mie. Fredholm is given finer meshes until its error
is below that of bempp-cl. CPU seconds of all threads: assembly, dense LU and fields; bempp-cl has compiled its
kernels before, on a small sphere, and Fredholm's are those of the whole program.
"""

import os
import resource
import subprocess
import sys
import tempfile
import time

import bempp_cl.api as bempp
import numpy as np
from scipy.special import spherical_jn, spherical_yn

SPEED_OF_LIGHT = 299_792_458.0
FREQUENCY = 1e9
WAVELENGTH = SPEED_OF_LIGHT / FREQUENCY
WAVENUMBER = 2.0 * np.pi / WAVELENGTH
RADIUS = WAVELENGTH
DISTANCE = 25.0
POINTS = 360
ANGLES = 2.0 * np.pi * np.arange(POINTS) / POINTS
EDGES_PER_WAVELENGTH = {0: (6, 8, 10, 12, 14, 17, 20, 24), 1: (3, 4, 5, 6, 7, 8)}

SCENE = """
[wave]
frequencies_hz = [{frequency}]
method = "efie"
solver = "lu"
order = {order}

[[source]]
kind = "plane-wave"
travel = [0, 1, 0]
polarisation = [0, 0, 1]

[[surface]]
name = "sphere"
sphere = {{ centre = [0, 0, 0], radius = {radius} }}
edge = "lambda/{fineness}"

[[receiver]]
name = "circle"
circle = {{ centre = [0, 0, 0], radius = {distance}, normal = [0, 0, 1], start = [1, 0, 0], points = {points} }}
"""


def series():
    """E_z that a conducting sphere scatters in the plane across the polarisation, time factor exp(+jωt)."""
    size, far = WAVENUMBER * RADIUS, WAVENUMBER * DISTANCE
    # Waves travel along y; the angle of scattering is that of a point from y.
    cosine = np.sin(ANGLES)
    before, now = np.zeros(POINTS), np.ones(POINTS)
    field = np.zeros(POINTS, complex)
    for n in range(1, int(size + 4.0 * size ** (1.0 / 3.0) + 12.0)):
        tau = n * cosine * now - (n + 1) * before
        bessel, neumann = spherical_jn(n, size), spherical_yn(n, size)
        riccati = bessel + size * spherical_jn(n, size, derivative=True)
        outward = riccati + 1j * (neumann + size * spherical_yn(n, size, derivative=True))
        electric, magnetic = riccati / outward, bessel / (bessel + 1j * neumann)
        wave = spherical_jn(n, far) + 1j * spherical_yn(n, far)
        slope = spherical_jn(n, far, derivative=True) + 1j * spherical_yn(n, far, derivative=True)
        weight = 1j**n * (2 * n + 1) / (n * (n + 1))
        field += weight * (1j * electric * now * (wave / far + slope) - magnetic * tau * wave)
        before, now = now, ((2 * n + 1) * cosine * now - (n + 1) * before) / n
    return field.conj()


def circle():
    return DISTANCE * np.array([np.cos(ANGLES), np.sin(ANGLES), np.zeros(POINTS)])


def cpu_seconds(who):
    used = resource.getrusage(who)
    return used.ru_utime + used.ru_stime


def by_bempp(level):
    """Number of unknowns and E_z."""
    grid = bempp.shapes.regular_sphere(level)
    # Facets with the area of the round sphere, as those of Fredholm: corners on the sphere have 2.5 times the error.
    scale = RADIUS * np.sqrt(4.0 * np.pi / grid.volumes.sum())
    grid = bempp.Grid(grid.vertices * scale, grid.elements)
    div = bempp.function_space(grid, "RWG", 0)
    curl = bempp.function_space(grid, "SNC", 0)

    @bempp.complex_callable
    def tangential(x, normal, _domain, result):
        phase = np.exp(1j * WAVENUMBER * x[1])
        # (0, 0, phase) x normal
        result[0] = -phase * normal[1]
        result[1] = phase * normal[0]
        result[2] = 0.0

    electric = bempp.operators.boundary.maxwell.electric_field(div, div, curl, WAVENUMBER)
    trace = bempp.GridFunction(div, fun=tangential, dual_space=curl)
    currents = bempp.linalg.lu(electric, trace)
    potential = bempp.operators.potential.maxwell.electric_field(div, circle(), WAVENUMBER)
    return div.global_dof_count, -np.conj((potential * currents)[2])


def by_fredholm(program, order, fineness):
    scene = SCENE.format(
        frequency=FREQUENCY, order=order, radius=RADIUS, fineness=fineness, distance=DISTANCE, points=POINTS
    )
    with tempfile.TemporaryDirectory() as folder:
        path, out = os.path.join(folder, "sphere.toml"), os.path.join(folder, "out")
        with open(path, "w", encoding="utf-8") as file:
            file.write(scene)
        subprocess.run([program, "waves", path, "-o", out, "--no-report"], check=True, capture_output=True)
        table = np.genfromtxt(os.path.join(out, "receivers.csv"), delimiter=",", names=True, comments="#")
        return table["sca_ez_re"] + 1j * table["sca_ez_im"]


def timed(who, work, *arguments):
    clock, used = time.perf_counter(), cpu_seconds(who)
    answer = work(*arguments)
    return time.perf_counter() - clock, cpu_seconds(who) - used, answer


def main():
    level = int(sys.argv[1]) if len(sys.argv) > 1 else 4
    program = os.environ.get("FREDHOLM_PROGRAM", "target/release/fredholm")
    exact = series()

    def error(field):
        return np.linalg.norm(field - exact) / np.linalg.norm(exact)

    bempp.DEFAULT_DEVICE_INTERFACE = "numba"
    by_bempp(1)
    clock, used, (unknowns, field) = timed(resource.RUSAGE_SELF, by_bempp, level)
    bound = error(field)
    print(f"bempp-cl, {unknowns} unknowns: {100 * bound:.3f} %, {used:.1f} CPU s, {clock:.1f} s")
    for order, edges in EDGES_PER_WAVELENGTH.items():
        for fineness in edges:
            ours, ours_used, field = timed(resource.RUSAGE_CHILDREN, by_fredholm, program, order, fineness)
            reached = error(field)
            print(
                f"fredholm, order {order}, edges lambda/{fineness}: {100 * reached:.3f} %, {ours_used:.1f} CPU s, "
                f"{ours:.1f} s, {used / ours_used:.1f} times less"
            )
            if reached <= bound:
                break


if __name__ == "__main__":
    main()
