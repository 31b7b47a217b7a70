"""A page of the viewer in Chromium as hands use it: what tests of pages share."""
import json
import math
import sys

import browser
import tap
import wire

CITY = ['builtin:city', '--city-size', '160', '--view', 'street']

# A picture as 24 x 14 colours, 0 to 255.
LOOK = '''(() => {
    const small = document.createElement('canvas');
    small.width = 24;
    small.height = 14;
    const context = small.getContext('2d');
    context.drawImage(document.querySelectorAll('.picture')[%d], 0, 0, 24, 14);
    return [...context.getImageData(0, 0, 24, 14).data].filter((_, i) => i %% 4 < 3);
})()'''


PICTURE = '''(() => {
    const box = document.querySelector('.picture').getBoundingClientRect();
    return [box.left, box.top, box.width, box.height];
})()'''


def look(page, pane=0):
    return page.evaluate(LOOK % pane)


def apart(a, b):
    """Mean difference of two pictures, of 255."""
    return sum(abs(x - y) for x, y in zip(a, b)) / len(a)


def differs(page, before, least, pane=0):
    """Waits until the picture is that much another one."""
    page.wait(f'''(() => {{
        const before = {json.dumps(before)};
        const now = {LOOK % pane};
        return now.reduce((sum, x, i) => sum + Math.abs(x - before[i]), 0) / now.length > {least};
    }})()''')


def state(page, path):
    return page.evaluate(f'viewer.state.{path}')


def camera(page):
    return page.evaluate('viewer.camera')


def far(a, b):
    return sum((x - y) ** 2 for x, y in zip(a, b)) ** 0.5


def direction(seen):
    away = [b - a for a, b in zip(seen['eye'], seen['target'])]
    return [x / far(seen['target'], seen['eye']) for x in away]


def seen_at(seen, place, page):
    """Where in the picture a place is: x and y, 0 to 1. The camera is upright."""
    wide, high = page.evaluate(PICTURE)[2:]
    fx, fy, fz = direction(seen)
    flat = math.hypot(fx, fy)
    right, up = (fy / flat, -fx / flat, 0), (-fx * fz / flat, -fy * fz / flat, flat)
    to = [b - a for a, b in zip(seen['eye'], place)]
    depth, x, y = (sum(a * b for a, b in zip(to, axis)) for axis in ((fx, fy, fz), right, up))
    half = depth * math.tan(math.radians(seen['fov']) / 2)
    return 0.5 + 0.5 * x / half * high / wide, 0.5 - 0.5 * y / half


def on_stage(page, at):
    """A place in the picture in pixels of the page."""
    left, top, wide, high = page.evaluate(PICTURE)
    return left + at[0] * wide, top + at[1] * high


def rests(page, frames=2):
    """Until the newest picture answers all input, is of a camera that rests, and of that many frames."""
    page.wait(f"""(({{ input, frames }}) => Number(input) >= viewer.sent && Number(frames) >= {frames})"""
              """(document.querySelector('.picture').dataset)""")


def choose(page, name, value):
    """Sets an option by its control in the panel of settings."""
    page.evaluate(f'''(() => {{
        const row = document.querySelector('.control[data-name="{name}"]');
        row.closest('details').open = true;
        const box = row.querySelector('select, input:not([type=range])');
        if (box.type === 'checkbox') {{
            if (box.checked !== {json.dumps(value == 'on')}) box.click();
        }} else {{
            box.value = {json.dumps(value)};
            box.dispatchEvent(new Event('change', {{ bubbles: true }}));
        }}
    }})()''')


def press_choice(page, name):
    """Presses the button of what is shown, of a layout or of a way of moving, which may be behind More."""
    page.evaluate(f"document.querySelector('[role=radio][data-name=\"{name}\"]').click()")


def shows(page, name):
    """Presses what is shown, and waits until the first picture shows it."""
    press_choice(page, name)
    page.wait(f"viewer.state.panes[0].values.show === '{name}' && viewer.stats[0]?.show === '{name}' && "
              "!viewer.waiting.size")


def press_text(page, text):
    """Presses the button of the panels that says this."""
    page.wait(f"""(() => {{
        const all = [...document.querySelectorAll('.panel:not([hidden]) button')];
        const one = all.find((button) => button.textContent.includes({json.dumps(text)}));
        one?.click();
        return Boolean(one);
    }})()""", 60)


def blur(page):
    page.evaluate('document.activeElement.blur()')


def opened(machine, link, **values):
    page = machine.page(link, **{'width': 640, 'height': 420, **values})
    page.wait("globalThis.viewer?.state && document.querySelector('.picture').dataset.n", 60)
    return page


class Opened:
    """A page that is open; its tests come between those two."""

    def __init__(self, machine, served):
        self.machine = machine
        self.served = served
        self.page = None

    def test_opens(self):
        self.page = opened(self.machine, self.served.link)
        rests(self.page)
        seen = look(self.page)
        assert max(seen) - min(seen) > 40, f'the picture is flat: {min(seen)} to {max(seen)}'
        assert self.page.evaluate("document.getElementById('loading').hidden")
        assert 'frames' in self.page.evaluate("document.getElementById('status').textContent")

    def test_silent(self):
        assert not self.page.errors, self.page.errors


def run(tests):
    """Those of a class that derives from Opened; the names of some run these alone."""
    if not browser.program():
        print('1..0 # SKIP Chromium is not here')
        return
    functions = tap.tests_of(tests)
    if len(sys.argv) > 1:
        functions = [one for one in functions if one.__name__[5:] in sys.argv[1:]]
    with browser.Browser() as machine:
        at = tests(machine, wire.Program(*CITY))
        try:
            tap.run([Opened.test_opens, *functions, Opened.test_silent], at)
        finally:  # which may be another one than it began with
            if at.served.alive():
                at.served.end()
