#!/usr/bin/env python3
"""Opens recordings repeatedly in Rerun viewers without a window, and compares the size at which the top appears.

    python3 openings.py COUNT VIEWER[,VIEWER…] FILE.rrd…

VIEWER is the binary `rerun` of a version (not the script of the same name). The size is the height of the top's warm
colours in the scene at the left. Exit code 1 if an opening differs by more than a third from the others of its file,
in any viewer. Needs Pillow, and a Vulkan driver such as Mesa's lavapipe.
"""
import base64
import json
import os
import socket
import subprocess
import sys
import tempfile
import time

from PIL import Image

SIZE = (1366, 768)
SCENE = (0, 80, 560, 480)  # Part of the window, where the scene is in all versions.
TOLERANCE = 0.35  # The run plays, so that the top moves; a wrong camera was 2.4 times too far away.
LOADING = 4  # s


def height(picture):
    """The height in pixels of what is warmer than a threshold."""
    scene = Image.open(picture).convert("RGB").resize(SIZE).crop(SCENE)
    rows = set()
    for index, (red, _, blue) in enumerate(scene.get_flattened_data()):
        if red > 110 and red > blue + 25:
            rows.add(index // scene.width)
    return max(rows) - min(rows) if rows else 0


class Control:
    """The MCP server of a viewer, which takes pictures of it. Its tools have other names since 0.41."""

    def __init__(self, viewer, env):
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.DEVNULL}
        self.process = subprocess.Popen([viewer, "viewer-mcp"], env=env, text=True, **pipes)
        client = {"name": "openings", "version": "1"}
        self.request("initialize", protocolVersion="2024-11-05", capabilities={}, clientInfo=client)
        self.send({"method": "notifications/initialized"})
        self.tools = [tool["name"] for tool in self.request("tools/list")["tools"]]

    def send(self, message):
        self.process.stdin.write(json.dumps({"jsonrpc": "2.0", **message}) + "\n")
        self.process.stdin.flush()

    def request(self, method, **params):
        self.send({"id": 1, "method": method, "params": params})
        while True:
            answer = json.loads(self.process.stdout.readline())
            if "result" in answer:
                return answer["result"]

    def call(self, tool, **arguments):
        return self.request("tools/call", name=tool, arguments=arguments)

    def connect(self, port):
        name = "connect" if "connect" in self.tools else "rerun_connect"
        for _ in range(100):
            if not self.call(name, endpoint=f"http://127.0.0.1:{port}").get("isError"):
                return
            time.sleep(0.3)

    def picture(self, path):
        if "screenshot" in self.tools:
            for content in self.call("screenshot")["content"]:
                if content["type"] == "image":
                    with open(path, "wb") as file:
                        file.write(base64.b64decode(content["data"]))
        else:
            self.call("rerun_save_screenshot", file_path=path, max_size=0)
            time.sleep(2)  # The answer comes before the picture.


def opening(viewer, recording):
    """The height of the top when a viewer opens a recording."""
    with socket.socket() as free, tempfile.TemporaryDirectory() as folder:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
        free.close()
        # A home of its own: nothing is left of earlier openings.
        env = dict(os.environ, HOME=folder, RUST_LOG="off", RERUN_ANALYTICS="0")
        command = [viewer, "--headless", "--bind", "127.0.0.1", "--port", str(port)]
        command += ["--window-size", f"{SIZE[0]}x{SIZE[1]}", recording]
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        window = subprocess.Popen(command, env=env, **quiet)
        control = Control(viewer, env)
        try:
            control.connect(port)
            time.sleep(LOADING)
            picture = os.path.join(folder, "opened.png")
            control.picture(picture)
            return height(picture)
        finally:
            for process in (control.process, window):
                process.terminate()
                process.wait()


def main():
    count, viewers, recordings = int(sys.argv[1]), sys.argv[2].split(","), sys.argv[3:]
    right = total = 0
    for recording in recordings:
        heights = {viewer: [opening(viewer, recording) for _ in range(count)] for viewer in viewers}
        every = sorted(height for some in heights.values() for height in some)
        middle = every[len(every) // 2]
        for viewer, some in heights.items():
            good = sum(abs(height - middle) <= TOLERANCE * middle for height in some)
            print(f"{recording}: {viewer}: {good} of {count}, heights {sorted(set(some))}")
            right, total = right + good, total + count
    print(f"{right} of {total} openings are alike")
    sys.exit(right < total)


if __name__ == "__main__":
    main()
