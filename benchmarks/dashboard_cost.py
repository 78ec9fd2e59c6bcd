#!/usr/bin/env python3
"""What the page's data stream costs: the processor time of `metier dashboard` while the three arms of
the demo cell move, without a tab and with one and more.

  benchmarks/dashboard_cost.py build/release/apps/metier/metier [--tabs 0,1,3] [--laps 3] [--cell FILE]
"""
import argparse
import http.client
import json
import os
import subprocess
import tempfile
import threading
import time

HERE = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
CELL = os.path.join(HERE, "cells", "demo.toml")


class Tab(threading.Thread):
    """Reads a stream to its end."""

    def __init__(self, port):
        super().__init__(daemon=True)
        self.connection = http.client.HTTPConnection("127.0.0.1", port, timeout=30)
        self.connection.request("GET", "/api/stream")
        self.answer = self.connection.getresponse()
        self.bytes = 0
        self.live = 0
        self.socket = self.connection.sock
        self.start()

    def run(self):
        try:
            while line := self.answer.readline():
                self.bytes += len(line)
                self.live += line.startswith(b"event: live")
        except (OSError, ValueError, http.client.HTTPException):
            pass


def cpu_seconds(pid):
    with open(f"/proc/{pid}/stat", encoding="ascii") as stat:
        fields = stat.read().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def ready_line(process, begin):
    for line in process.stdout:
        if line.startswith(begin):
            return line.strip()
    raise SystemExit(f"dashboard_cost: {process.args[1:]} ended without '{begin}'")


def get(port, path):
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=30)
    connection.request("GET", path)
    return json.load(connection.getresponse())


def await_servers(port):
    deadline = time.monotonic() + 60
    while not all(server["connected"] for server in get(port, "/api/cell")["servers"]):
        if time.monotonic() > deadline:
            raise SystemExit("dashboard_cost: the page does not reach all servers")
        time.sleep(0.2)


def measure(page, port, urls, options, tabs):
    open_tabs = [Tab(port) for _ in range(tabs)]
    processor = cpu_seconds(page.pid)
    begun = time.monotonic()
    laps = subprocess.run([options.metier, "--insecure-lab", "square", *urls, "--laps", str(options.laps)], text=True,
                          cwd=options.folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
    if laps.returncode != 0:
        raise SystemExit(f"dashboard_cost: the arms were not driven:\n{laps.stdout}")
    seconds = time.monotonic() - begun
    used = cpu_seconds(page.pid) - processor
    for tab in open_tabs:
        tab.socket.shutdown(2)
        tab.join()
    live = sum(tab.live for tab in open_tabs) / max(1, tabs) / seconds
    size = sum(tab.bytes for tab in open_tabs) / max(1, tabs) / seconds / 1000
    print(f"{tabs:5} {seconds:9.1f} {used:9.2f} {100 * used / seconds:9.2f} {live:9.1f} {size:9.1f}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("metier", help="the program")
    parser.add_argument("--tabs", default="0,1,3", help="runs with so many tabs")
    parser.add_argument("--laps", type=int, default=3, help="of each arm around its square")
    parser.add_argument("--cell", default=CELL, help="with the servers ur5-move, iiwa and edo-move")
    options = parser.parse_args()
    options.metier = os.path.abspath(options.metier)
    options.cell = os.path.abspath(options.cell)
    with tempfile.TemporaryDirectory() as folder:
        options.folder = folder
        endpoints = os.path.join(folder, "endpoints.json")
        started = []

        def start(*arguments):
            started.append(subprocess.Popen([options.metier, "--insecure-lab", *arguments], text=True,
                                            stdout=subprocess.PIPE, stderr=subprocess.DEVNULL))
            return started[-1]

        try:
            ready_line(start("up", options.cell, "--free-ports", "--endpoints", endpoints), "the cell is up")
            with open(endpoints, encoding="utf-8") as file:
                urls = {one["name"]: one["url"] for one in json.load(file)["servers"]}
            page = start("dashboard", "--cell", options.cell, "--endpoints", endpoints, "--port", "0", "--records", "off")
            port = int(ready_line(page, "ready http://").rsplit(":", 1)[1])
            await_servers(port)
            print(" tabs    time/s     cpu/s  % of core    live/s      kB/s  (of the page's process; per tab)")
            for tabs in map(int, options.tabs.split(",")):
                measure(page, port, [urls["ur5-move"], urls["iiwa"], urls["edo-move"]], options, tabs)
        finally:
            for process in reversed(started):
                process.terminate()
                process.wait()


if __name__ == "__main__":
    main()
