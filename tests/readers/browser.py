"""browser.py URL [PICTURE]: opens Rerun's web viewer in headless Chromium and looks whether it draws.

Needs `pip install playwright pillow` and a Chromium (`playwright install chromium`, or the system's).
Exit code 0 if the page shows something with many colours within a minute.
"""

import io
import shutil
import sys
import time

from PIL import Image
from playwright.sync_api import sync_playwright

# There is no graphics card: WebGL in software.
ARGUMENTS = [
    "--no-sandbox",
    "--use-angle=swiftshader",
    "--use-gl=angle",
    "--enable-unsafe-swiftshader",
    "--ignore-gpu-blocklist",
]


def colors(png):
    image = Image.open(io.BytesIO(png)).convert("RGB")
    # The left half shows the scene.
    scene = image.crop((0, 100, image.width * 2 // 5, image.height * 2 // 3))
    return len(scene.getcolors(maxcolors=1 << 24))


def main(url, picture=None):
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=shutil.which("chromium"), args=ARGUMENTS
        )
        page = browser.new_page(viewport={"width": 1600, "height": 1000})
        page.goto(url + "&renderer=webgl")
        deadline = time.time() + 90
        found = 0
        # The welcome screen has few colours, the lit top over 2000.
        while found < 1000 and time.time() < deadline:
            page.wait_for_timeout(2000)
            png = page.screenshot(timeout=120_000)
            found = colors(png)
        if picture:
            with open(picture, "wb") as file:
                file.write(png)
        browser.close()
    print(found, "colours")
    sys.exit(0 if found >= 1000 else 1)


main(*sys.argv[1:])
