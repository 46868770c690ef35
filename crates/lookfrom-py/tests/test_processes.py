"""Threads, forks, pickles, signals and memory."""

import copy
import multiprocessing
import os
import pickle
import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from lookfrom import Bvh, Instance, Spheres
from meshes import icosphere

VERTICES, FACES = icosphere(5)
RNG = np.random.default_rng(1)
ORIGINS, DIRECTIONS = RNG.normal(size=(20_000, 3)), RNG.normal(size=(20_000, 3))


def answer(bvh):
    return bvh.closest_hits(ORIGINS, DIRECTIONS).t.sum(
        where=np.isfinite(bvh.closest_hits(ORIGINS, DIRECTIONS).t)
    )


def build_and_answer(bvh):
    """What a child process does: with a tree that came to it, and with a new one, which is large enough for several threads."""
    return answer(bvh or INHERITED), answer(Bvh(VERTICES, FACES))


INHERITED = Bvh(VERTICES, FACES)


@pytest.mark.parametrize("method", ["fork", "spawn", "forkserver"])
def test_child_processes(method):
    if method not in multiprocessing.get_all_start_methods():
        pytest.skip(f"no {method} here")
    bvh = Bvh(VERTICES, FACES)
    expected = answer(bvh), answer(bvh)
    context = multiprocessing.get_context(method)
    with context.Pool(2) as pool:
        for arguments in ([bvh] * 4, [None] * 4):
            # In time: a child that waits for threads that the fork has lost would wait for ever.
            assert pool.map_async(build_and_answer, arguments).get(timeout=120) == [expected] * 4


def test_a_fork_while_threads_are_at_work():
    if not hasattr(os, "fork"):
        pytest.skip("no fork here")
    bvh, stop = Bvh(VERTICES, FACES), threading.Event()

    def work():
        while not stop.is_set():
            bvh.closest_hits(ORIGINS, DIRECTIONS)
            Bvh(VERTICES, FACES)

    threads = [threading.Thread(target=work) for _ in range(2)]
    for thread in threads:
        thread.start()
    try:
        context = multiprocessing.get_context("fork")
        for _ in range(5):
            child = context.Process(target=build_and_answer, args=(None,))
            child.start()
            child.join(timeout=60)
            assert child.exitcode == 0
    finally:
        stop.set()
        for thread in threads:
            thread.join()


def test_threads_share_a_tree_and_refit_it():
    bvh = Bvh(VERTICES, FACES)
    expected = {answer(bvh), answer(Bvh(2 * VERTICES, FACES))}

    def work(number):
        if number % 4 == 0:
            bvh.refit(VERTICES * (1 + number // 4 % 2))
        return bvh.closest_hits(ORIGINS, DIRECTIONS).t

    with ThreadPoolExecutor(8) as pool:
        for t in pool.map(work, range(64)):
            assert t.sum(where=np.isfinite(t)) in expected


def test_the_gil_is_released():
    bvh = Bvh(VERTICES, FACES)
    many = np.broadcast_to((0.0, 0.0, 0.0), (2_000_000, 3)), np.broadcast_to((1.0, 2.0, 3.0), (2_000_000, 3))
    counted, done = [0], threading.Event()

    def count():
        while not done.is_set():
            counted[0] += 1
            time.sleep(1e-4)

    thread = threading.Thread(target=count)
    thread.start()
    try:
        time.sleep(0.01)
        before = counted[0]
        bvh.closest_hits(*many, threads=1)
        assert counted[0] > before + 5
    finally:
        done.set()
        thread.join()


def test_ctrl_c_stops():
    script = """
import numpy as np, lookfrom, sys
sys.path.insert(0, {folder!r})
from meshes import icosphere
bvh = lookfrom.Bvh(*icosphere(6))
many = np.broadcast_to((0.1, 0.2, 0.3), (3_000_000, 3))
print("ready", flush=True)
try:
    for _ in range(1000):
        bvh.closest_points(many)
except KeyboardInterrupt:
    print("stopped", flush=True)
"""
    command = [sys.executable, "-c", script.format(folder=os.path.dirname(__file__))]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as child:
        assert child.stdout is not None and child.stdout.readline() == "ready\n"
        time.sleep(0.5)
        sent = time.monotonic()
        child.send_signal(signal.SIGINT)
        assert child.stdout.readline() == "stopped\n"
        assert time.monotonic() - sent < 2


def test_pickles_and_copies():
    ball = Bvh(VERTICES, FACES, masks=5, quality="best")
    place = np.diag([2.0, 3.0, 4.0, 1.0])
    for bvh in (ball, Bvh.from_geometries([Instance(ball, place, mask=6), Spheres([(0, 0, 9)], 1.0)])):
        for other in (pickle.loads(pickle.dumps(bvh)), copy.copy(bvh), copy.deepcopy(bvh)):
            for mask in (None, 1, 2):
                one, two = (b.closest_hits(ORIGINS, DIRECTIONS, mask=mask) for b in (bvh, other))
                assert (one.t == two.t).all() and (one.primitive == two.primitive).all()
    other = copy.copy(ball)
    other.refit(2 * VERTICES)
    assert ball.bounds[1, 0] < 1.1 < other.bounds[1, 0]


def resident():
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def make_trees(count):
    vertices, faces = icosphere(2)
    rays = DIRECTIONS[:50]
    for _ in range(count):
        bvh = Bvh(vertices, faces)
        hits = bvh.all_hits((0, 0, 0), rays)
        assert len(hits.points) >= 50
        bvh.refit(1.01 * vertices)
        pickle.dumps(bvh)


def test_many_trees_leave_memory_flat():
    # LOOKFROM_TREES=100000 makes as many.
    if not os.path.exists("/proc/self/statm"):
        pytest.skip("no /proc here")
    count = int(os.environ.get("LOOKFROM_TREES", "2000"))
    make_trees(count // 10)
    before = resident()
    make_trees(count)
    after = resident()
    print(f"{count} trees: {before / 1e6:.1f} MB before, {after / 1e6:.1f} MB after")
    assert after < 1.01 * before
