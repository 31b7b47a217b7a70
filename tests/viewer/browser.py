"""Debian's Chromium without a window, driven through --remote-debugging-pipe (NUL-separated JSON on descriptors 3 and
4), by the standard library alone. It has a profile of its own that goes away with it, and reaches this machine
alone."""
import base64
import fcntl
import json
import os
import select
import shutil
import signal
import subprocess
import tempfile
import time

NAMES = ['chromium', 'chromium-browser', 'google-chrome']
KEYS = {  # key: (code, virtual key, text)
    'Enter': ('Enter', 13, '\r'), 'Tab': ('Tab', 9, ''), 'Escape': ('Escape', 27, ''), ' ': ('Space', 32, ' '),
    'ArrowLeft': ('ArrowLeft', 37, ''), 'ArrowUp': ('ArrowUp', 38, ''), 'ArrowRight': ('ArrowRight', 39, ''),
    'ArrowDown': ('ArrowDown', 40, ''), 'Home': ('Home', 36, ''), 'End': ('End', 35, ''),
    'Shift': ('ShiftLeft', 16, ''), '?': ('Slash', 191, '?'), '[': ('BracketLeft', 219, '['),
    ']': ('BracketRight', 221, ']'),
}
SHIFT = 8


def program():
    """Chromium's path, or None."""
    return next((path for path in map(shutil.which, NAMES) if path), None)


def scale():
    """How much longer things may take: programs under sanitizers are slow."""
    return float(os.environ.get('NOC_TEST_SCALE', '1'))


class Failure(Exception):
    pass


class Browser:
    """One Chromium. Pages of it are tabs."""

    def __init__(self):
        self.profile = tempfile.mkdtemp(prefix='nocturne-chromium-')
        to_read, self.to = os.pipe()
        self.come, to_write = os.pipe()

        def descriptors():
            ends = [fcntl.fcntl(end, fcntl.F_DUPFD, 10) for end in (to_read, to_write)]
            os.dup2(ends[0], 3)
            os.dup2(ends[1], 4)

        arguments = ['--headless=new', '--remote-debugging-pipe', f'--user-data-dir={self.profile}', '--no-first-run',
                     '--no-default-browser-check', '--disable-gpu', '--disable-dev-shm-usage', '--disable-extensions',
                     '--disable-background-networking', '--disable-component-update', '--disable-sync',
                     '--disable-breakpad', '--mute-audio', '--hide-scrollbars', '--no-proxy-server',
                     '--disable-features=MediaRouter,OptimizationHints,Translate',
                     '--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1']
        if os.geteuid() == 0:
            arguments.append('--no-sandbox')  # Chromium has none as root
        environment = dict(os.environ, HOME=self.profile, XDG_CONFIG_HOME=self.profile, XDG_CACHE_HOME=self.profile)
        for name in ('LD_PRELOAD', 'ASAN_OPTIONS', 'UBSAN_OPTIONS', 'LSAN_OPTIONS'):
            environment.pop(name, None)
        self.process = subprocess.Popen([program(), *arguments], preexec_fn=descriptors, pass_fds=(3, 4),
                                        stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                        stderr=subprocess.DEVNULL, env=environment, start_new_session=True)
        os.close(to_read)
        os.close(to_write)
        self.rest = b''
        self.number = 0
        self.events = {}  # session -> function

    def close(self):
        try:
            os.killpg(self.process.pid, signal.SIGKILL)
        except ProcessLookupError:
            pass
        self.process.wait()
        os.close(self.to)
        os.close(self.come)
        shutil.rmtree(self.profile, ignore_errors=True)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def call(self, method, session=None, limit=30, **parameters):
        """Calls, and returns the result; events that come meanwhile go to their pages."""
        self.number += 1
        number = self.number
        message = {'id': number, 'method': method, 'params': parameters}
        if session:
            message['sessionId'] = session
        data = json.dumps(message).encode() + b'\0'
        while data:
            data = data[os.write(self.to, data):]
        end = time.monotonic() + limit * scale()
        while True:
            answer = self._next(end)
            if answer is None:
                raise Failure(f'{method}: no answer in {limit} s')
            if answer.get('id') == number:
                if 'error' in answer:
                    raise Failure(f"{method}: {answer['error'].get('message')}")
                return answer['result']

    def listen(self, seconds):
        """Takes events for so long."""
        end = time.monotonic() + seconds
        while self._next(end) is not None:
            pass

    def _next(self, end):
        while b'\0' not in self.rest:
            left = end - time.monotonic()
            if left <= 0 or not select.select([self.come], [], [], left)[0]:
                return None
            data = os.read(self.come, 1 << 20)
            if not data:
                raise Failure('Chromium ended')
            self.rest += data
        line, self.rest = self.rest.split(b'\0', 1)
        message = json.loads(line)
        if 'method' in message and message.get('sessionId') in self.events:
            self.events[message['sessionId']](message['method'], message['params'])
        return message

    def page(self, url, width=1280, height=720, phone=False):
        return Page(self, url, width, height, phone)


class Page:
    """A tab. What its console says of errors is in `errors`."""

    def __init__(self, browser, url, width, height, phone):
        self.browser = browser
        self.errors = []
        self.downloads = tempfile.mkdtemp(prefix='nocturne-downloads-', dir=browser.profile)
        context = browser.call('Target.createBrowserContext')['browserContextId']
        self.target = browser.call('Target.createTarget', url='about:blank', browserContextId=context)['targetId']
        self.session = browser.call('Target.attachToTarget', targetId=self.target, flatten=True)['sessionId']
        browser.events[self.session] = self._event
        browser.call('Browser.setDownloadBehavior', behavior='allow', browserContextId=context,
                     downloadPath=self.downloads)
        for domain in ('Page', 'Runtime', 'Log'):
            self.call(f'{domain}.enable')
        self.viewport(width, height, phone)
        self.go(url)

    def call(self, method, **parameters):
        return self.browser.call(method, self.session, **parameters)

    def _event(self, method, parameters):
        if method == 'Runtime.exceptionThrown':
            details = parameters['exceptionDetails']
            self.errors.append(details.get('exception', {}).get('description') or details.get('text'))
        elif method == 'Runtime.consoleAPICalled' and parameters['type'] in ('error', 'assert'):
            self.errors.append(' '.join(str(one.get('value', one.get('description'))) for one in parameters['args']))
        elif method == 'Log.entryAdded' and parameters['entry']['level'] == 'error':
            entry = parameters['entry']
            self.errors.append(f"{entry['text']} {entry.get('url', '')}")

    def go(self, url):
        self.call('Page.navigate', url=url)

    def reload(self):
        """Returns when the old document has gone."""
        self.evaluate('(globalThis.old = true)')
        self.call('Page.reload')
        self.wait('!globalThis.old')

    def close(self):
        self.browser.call('Target.closeTarget', targetId=self.target)

    def viewport(self, width, height, phone=False, density=None):
        self.call('Emulation.setDeviceMetricsOverride', width=width, height=height, mobile=phone,
                  deviceScaleFactor=density or (2 if phone else 1))
        self.call('Emulation.setTouchEmulationEnabled', enabled=phone, maxTouchPoints=5 if phone else 1)

    def evaluate(self, expression):
        """The value of an expression, of a promise what it comes to."""
        result = self.call('Runtime.evaluate', expression=expression, returnByValue=True, awaitPromise=True,
                           userGesture=True)
        if 'exceptionDetails' in result:
            details = result['exceptionDetails']
            raise Failure(f"{expression}: {details.get('exception', {}).get('description', details.get('text'))}")
        return result['result'].get('value')

    def wait(self, expression, limit=20):
        """Until the expression is true; returns its value."""
        end = time.monotonic() + limit * scale()
        while True:
            value = self.evaluate(expression)
            if value:
                return value
            if time.monotonic() > end:
                raise Failure(f'in {limit} s it never was true: {expression[:400]}')
            self.browser.listen(0.05)

    def middle(self, selector, hit=False):
        """The middle of an element, CSS pixels, once it rests, and once it is what is hit there."""
        return self.wait(f'''(async () => {{
            const all = [...document.querySelectorAll({json.dumps(selector)})].filter((one) => one.offsetParent !== null
                || getComputedStyle(one).position === 'fixed');
            if (!all.length) return null;
            all[0].scrollIntoView({{ block: 'nearest', inline: 'nearest' }});
            const middle = () => {{
                const box = all[0].getBoundingClientRect();
                return [box.left + box.width / 2, box.top + box.height / 2];
            }};
            const before = middle();
            await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
            const now = middle();
            const met = document.elementFromPoint(...now);
            const free = {json.dumps(not hit)} || all[0].contains(met) || met?.contains(all[0]);
            return now.join() === before.join() && free ? now : null;
        }})()''')

    def mouse(self, kind, x, y, button='left', buttons=0, clicks=1, wheel=0, shift=False):
        values = {'deltaX': 0, 'deltaY': wheel} if kind == 'mouseWheel' else {}
        self.call('Input.dispatchMouseEvent', type=kind, x=x, y=y, button=button, buttons=buttons, clickCount=clicks,
                  modifiers=SHIFT if shift else 0, **values)

    def click(self, x, y, count=1):
        for i in range(count):
            self.mouse('mousePressed', x, y, buttons=1, clicks=i + 1)
            self.mouse('mouseReleased', x, y, clicks=i + 1)

    def press(self, selector):
        """Clicks an element as a hand does."""
        self.click(*self.middle(selector, hit=True))

    def drag(self, x0, y0, x1, y1, steps=8, button='left', shift=False):
        held = {'left': 1, 'right': 2, 'middle': 4}[button]
        self.mouse('mousePressed', x0, y0, button=button, buttons=held, shift=shift)
        for i in range(1, steps + 1):
            x, y = x0 + (x1 - x0) * i / steps, y0 + (y1 - y0) * i / steps
            self.mouse('mouseMoved', x, y, button=button, buttons=held, shift=shift)
        self.mouse('mouseReleased', x1, y1, button=button, shift=shift)

    def touch(self, kind, points):
        """kind: touchStart, touchMove, touchEnd; points: [(x, y), ...]."""
        self.call('Input.dispatchTouchEvent', type=kind,
                  touchPoints=[{'x': x, 'y': y, 'id': i} for i, (x, y) in enumerate(points)])

    def key(self, key, down=True, up=True, shift=False):
        code, number, text = KEYS.get(key, (f'Key{key.upper()}' if key.isalpha() else f'Digit{key}',
                                            ord(key[0].upper()), key))
        values = {'key': key, 'code': code, 'windowsVirtualKeyCode': number, 'modifiers': SHIFT if shift else 0}
        if down:
            self.call('Input.dispatchKeyEvent', type='keyDown' if text else 'rawKeyDown', text=text, **values)
        if up:
            self.call('Input.dispatchKeyEvent', type='keyUp', **values)

    def type(self, text):
        self.call('Input.insertText', text=text)

    def screenshot(self, path=None):
        data = base64.b64decode(self.call('Page.captureScreenshot', format='png')['data'])
        if path:
            with open(path, 'wb') as file:
                file.write(data)
        return data

    def downloaded(self, limit=20):
        """The first file that was saved and that nobody took yet: (name, bytes)."""
        end = time.monotonic() + limit * scale()
        while time.monotonic() < end:
            names = [name for name in os.listdir(self.downloads) if not name.endswith('.crdownload')
                     and not name.startswith('.')]
            if names:
                path = os.path.join(self.downloads, names[0])
                with open(path, 'rb') as file:
                    data = file.read()
                os.remove(path)
                return names[0], data
            self.browser.listen(0.05)
        raise Failure(f'nothing was saved in {limit} s')
