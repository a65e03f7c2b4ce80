"""A Dask scheduler, or a worker of some kind, as a process of its own: it prints a line when it is up.

Usage: python cluster_processes.py scheduler | python cluster_processes.py ADDRESS KIND
"""

import asyncio
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

from distributed import Scheduler, Worker


class Processes:
    """The processes of a cluster, in a folder of their own."""

    def __init__(self, folder):
        self._folder = folder
        self._started = []
        self.address = None
        self.scheduler = None

    def start_scheduler(self):
        self.scheduler, self.address = self._start("scheduler")

    def start_worker(self, kind="fit", **environment):
        """Start a worker, and return its process; `kind` says what is wrong with it."""
        return self._start(self.address, kind, **environment)[0]

    def end(self):
        """End them all."""
        for process in self._started:
            process.kill()
            process.communicate()

    def _start(self, *arguments, **environment):
        process = subprocess.Popen(
            [sys.executable, Path(__file__), *arguments],
            cwd=self._folder,
            env=os.environ | environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
        )
        self._started.append(process)
        return process, process.stdout.readline().strip()


def spoil(kind):
    """Make this worker's process one that is not fit for the work."""
    if kind == "without":
        sys.modules["motionedit"] = None
    elif kind == "elsewhere":  # as where the folders are others by the same names
        from motionedit.jobs.batch import one_clip

        one_clip.write_file = lambda _path, content: list(content)
    elif kind == "dying":
        from motionedit.jobs.batch.one_clip import RunOne

        usual = RunOne._run

        def die_of_c(self, task):
            if task.relative == "c.bvh":
                time.sleep(0.5)  # what was done before has arrived
                os._exit(1)
            return usual(self, task)

        RunOne._run = die_of_c


async def serve(address):
    """Say where a server is, and let it work until it is ended."""
    own = {"host": "127.0.0.1", "dashboard_address": ":0"}
    server = Scheduler(**own) if address == "scheduler" else Worker(address, nthreads=1, **own)
    async with server:
        print(server.address, flush=True)  # noqa: T201  to the test that started it
        await server.finished()


def main(address, kind=None):
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the client alone
    spoil(kind)
    asyncio.run(serve(address))


if __name__ == "__main__":
    main(*sys.argv[1:])
