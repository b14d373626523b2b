// A screenshot of the page at a moment. usage: node picture.mjs URL FILE SECONDS
import { chromium } from "playwright-core";

const [url, file, seconds] = process.argv.slice(2);
const browser = await chromium.launch({ executablePath: "/usr/bin/chromium", args: ["--no-sandbox"] });
const page = await browser.newPage({ viewport: { width: 1500, height: 800 } });
await page.goto(url);
await page.waitForSelector("body.ready");
await page.click("#play"); // pauses
await page.locator("#time").evaluate((slider, seconds) => {
  slider.value = seconds;
  slider.dispatchEvent(new Event("input"));
}, seconds);
await page.waitForTimeout(500);
await page.screenshot({ path: file });
await browser.close();
