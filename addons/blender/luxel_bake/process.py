"""luxel at work: the command, its events and its end. Knows nothing of Blender."""
import atexit
import collections
import json
import os
import shutil
import signal
import subprocess
import threading

STOPPED = 130  # luxel's exit code


class Stopped(RuntimeError):
    """The user has stopped the bake."""


def find_luxel(stated):
    """The program to run. Raises ValueError: there is none."""
    found = shutil.which(os.path.expanduser(stated) or "luxel")
    if found is None:
        raise ValueError(f"'{stated}' was not found; set the path of luxel in the add-on's preferences")
    return found


class Bake:
    """A bake in a process of its own. What it says is read by threads, so that nobody waits for it."""

    def __init__(self, luxel, arguments):
        self.stage, self.share, self.seconds_left = "", None, None
        self.notes, self.warnings, self.error = collections.deque(maxlen=20), [], None
        self._output, self._is_cancelled = b"", False
        # Ctrl-C in Blender's terminal is for Blender.
        self._process = subprocess.Popen([luxel, "bake", *arguments, "--json", "--progress-json"],
                                         stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                         start_new_session=True)
        atexit.register(self.cancel)
        self._threads = [threading.Thread(target=self._read_events, daemon=True),
                         threading.Thread(target=self._read_output, daemon=True)]
        for thread in self._threads:
            thread.start()

    def _read_events(self):
        for line in self._process.stderr:
            try:
                event = json.loads(line)
            except ValueError:
                event = None
            if isinstance(event, dict):
                self._take(event)
            else:
                self.notes.append(line.decode(errors="replace").strip())

    def _take(self, event):
        kind = event.get("event")
        if kind == "progress":
            self.stage, self.share, self.seconds_left = event["stage"], event["overall"], event["seconds_left"]
        elif kind == "warning":
            self.warnings.append(event["message"])
        elif kind == "error":
            self.error = event["message"]
        elif kind in ("note", "resumable"):
            self.notes.append(event["message"])

    def _read_output(self):
        self._output = self._process.stdout.read()

    def is_over(self):
        return self._process.poll() is not None

    def cancel(self):
        """Asks it to stop, which takes a second at most."""
        if not self.is_over():
            self._is_cancelled = True
            self._process.send_signal(signal.SIGINT if os.name == "posix" else signal.SIGTERM)

    def finish(self):
        """bake.json, once it is over. Raises Stopped, or RuntimeError with luxel's sentence where it failed."""
        code = self._process.wait()
        atexit.unregister(self.cancel)
        for thread in self._threads:
            thread.join()
        if code == STOPPED or (code != 0 and self._is_cancelled):
            raise Stopped("The bake was stopped")
        if code != 0:
            raise RuntimeError(self.error or (self.notes[-1] if self.notes else f"luxel ended with code {code}"))
        return json.loads(self._output)


def text_of_time(seconds):
    """'12 s', '3:05 min', '1:02 h'."""
    whole = int(seconds + 0.5)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60}:{whole % 60:02d} min"
    return f"{whole // 3600}:{whole // 60 % 60:02d} h"


def text_of_progress(stage, share, seconds_left):
    """'trace rays, 42 %, 12 s left'."""
    text = stage or "start"
    if share is not None:
        text += f", {100 * share:.0f} %"
    if seconds_left is not None:
        text += f", {text_of_time(seconds_left)} left"
    return text
