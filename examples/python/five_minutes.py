"""The Cornell box to 1 %: `python examples/python/five_minutes.py`, from the folder of the
repository."""

from pathlib import Path

import fredholm


def main() -> None:
    scene = fredholm.Scene.load("scenes/cornell_planar.toml")
    solution = scene.solve(accuracy=0.01)
    print(solution)
    for light in solution:
        print(f"{light.name:>16}: {light.irradiance.mean():8.4f} ± {light.error.mean():.4f} W/m²")
    folder = Path("out") / "cornell"
    solution.write(folder)
    (folder / "small.png").write_bytes(solution.picture(width=300))
    print(f"written to {folder}")


if __name__ == "__main__":
    main()
