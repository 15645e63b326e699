"""A headless Chromium, driven through chromedriver (W3C WebDriver), with nothing but Python's own library."""

import base64
import json
import os
import shutil
import subprocess
import tempfile
import time
import urllib.error
import urllib.request

CHROMIUM, DRIVER = shutil.which("chromium"), shutil.which("chromedriver")
PATIENCE = 120 # s
# As on a computer without a GPU: WebGL by SwiftShader, and pages composed without it. Chromium's own traffic is switched off:
# the tests do not need it.
ARGUMENTS = ["--headless=new", "--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking",
	"--disable-component-update", "--disable-sync", "--disable-gpu", "--enable-unsafe-swiftshader",
	"--disable-dev-shm-usage", "--hide-scrollbars"]

COPIES = "GPU stall due to ReadPixels" # Chromium's own remark on copying a picture, as it must without a GPU


class Driver:
	"""chromedriver: opens browsers."""

	def __init__(self):
		self.open = set() # browsers, which would outlive the driver
		self.dir = tempfile.mkdtemp(prefix="obsim-browser-")
		self.log = os.path.join(self.dir, "log")
		with open(self.log, "wb") as log:
			self.process = subprocess.Popen([DRIVER, "--port=0"], stdout=log, stderr=log)
		end = time.monotonic() + PATIENCE
		self.port = None
		while not self.port and time.monotonic() < end and self.process.poll() is None:
			with open(self.log) as log:
				for line in log:
					if "started successfully on port" in line:
						self.port = int(line.rsplit(" ", 1)[1].strip(" .\n"))
			time.sleep(.05)
		if not self.port:
			raise RuntimeError("chromedriver does not start: " + open(self.log).read())
		self.base = f"http://127.0.0.1:{self.port}"

	def ask(self, method, path, body=None):
		request = urllib.request.Request(self.base + path, json.dumps(body).encode() if body is not None else None,
			{"Content-Type": "application/json"}, method=method)
		try:
			with urllib.request.build_opener(urllib.request.ProxyHandler({})).open(request, timeout=PATIENCE) as answer:
				return json.load(answer)["value"]
		except urllib.error.HTTPError as error:
			raise RuntimeError(json.load(error)["value"]["message"]) from None

	def end(self):
		for b in list(self.open):
			b.close()
		self.process.terminate()
		self.process.wait(PATIENCE)
		shutil.rmtree(self.dir, ignore_errors=True)


class Browser:
	"""A window of its own."""

	def __init__(self, driver, width=960, height=640):
		self.driver = driver
		profile = tempfile.mkdtemp(dir=driver.dir)
		options = {"binary": CHROMIUM, "args": ARGUMENTS + [f"--window-size={width},{height}", f"--user-data-dir={profile}"]}
		session = driver.ask("POST", "/session", {"capabilities": {"alwaysMatch": {"browserName": "chrome",
			"goog:chromeOptions": options, "goog:loggingPrefs": {"browser": "ALL"}}}})
		self.path = "/session/" + session["sessionId"]
		driver.open.add(self)

	def ask(self, method, path, body=None):
		return self.driver.ask(method, self.path + path, body)

	def go(self, url):
		self.ask("POST", "/url", {"url": url})

	def run(self, script, *args):
		return self.ask("POST", "/execute/sync", {"script": script, "args": list(args)})

	def devtools(self, command, **words):
		"""A command of Chromium's own protocol."""
		return self.ask("POST", "/goog/cdp/execute", {"cmd": command, "params": words})

	def wait(self, expression, patience=PATIENCE):
		"""Waits until the expression is true; returns its value."""
		end = time.monotonic() + patience
		while True:
			value = self.run(f"return {expression}")
			if value:
				return value
			if time.monotonic() > end:
				raise AssertionError(f"never true: {expression}; console: {self.console()}")
			time.sleep(.1)

	def pointer(self, *steps):
		"""Mouse: ("move", x, y), ("down", button), ("up", button) ..."""
		actions = []
		for step in steps:
			if step[0] == "move":
				actions.append({"type": "pointerMove", "duration": 50, "x": int(step[1]), "y": int(step[2])})
			else:
				actions.append({"type": "pointerDown" if step[0] == "down" else "pointerUp", "button": step[1]})
		self.ask("POST", "/actions", {"actions": [{"type": "pointer", "id": "mouse", "actions": actions}]})

	def click(self, x, y):
		self.pointer(("move", x, y), ("down", 0), ("up", 0))

	def touch(self, *fingers):
		"""Fingers that go down together, and their paths: each a list of places (x, y); one with fewer places
		goes up sooner."""
		def way(places):
			steps = [{"type": "pointerMove", "duration": 0 if i == 0 else 50, "x": int(x), "y": int(y)} for i, (x, y) in enumerate(places)]
			return [steps[0], {"type": "pointerDown", "button": 0}, *steps[1:], {"type": "pointerUp", "button": 0}]
		self.ask("POST", "/actions", {"actions": [{"type": "pointer", "id": f"finger {i}", "parameters": {"pointerType": "touch"},
			"actions": way(places)} for i, places in enumerate(fingers)]})

	def key(self, key):
		self.ask("POST", "/actions", {"actions": [{"type": "key", "id": "keys", "actions": [
			{"type": "keyDown", "value": key}, {"type": "keyUp", "value": key}]}]})

	def picture(self, path=None):
		end = time.monotonic() + PATIENCE
		while True:
			try:
				png = base64.b64decode(self.ask("GET", "/screenshot"))
				break
			except RuntimeError as error: # without a GPU, and among other tests, a frame may take longer than the driver waits
				if "timeout" not in str(error) or time.monotonic() > end:
					raise
		if path:
			with open(path, "wb") as f:
				f.write(png)
		return png

	def console(self):
		return [entry["message"] for entry in self.ask("POST", "/se/log", {"type": "browser"})
			if entry["level"] in ("SEVERE", "WARNING") and COPIES not in entry["message"]]

	def close(self):
		if self in self.driver.open:
			self.driver.open.discard(self)
			self.ask("DELETE", "")
