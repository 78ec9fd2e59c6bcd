#!/usr/bin/env python3
"""How far an arm presses into a wall before a force stops it: by the arm's own force move, which watches the
sensor in its cycle, and by a component that halts the line over OPC UA, one after the other in cells/force_move.toml.

  benchmarks/force_reaction.py build/release/apps/metier/metier [--rounds 20] [--speed 0.05]
"""
import argparse
import json
import statistics
import subprocess
import tempfile
from pathlib import Path

CELL = Path(__file__).resolve().parents[1] / "cells" / "force_move.toml"
WALL = 0.6  # m, along -x of the base frame
STIFFNESS = 5000.0  # N/m
LIMIT = 20.0  # N
BACK = 0.1  # m


class Cell:
    """The processes of the cell."""

    def __init__(self, program: str, folder: str):
        self.lab = [program, "--insecure-lab"]
        endpoints = Path(folder) / "endpoints.json"
        self.process = subprocess.Popen(
            [*self.lab, "up", str(CELL), "--free-ports", "--endpoints", str(endpoints)], stdout=subprocess.PIPE, text=True)
        for line in self.process.stdout:
            if line.startswith("the cell is up"):
                break
        servers = json.loads(endpoints.read_text(encoding="utf-8"))["servers"]
        self.url = {server["name"]: server["url"] for server in servers}

    def run(self, server: str, skill: str, **parameters) -> dict:
        given = [part for name, value in parameters.items() for part in ("--set", f"{name}={value}")]
        ran = subprocess.run([*self.lab, "run", self.url[server], skill, "--json", "--set", "Relative=1", *given],
                             capture_output=True, text=True, check=True)
        return json.loads(ran.stdout[ran.stdout.index("{"):])

    def end(self) -> None:
        self.process.terminate()
        self.process.wait(30)


def press(cell: Cell, server: str, speed: float) -> tuple[float, dict]:
    """Moves against the wall and back.

    Returns how much farther than the limit needs the arm stood in the wall [mm], and the results of the move.
    """
    results = cell.run(server, "CartesianLinearForceMoveSkill", TargetPosition=f"{-BACK},0,0,0,0,0",
                       MaxForce=f"{LIMIT},0,0", SpeedOverride=speed)
    back = cell.run("ur5", "CartesianLinearMoveSkill", TargetPosition=f"{BACK},0,0,0,0,0")
    stood = back["ReachedPose"]["x"] - BACK
    return 1000 * (-WALL - LIMIT / STIFFNESS - stood), results


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("metier")
    parser.add_argument("--rounds", type=int, default=20)
    parser.add_argument("--speed", type=float, default=0.05, help="SpeedOverride of the moves")
    options = parser.parse_args()
    farther: dict[str, list[float]] = {"ur5": [], "press": []}
    times: dict[str, list[float]] = {"ReactionTime": [], "StoppingTime": []}
    with tempfile.TemporaryDirectory() as folder:
        cell = Cell(options.metier, folder)
        try:
            for _ in range(options.rounds):
                for server, all_of_it in farther.items():
                    distance, results = press(cell, server, options.speed)
                    all_of_it.append(distance)
                    if server == "press":
                        for name, seen in times.items():
                            seen.append(1000 * results[name])
        finally:
            cell.end()
    own, component = farther["ur5"], farther["press"]
    print(f"beyond {LIMIT:.0f} N      median    largest")
    print(f"the arm's own    {statistics.median(own):6.2f} mm {max(own):6.2f} mm")
    print(f"the component    {statistics.median(component):6.2f} mm {max(component):6.2f} mm"
          f"   ratio {statistics.median(component) / statistics.median(own):.2f}")
    for name, seen in times.items():
        print(f"{name:16} {statistics.median(seen):6.1f} ms {max(seen):6.1f} ms")


if __name__ == "__main__":
    main()
