#!/usr/bin/env python3
"""Times of `lookfrom view`, and its memory over many reloads: docs/benchmarks/view.py LOOKFROM SCENE [RELOADS]

Needs Python alone: the WebSocket is a few lines here. RELOADS edits a copy of a .toml scene that many times.
"""

import base64
import json
import os
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time
from statistics import median


class Page:
    """A window without a browser."""

    def __init__(self, url):
        host, self.token = url.removeprefix("http://").split("/?token=")
        name, port = host.split(":")
        self.socket = socket.create_connection((name, int(port)))
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        key = base64.b64encode(os.urandom(16)).decode()
        self.socket.sendall(
            f"GET /socket?token={self.token} HTTP/1.1\r\nHost: {host}\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
            f"Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: {key}\r\n\r\n".encode()
        )
        self.file = self.socket.makefile("rb")
        while self.file.readline().strip():
            pass

    def say(self, **message):
        data = json.dumps(message).encode()
        length = bytes([0x80 | len(data)]) if len(data) < 126 else bytes([0xFE]) + struct.pack(">H", len(data))
        mask = os.urandom(4)
        self.socket.sendall(b"\x81" + length + mask + bytes(b ^ mask[i % 4] for i, b in enumerate(data)))

    def hear(self):
        """A message, or the header of a frame."""
        opcode, length = self.file.read(2)
        if length == 126:
            (length,) = struct.unpack(">H", self.file.read(2))
        elif length == 127:
            (length,) = struct.unpack(">Q", self.file.read(8))
        data = self.file.read(length)
        if opcode & 15 == 1:
            return json.loads(data)
        (header,) = struct.unpack("<I", data[:4])
        return json.loads(data[4 : 4 + header])

    def until(self, wanted):
        while True:
            heard = self.hear()
            if heard.get("type") == "error":
                sys.exit(f"error: {heard}")
            if wanted(heard):
                return heard


def view(page, number, camera=None, moving=False, **more):
    page.say(type="view", id=number, camera=camera, size=[960, 540], moving=moving, **more)


def picture_of(number):
    return lambda heard: heard.get("kind") == "picture" and heard["view"] == number


def resident(process):
    with open(f"/proc/{process.pid}/status") as status:
        return next(int(line.split()[1]) for line in status if line.startswith("VmRSS"))


def times(lookfrom, scene):
    started = time.monotonic()
    process = subprocess.Popen([lookfrom, "view", scene], stdout=subprocess.PIPE, text=True)
    page = Page(process.stdout.readline().strip())
    print(f"{scene}\n  page after {1000 * (time.monotonic() - started):.0f} ms")
    found = page.until(lambda heard: heard.get("type") == "scene")
    print(f"  read and built after {1000 * (time.monotonic() - started):.0f} ms: {found['counts']['triangles']} triangles, {found['integrator']}")
    view(page, 1)
    page.until(picture_of(1))
    print(f"  first picture after {1000 * (time.monotonic() - started):.0f} ms")
    page.until(lambda heard: picture_of(1)(heard) and heard["scale"] == 1)
    print(f"  first whole picture of 960 × 540 after {1000 * (time.monotonic() - started):.0f} ms")
    camera = {key: found["camera"][key] for key in ("lookfrom", "lookat", "up", "fov")}
    distance = [a - b for a, b in zip(camera["lookfrom"], camera["lookat"])]
    waits, scales = [], []
    for step in range(60):
        camera["lookfrom"] = [b + (1 + 0.005 * step) * d for b, d in zip(camera["lookat"], distance)]
        moved = time.monotonic()
        view(page, 2 + step, camera, True)
        scales.append(page.until(picture_of(2 + step))["scale"])
        waits.append(1000 * (time.monotonic() - moved))
    waits.sort()
    print(f"  from a move to its coarse picture: {median(waits):.0f} ms, at most {waits[-1]:.0f} ms; scale {median(scales):.0f}")
    moved = time.monotonic()
    view(page, 100, camera)
    page.until(lambda heard: picture_of(100)(heard) and heard["scale"] == 1)
    print(f"  from the end of the move to the first whole picture: {1000 * (time.monotonic() - moved):.0f} ms")
    moved = time.monotonic()
    view(page, 101, camera, exposure=1.0)
    page.until(picture_of(101))
    print(f"  another exposure: {1000 * (time.monotonic() - moved):.0f} ms")
    moved = time.monotonic()
    page.say(type="space", id=5, camera=camera, size=[960, 540])
    page.until(lambda heard: heard.get("kind") == "space")
    print(f"  the scene in 3D, 960 × 540: {1000 * (time.monotonic() - moved):.0f} ms")
    process.send_signal(signal.SIGINT)
    print(f"  exit code {process.wait()}")


def reloads(lookfrom, scene, count):
    with open(scene) as file, tempfile.TemporaryDirectory() as folder:
        text, copy = file.read(), os.path.join(folder, "scene.toml")
        write = lambda number: open(copy, "w").write(f"{text}\n# {number}\n")
        write(0)
        process = subprocess.Popen([lookfrom, "view", copy], stdout=subprocess.PIPE, text=True)
        page = Page(process.stdout.readline().strip())
        for generation in range(1, count + 1):
            page.until(lambda heard: heard.get("type") == "scene" and heard["generation"] == generation)
            page.say(type="view", id=generation, size=[320, 180])
            page.until(lambda heard: picture_of(generation)(heard) and heard["scale"] == 1)
            if generation in (1, 10, 100) or generation % 250 == 0:
                print(f"  {generation} scenes read: {resident(process) / 1024:.0f} MB")
            write(generation)
        process.send_signal(signal.SIGINT)
        process.wait()


if __name__ == "__main__":
    times(sys.argv[1], sys.argv[2])
    if len(sys.argv) > 3:
        reloads(sys.argv[1], sys.argv[2], int(sys.argv[3]))
