#!/usr/bin/env python3
"""The viewer's page in Chromium, as hands use it: what they do is seen in the picture, and the console is silent."""
import json
import math
import re
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
    """Until the newest picture is of a camera that rests, and of that many frames."""
    page.wait(f"Number(document.querySelector('.picture').dataset.frames) >= {frames}")


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


class Tests:
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

    def test_moves(self):
        page = self.page
        page.press('#moving button[data-name=fly]')
        before, start = look(page), camera(page)
        page.key('w', up=False)
        page.wait(f'Math.hypot(...viewer.camera.eye.map((x, i) => x - {start["eye"]}[i])) > 1')
        page.key('w', down=False)
        differs(page, before, 2)
        rests(page)
        before, start = look(page), camera(page)
        page.drag(300, 200, 420, 190)
        page.wait(f'Math.hypot(...viewer.camera.target.map((x, i) => x - {start["target"]}[i])) > 0.5')
        differs(page, before, 2)
        assert far(camera(page)['eye'], start['eye']) < 0.5, 'a drag has moved the eye'
        rests(page)
        quiet = page.evaluate('viewer.sent')
        self.machine.listen(0.5)
        assert page.evaluate('viewer.sent') == quiet, 'inputs were sent while nothing was pressed'

    def test_jumps(self):
        page = self.page
        start = camera(page)
        page.click(320, 300, count=2)
        page.wait(f'Math.hypot(...viewer.camera.eye.map((x, i) => x - {start["eye"]}[i])) > 0.2')
        page.key('b')
        page.press('#right .panel:not([hidden]) .tools[role=group] button')
        page.wait(f'viewer.state.camera.name === "{page.evaluate("viewer.cameras[0].name ?? viewer.cameras[0]")}"')
        page.key('Escape')
        rests(page)

    def test_picks(self):
        page = self.page
        page.click(320, 330)
        page.wait("document.querySelectorAll('table.rows tbody tr').length > 2")
        text = page.evaluate("document.querySelector('.answer').innerText")
        assert ' lx' in text and 'class' in text, text
        page.press('table.rows tbody tr')
        assert page.evaluate('viewer.highlighted.length') >= 1
        shares = page.evaluate('''[...document.querySelectorAll('table.rows tbody tr td:nth-child(3)')]
            .map((cell) => parseFloat(cell.textContent))''')
        assert 0 < sum(shares) < 101, shares
        press_text(page, 'CSV')
        name, data = page.downloaded()
        lines = data.decode().strip().splitlines()
        assert name.endswith('.csv') and 'share' in lines[0] and len(lines) > 2, (name, lines[:2])
        blur(page)
        page.key('t')

    def test_outlines_stay(self):
        """A rectangle that was asked about is seen in the picture and on the map until it is cleared."""
        page = self.page
        painted = """(() => {
            const canvas = document.querySelector('.overlay');
            const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
            let count = 0;
            for (let i = 0; i < data.length; i += 4)
                count += data[i + 3] > 100 && data[i] > 100 && data[i] < 150 && data[i + 2] > 230;
            return count;
        })()"""
        on_map = painted.replace('.overlay', '.map')
        on_map = on_map.replace('data[i + 2] > 230', 'data[i + 2] > 230 && data[i + 1] > 160')
        page.key('m')
        page.wait("document.querySelector('.map').width > 200")
        before = page.evaluate(on_map)
        page.key('t')
        press_text(page, 'Rectangle')
        page.drag(60, 250, 200, 370)
        page.wait("document.querySelectorAll('table.rows tbody tr').length > 2")
        assert page.evaluate(painted) > 100
        assert 'this rectangle of the picture' in page.evaluate("document.querySelector('.answer h3').textContent")
        page.key('m')
        page.wait(f'{on_map} > {before} + 20')
        page.key('t')
        press_text(page, 'Clear')
        page.wait(f'{painted} === 0')
        page.key('m')
        page.wait(f'{on_map} <= {before} + 5')
        page.key('m')

    def test_finds_by_name(self):
        page = self.page
        page.key('/')
        page.type('ring e')
        page.wait("document.querySelector('.found li')?.dataset.kind === 'street'")
        page.key('Enter')
        page.wait("document.querySelector('.answer h3')?.textContent === 'Who lights Ring East?'")
        page.wait("document.querySelectorAll('table.rows tbody tr').length > 2")
        page.key('b')
        press_text(page, 'Go there')
        page.wait('viewer.state.camera.eye[2] > 2')
        rests(page)
        page.evaluate("(document.querySelector('.finder input').value = '', 0)")
        page.key('b')
        page.evaluate("viewer.goTo('street')")
        page.wait("viewer.state.camera.name === 'street'")
        rests(page)

    def test_map_tells_names_and_scale(self):
        page = self.page
        page.key('m')
        page.wait("/^\\d+ k?m$/.test(document.querySelector('.map-scale').textContent)")
        bar = page.evaluate("(({ textContent, offsetWidth }) => [textContent, offsetWidth])"
                            "(document.querySelector('.map-scale'))")
        assert bar[0].split()[0].strip('0') in ('1', '2', '5') and 24 < bar[1] <= 121, bar
        light = page.evaluate("document.querySelector('.map').getBoundingClientRect().toJSON()")
        found = False
        for y in range(10, int(light['height']) - 10, 9):  # until the pointer comes over something
            page.mouse('mouseMoved', light['x'] + light['width'] / 2, light['y'] + y)
            self.machine.listen(0.4)
            found = found or page.evaluate("!document.querySelector('.map-tip').hidden")
            if found:
                break
        assert found, 'nothing has a name'
        assert page.evaluate("document.querySelector('.map-tip').textContent.length") > 3
        page.key('m')

    def test_settings_are_found_by_what_they_do(self):
        page = self.page
        page.key('p')
        for word in ('dim', 'LED', 'sodium', 'off'):
            page.evaluate("(document.querySelector('input[type=search]').value = '', 0)")
            page.press('input[type=search]')
            page.type(word)
            page.wait("document.querySelector('.control[data-name=\"group.lamps\"]').offsetParent !== null")
        lamps = """document.querySelector('.control[data-name="group.lamps"] input[type=color]')"""
        swatch = page.evaluate(f'{lamps}.value')
        assert swatch not in ('#000000', '#ffffff') and swatch[1:3] > swatch[5:7], swatch
        label = page.evaluate("document.querySelector('label[for=\"option-window-lit\"]').textContent")
        assert label == 'share of windows lit at 21 h', label
        titles = page.evaluate("[...document.querySelectorAll('.presets button')].map((one) => one.title)")
        assert 'sets hour 3, lamps 0.5,own' in titles, titles
        page.evaluate("(document.querySelector('input[type=search]').value = '', 0)")
        page.key('Escape')
        page.wait("document.getElementById('left').hidden")

    def test_shows_modes(self):
        page = self.page
        before = look(page)
        names = page.evaluate("[...document.querySelectorAll('#modes button')].map((one) => one.dataset.name)")
        assert len(names) > 10, names
        for name in names[1:]:
            page.evaluate(f"document.querySelector('#modes button[data-name=\"{name}\"]').click()")
            page.wait(f"viewer.state.panes[0].values.show === '{name}'")
            differs(page, before, 2)
            before = look(page)
        page.evaluate("document.querySelector('#modes button').click()")
        page.wait(f"viewer.state.panes[0].values.show === '{names[0]}'")
        page.wait("document.getElementById('legend').hidden")

    def test_rows_show_that_there_is_more(self):
        page = self.page
        has = "document.getElementById('modes').classList.contains('more-%s')"
        page.evaluate("(document.getElementById('modes').scrollLeft = 0, 0)")
        page.wait(f"{has % 'after'} && !{has % 'before'}")
        page.evaluate("(document.getElementById('modes').scrollLeft = 1e6, 0)")
        page.wait(f"!{has % 'after'} && {has % 'before'}")
        page.evaluate("(document.getElementById('modes').scrollLeft = 0, 0)")

    def test_has_legends(self):
        page = self.page
        page.evaluate("document.querySelector('#modes button[data-name=depth]').click()")
        page.wait("document.querySelectorAll('#legend .ticks span').length > 1")
        before = look(page)
        page.evaluate("document.querySelector('#legend .handle.high').focus()")
        for _ in range(6):
            page.key('ArrowLeft')
        differs(page, before, 2)
        page.press('#isolines')
        page.evaluate("document.getElementById('isolines').select()")
        page.type('7.5, 12,40')
        page.key('Enter')
        page.wait("viewer.state.panes[0].values.isolines === '7.5,12,40'")
        assert '--isolines 7.5,12,40' in state(page, 'command')
        shown = "[...document.querySelectorAll('#legend .ticks span')].map((one) => one.textContent).join(' ')"
        page.wait(f"['7.5', '7.5 12', '7.5 12 40'].includes({shown})")
        page.evaluate("viewer.set('isolines', '0')")
        blur(page)
        page.evaluate("document.querySelector('#modes button').click()")
        page.wait("document.getElementById('legend').hidden")

    def test_legends_make_room(self):
        page = self.page
        legend = "document.getElementById('legend').getBoundingClientRect()"

        def at():
            return page.evaluate(f'(({{ x, y }}) => [x, y])({legend})')

        page.evaluate("document.querySelector('#modes button[data-name=depth]').click()")
        page.wait("document.querySelectorAll('#legend .ticks span').length > 1")
        x, y = page.middle('#legend .band')
        under = page.evaluate(f"document.elementFromPoint({x}, {y}).closest('#stage') !== null")
        assert under, 'the legend takes clicks that are meant for the picture'
        before, seen = at(), camera(page)
        x, y = page.middle('#legend .title')
        page.drag(x, y, x - 15, y - 80)
        moved = at()
        assert moved[1] < before[1] - 60 and moved[0] <= before[0], (before, moved)
        assert far(direction(camera(page)), direction(seen)) < 1e-6, 'what moves the legend turns the camera'
        page.evaluate("document.querySelector('#legend .head button').focus()")
        page.key('ArrowDown')
        assert at()[1] > moved[1] + 5, (moved, at())
        page.press('#legend .fold')
        page.wait("document.querySelector('#legend .scale').offsetParent === null")
        kept = at()
        page.evaluate('location.reload()')
        page.wait("globalThis.viewer?.state?.panes[0].values.show === 'depth'")
        page.wait("!document.getElementById('legend').hidden")
        page.wait("document.querySelector('#legend .scale').offsetParent === null")
        assert far(at(), kept) < 3, (kept, at())
        page.press('#legend .fold')
        page.wait("document.querySelector('#legend .scale').offsetParent !== null")
        page.evaluate("document.querySelector('#legend .head button').focus()")
        for _ in range(10):
            page.key('ArrowDown')
        blur(page)
        page.evaluate("document.querySelector('#modes button').click()")
        page.wait("document.getElementById('legend').hidden")

    def test_sets_options(self):
        page = self.page
        before = look(page)
        page.key('p')
        choose(page, 'tonemap', 'linear')
        differs(page, before, 1)
        page.wait("document.querySelector('.control[data-name=tonemap] .back').offsetParent !== null")
        choose(page, 'method', 'is')
        page.wait("viewer.state.panes[0].values.method === 'is'")
        why = page.evaluate("document.querySelector('.control[data-name=candidates] .why').textContent")
        assert 'method' in why, f'why candidates are idle: {why!r}'
        choose(page, 'method', 'ris')
        choose(page, 'tonemap', 'filmic')
        page.press('input[type=search]')
        page.type('radius')
        page.wait("document.querySelector('.control[data-name=method]').offsetParent === null")
        assert page.evaluate("document.querySelector('.control[data-name=radius]').offsetParent !== null")
        page.key('Escape')
        blur(page)
        page.key('p')
        page.wait("document.getElementById('left').hidden")

    def test_two_share_the_world(self):
        page = self.page
        other = opened(self.machine, self.served.link)
        rests(page)
        before = look(page)
        group = 'group.lamps'
        choose(other, group, 'on')
        other.evaluate(f'viewer.setWorld("{group}", "off")')
        differs(page, before, 3)
        assert state(page, f'world.values["{group}"]').startswith('off')
        seen = camera(page)
        other.evaluate("viewer.goTo('aerial')")
        other.wait("viewer.state.camera.name === 'aerial'")
        assert far(camera(page)['eye'], seen['eye']) < 1e-6, 'the other one has moved this camera'
        other.evaluate(f'viewer.setWorld("{group}", viewer.option("{group}").value)')
        page.wait(f'!viewer.state.world.values["{group}"].startsWith("off")')
        assert not other.errors, other.errors
        other.close()

    def test_divides(self):
        page = self.page
        page.press('#layouts button[data-name=divider]')
        page.wait("document.querySelectorAll('.pane').length === 2")
        page.evaluate('viewer.edit(1)')
        page.wait("[0, 1].every((i) => document.querySelectorAll('.picture')[i].dataset.n)")
        page.evaluate("viewer.set('exposure', '0')")
        page.wait("viewer.state.panes[1].values.exposure === '0'")
        differs(page, look(page, 0), 10, pane=1)
        x, y = page.middle('.divider')
        page.drag(x, y, x - 150, y)
        at = page.evaluate("Number(document.querySelector('.divider').getAttribute('aria-valuenow'))")
        assert 20 < at < 32, at
        page.key('ArrowRight')
        assert page.evaluate("Number(document.querySelector('.divider').getAttribute('aria-valuenow'))") == at + 2
        captions = page.evaluate("[...document.querySelectorAll('.caption')].map((one) => one.textContent)")
        buttons = page.evaluate("[...document.querySelectorAll('.which button')].map((one) => one.textContent)")
        assert captions == ['A', 'B'] and buttons == ['A', 'B', 'all'], (captions, buttons)
        page.evaluate('viewer.edit(0)')

    def test_compares(self):
        page = self.page
        method = state(page, 'panes[0].values.method')
        page.press('#layouts button[data-name=methods]')
        page.wait("document.querySelectorAll('.pane').length >= 4")
        page.wait("[...document.querySelectorAll('.picture')].every((one) => one.dataset.n)", 60)
        captions = page.evaluate("[...document.querySelectorAll('.caption')].map((one) => one.innerText)")
        assert len(set(captions)) == 6 and captions[-1] == 'ReSTIR' and all(captions), captions
        assert page.evaluate("viewer.state.panes.every(({ values }) => values.smooth === 'false')")
        page.evaluate("document.querySelectorAll('.picture')[2].dataset.n = 'old'")
        page.press('#layouts button[data-name=difference]')
        page.wait("viewer.state.layout === 'difference'")
        assert page.evaluate("document.querySelectorAll('.picture')[2].dataset.n !== 'old'"), 'a picture of RIS is left'
        page.wait("[...document.querySelectorAll('.caption')].some((one) => one.textContent.includes('RMSE'))", 60)
        assert page.evaluate("viewer.state.panes[0].values.smooth === 'true'")
        page.wait("/early, after \\d+ frame/.test(document.querySelectorAll('.caption')[2].textContent)")
        said = page.evaluate("[document.querySelectorAll('.caption')[2].textContent, viewer.stats[2].bias]")
        bias = float(re.search(r'bias (-?[\d.,]+) %', said[0])[1].replace(',', ''))
        assert abs(bias - 100 * (said[1] - 1)) < 0.6 + 0.1 * abs(bias), said
        page.wait("document.querySelectorAll('#legend .ticks span').length > 1")
        low, high = page.evaluate('[viewer.stats[2].legend.low, viewer.stats[2].legend.high]')
        assert low == -high and high > 0, (low, high)
        assert page.evaluate("document.querySelector('#legend .handle').offsetParent === null")
        narrow = opened(self.machine, self.served.link, width=390, height=844, phone=True)
        narrow.evaluate("viewer.connection.send('layout', { name: 'difference' })")
        narrow.wait("document.querySelectorAll('#legend .ticks span').length > 1", 60)
        box = narrow.evaluate("(({ left, right, bottom }) => [left, right, innerHeight - bottom])"
                              "(document.getElementById('legend').getBoundingClientRect())")
        assert box[0] >= 0 and box[1] <= 390 and box[2] >= 0, box
        narrow.close()
        page.press('#layouts button[data-name=single]')
        page.wait("document.querySelectorAll('.pane').length === 1")
        assert state(page, 'panes[0].values.method') == method, 'all methods have changed this look'

    def test_saves(self):
        page = self.page
        for what, begins in (('png', b'\x89PNG'), ('exr', b'\x76\x2f\x31\x01'), ('recipe', b'')):
            page.evaluate(f"viewer.save('{what}', {{ pane: 0 }})")
            name, data = page.downloaded()
            assert data.startswith(begins) and len(data) > 50, (name, data[:20])
            if what == 'recipe':
                assert b'nocturne: 1' in data, data[:200]
        command = state(page, 'command')
        assert command.startswith('nocturne render ') and '--eye' in command, command

    def test_links(self):
        page = self.page
        page.evaluate("viewer.set('tonemap', 'reinhard')")
        page.wait("viewer.state.panes[0].values.tonemap === 'reinhard'")
        page.key('u')
        press_text(page, 'Copy link')
        link = page.wait("location.hash.includes('view=') && location.href")
        # in the clipboard, or shown where the browser lets nobody write there
        copied = "document.getElementById('toasts').innerText.includes('copied')"
        page.wait(f"document.getElementById('text').open || {copied}")
        if page.evaluate("document.getElementById('text').open"):
            page.key('Escape')
            page.wait("!document.getElementById('text').open")
        other = opened(self.machine, link)
        other.wait("viewer.state.panes[0].values.tonemap === 'reinhard'")
        other.wait(f"Math.hypot(...viewer.camera.eye.map((x, i) => x - {camera(page)['eye']}[i])) < 0.01")
        assert not other.errors, other.errors
        other.close()
        page.evaluate("viewer.set('tonemap', 'filmic')")
        blur(page)
        page.key('u')

    def test_reloads(self):
        other = opened(self.machine, self.served.link)
        other.evaluate("viewer.set('method', 'is'); viewer.goTo('aerial')")
        other.evaluate("viewer.connection.send('layout', { name: 'divider' })")
        other.wait("viewer.state.layout === 'divider' && viewer.state.panes[1].values.method === 'is'")
        other.evaluate("viewer.set('show', 'depth', 1); viewer.set('show-scale', 'linear', 1)")
        other.evaluate("viewer.set('show-range', '0,50', 1)")
        other.wait("viewer.state.panes[1].values['show-range'] === '0,50'")
        self.machine.listen(2)  # the flight
        seen = camera(other)
        other.evaluate('location.reload()')
        other.wait("globalThis.viewer?.state?.layout === 'divider'")
        other.wait("viewer.state.panes[1]?.values['show-range'] === '0,50'")
        values = state(other, 'panes[1].values')
        assert (values['show'], values['show-scale'], values['method']) == ('depth', 'linear', 'is'), values
        other.wait(f"viewer.camera && Math.hypot(...viewer.camera.eye.map((x, i) => x - {seen['eye']}[i])) < 0.5")
        other.evaluate("viewer.edit(0)")
        other.wait("viewer.ev100 !== null")
        found = other.evaluate('viewer.ev100')
        choose(other, 'exposure', 'off')
        other.wait("viewer.state.panes[0].values.exposure !== 'auto'")
        assert abs(float(state(other, 'panes[0].values.exposure')) - found) < 0.5, found
        assert not other.errors, other.errors
        other.close()

    def test_bookmarks(self):
        page = self.page
        there = camera(page)
        page.key('b')
        page.press('#right .panel:not([hidden]) form input')
        page.type('corner')
        page.key('Enter')
        page.wait("document.querySelector('.bookmarks .name')?.textContent === 'corner'")
        page.evaluate("viewer.goTo('aerial')")
        page.wait("viewer.state.camera.name === 'aerial'")
        page.press('.bookmarks .name')
        page.wait(f"Math.hypot(...viewer.camera.eye.map((x, i) => x - {there['eye']}[i])) < 0.01")
        blur(page)
        page.key('b')

    def test_photograph(self):
        """The camera of a photograph is found from places that are clicked in it and in the picture."""
        page = opened(self.machine, self.served.link, width=1000, height=500)
        page.evaluate("viewer.goTo('aerial')")
        page.wait("viewer.state.camera.name === 'aerial'")
        page.key('o')
        page.wait("document.getElementById('photo-file')?.checkVisibility()")
        rests(page)
        there = camera(page)
        marks = (0.7, 0.7), (0.55, 0.4), (0.2, 0.9), (0.5, 0.8), (0.35, 0.6)
        places = [page.evaluate(f'''new Promise((done) => viewer.ask('pixel', {{ pane: 0, x: {x}, y: {y} }},
            (answer) => answer.done < 1 || done(answer.place)))''') for x, y in marks]
        assert all(places), places
        page.evaluate('''(async () => {
            const blob = await new Promise((done) => document.querySelector('.picture').toBlob(done));
            const files = new DataTransfer();
            files.items.add(new File([blob], 'photo.png', { type: 'image/png' }));
            const box = document.getElementById('photo-file');
            box.files = files.files;
            box.dispatchEvent(new Event('change'));
        })()''')
        page.press('#moving button[data-name=fly]')
        page.drag(300, 200, 330, 190)
        page.wait(f'Math.hypot(...viewer.camera.target.map((x, i) => x - {there["target"]}[i])) > 1')
        rests(page)
        press_text(page, 'Set pairs')
        for number, ((x, y), place) in enumerate(zip(marks, places)):
            page.click(*on_stage(page, (x, y)))
            page.wait("document.querySelector('#right').innerText.includes('same point')")
            page.click(*on_stage(page, seen_at(camera(page), place, page)))
            page.wait(f"document.querySelectorAll('.pairs li').length === {number + 1}")
        press_text(page, 'Find the camera')
        page.wait("document.querySelector('#right').innerText.includes('The camera was found')")
        page.wait(f"Math.abs(viewer.camera.fov - {there['fov']}) > 1e-6") # it is another one, a little
        found = camera(page)
        assert far(found['eye'], there['eye']) < 1, (found, there)
        assert far(direction(found), direction(there)) < 0.01, (found, there)
        assert abs(found['fov'] - there['fov']) < 1, (found, there)
        assert not page.errors, page.errors
        page.close()

    def test_by_keys_alone(self):
        page = self.page
        blur(page)
        page.evaluate("document.getElementById('stage').focus()")
        page.key('?', shift=True)
        page.wait("document.getElementById('help').open")
        page.key('Escape')
        page.wait("!document.getElementById('help').open")
        seen = []
        for _ in range(40):  # the tab key comes to every panel's button
            page.key('Tab')
            seen.append(page.evaluate('document.activeElement.textContent'))
            if seen[-1] == 'Settings':
                break
        assert seen[-1] == 'Settings', seen
        page.key('Enter')
        page.wait("!document.getElementById('left').hidden")
        page.key('Escape')
        page.wait("document.getElementById('left').hidden")
        assert page.evaluate('document.activeElement.textContent') == 'Settings', 'the focus did not come back'
        page.evaluate("document.querySelector('#modes button[tabindex=\"0\"]').focus()")
        page.key('ArrowRight')
        name = page.evaluate('document.activeElement.dataset.name')
        page.wait(f"viewer.state.panes[0].values.show === '{name}'")
        page.key('ArrowLeft')
        page.wait("viewer.state.panes[0].values.show === 'picture'")

    def test_everything_has_a_key_a_name_and_a_focus(self):
        """Tab reaches every control that is seen; each has a name, and shows that it has the focus."""
        page = self.page
        for key in 'pb':
            page.key(key)
            blur(page)
        lacking = """(() => {
            const name = (one) => one.ariaLabel || one.getAttribute('aria-labelledby') || one.labels?.[0]?.textContent
                || one.textContent.trim() || one.title;
            const all = [...document.querySelectorAll('button, input, select, textarea, [tabindex], a, summary')];
            return all.filter((one) => !name(one)).map((one) => one.outerHTML.slice(0, 120));
        })()"""
        assert page.evaluate(lacking) == [], page.evaluate(lacking)
        signs = page.evaluate("""[...document.querySelectorAll('button')].filter((one) => !one.ariaLabel && !one.title
            && !/[A-Za-z0-9]/.test(one.textContent)).map((one) => one.outerHTML)""")
        assert signs == [], signs
        wanted = page.evaluate("""(() => {
            const all = [...document.querySelectorAll('button, input, select, textarea, summary, canvas[tabindex]')];
            const seen = all.filter((one) => one.offsetParent && !one.disabled && one.tabIndex >= 0
                && !(one.type === 'radio'));
            seen.forEach((one, i) => (one.dataset.wanted = i));
            return seen.length;
        })()""")
        page.evaluate("document.getElementById('stage').focus()")
        reached, unseen = set(), []
        for _ in range(wanted + 60):
            page.key('Tab')
            one = page.evaluate("""(({ dataset, outerHTML }, style) => [dataset.wanted, outerHTML.slice(0, 100),
                style.outlineStyle, parseFloat(style.outlineWidth)])
                (document.activeElement, getComputedStyle(document.activeElement))""")
            if one[0] is not None:
                reached.add(int(one[0]))
            if one[0] is not None and (one[2] == 'none' or not one[3]):
                unseen.append(one[1])
        assert not unseen, unseen[:3]
        missing = sorted(set(range(wanted)) - reached)
        assert not missing, [page.evaluate(f"document.querySelector('[data-wanted=\"{i}\"]').outerHTML")[:100]
                             for i in missing[:4]]
        for key in 'pb':
            blur(page)
            page.key(key)
        roles = page.evaluate("""['said', 'toasts', 'loading'].map((id) => document.getElementById(id))
            .map((one) => one.getAttribute('aria-live') ?? one.getAttribute('role'))""")
        assert roles == ['polite', 'polite', 'status'], roles

    def test_text_has_contrast(self):
        """All text that is seen, over panels on a white picture, has a contrast of 4.5 to 1 at least."""
        page = self.page
        page.key('p')
        page.evaluate("document.querySelectorAll('.settings details').forEach((one) => (one.open = true))")
        page.key('b')
        low = page.evaluate("""(() => {
            const parse = (text) => {
                const [r, g, b, a] = text.match(/[\\d.]+/g).map(Number);
                return [r, g, b, a ?? 1];
            };
            const over = (top, under) => [0, 1, 2].map((i) => top[i] * top[3] + under[i] * (1 - top[3]));
            const light = (c) => {
                const [r, g, b] = c.map((x) => (x / 255 <= 0.04045 ? x / 3294.6 : ((x / 255 + 0.055) / 1.055) ** 2.4));
                return 0.2126 * r + 0.7152 * g + 0.0722 * b;
            };
            const found = [];
            for (const one of document.querySelectorAll('body *')) {
                const own = [...one.childNodes].some((node) => node.nodeType === 3 && node.data.trim());
                const field = one.matches('input:not([type=checkbox], [type=range], [type=color]), textarea');
                if (!(own || field) || !one.offsetParent || one.closest(':disabled, .pane, .hidden, #legend')) continue;
                const line = [];
                for (let at = one; at; at = at.parentElement) line.unshift(at);
                let back = [255, 255, 255], opacity = 1;
                for (const at of line) {
                    const style = getComputedStyle(at);
                    if (at.matches('html, body')) continue;
                    opacity *= Number(style.opacity);
                    back = over(parse(style.backgroundColor), back);
                }
                const colour = parse(getComputedStyle(one).color);
                const text = over([...colour.slice(0, 3), colour[3] * opacity], back);
                const [a, b] = [light(text), light(back)].sort((x, y) => y - x);
                const ratio = (a + 0.05) / (b + 0.05);
                if (ratio < 4.5) found.push([one.outerHTML.slice(0, 90), ratio]);
            }
            return found;
        })()""")
        assert low == [], low[:5]
        page.key('Escape')
        for drawer in ('left', 'right'):
            page.evaluate(f"document.querySelector('#{drawer} .panel:not([hidden]) .close')?.click()")
        blur(page)

    def test_less_motion(self):
        """Who wants less motion is at another camera at once, without a flight."""
        still = opened(self.machine, self.served.link)
        still.call('Emulation.setEmulatedMedia', features=[{'name': 'prefers-reduced-motion', 'value': 'reduce'}])
        still.evaluate("viewer.goTo('street')")
        still.wait("viewer.state.camera.name === 'street'")
        rests(still)
        still.evaluate("(viewer.went = [], viewer.on('stats', ({ camera }) => viewer.went.push(camera.eye[2])), 0)")
        still.evaluate("viewer.goTo('aerial')")
        still.wait("viewer.state.camera.name === 'aerial' && viewer.camera.eye[2] > 10")
        rests(still)
        ends = still.evaluate('[viewer.went[0], viewer.camera.eye[2]]')
        between = [z for z in still.evaluate('viewer.went') if min(abs(z - ends[1]), abs(z - 1.7)) > 0.3]
        assert not between, between
        still.close()

    def test_on_a_phone(self):
        phone = opened(self.machine, self.served.link, width=390, height=844, phone=True)
        for width, height in ((390, 844), (844, 390)):
            phone.viewport(width, height, True)
            self.machine.listen(0.3)
            wide = phone.evaluate('document.documentElement.scrollWidth')
            assert wide <= width, f'the page is {wide} wide on {width}'
        before = phone.wait('viewer.camera')
        phone.touch('touchStart', [(400, 250)])
        for x in range(410, 500, 10):
            phone.touch('touchMove', [(x, 250)])
        phone.touch('touchEnd', [])
        phone.wait(f'Math.hypot(...viewer.camera.target.map((x, i) => x - {before["target"]}[i])) > 0.3')
        phone.press('#tabs button')
        phone.wait("!document.getElementById('left').hidden")
        box = phone.evaluate("['clientWidth', 'clientHeight'].map((side) => document.getElementById('stage')[side])")
        assert min(box) > 150, f'the picture has {box} left'
        assert not phone.errors, phone.errors
        phone.close()

    def test_comes_back(self):
        page = self.page
        seen = camera(page)
        assert not page.errors, page.errors
        status, said = self.served.end(wait=30 * browser.scale())
        assert status in (0, 130), (status, said)
        page.wait("!document.getElementById('loading').hidden")
        self.served = wire.Program(*CITY, port=self.served.port)
        page.wait("document.getElementById('loading').hidden", 60)
        page.wait(f"Math.hypot(...viewer.camera.eye.map((x, i) => x - {seen['eye']}[i])) < 0.01")
        page.errors = [one for one in page.errors if 'WebSocket' not in one]  # what the browser says of tries

    def test_silent(self):
        assert not self.page.errors, self.page.errors


def main():
    if not browser.program():
        print('1..0 # SKIP Chromium is not here')
        return
    functions = tap.tests_of(Tests)
    if len(sys.argv) > 1:  # these alone
        functions = [one for one in functions if one.__name__[5:] in ('opens', *sys.argv[1:])]
    with browser.Browser() as machine:
        tests = Tests(machine, wire.Program(*CITY))
        try:
            tap.run(functions, tests)
        finally:
            if tests.served.alive():
                tests.served.end()


if __name__ == '__main__':
    main()
