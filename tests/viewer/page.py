#!/usr/bin/env python3
"""The viewer's page in Chromium, as hands use it: what they do is seen in the picture, and the console is silent."""
import json
import re

import browser
import wire
from leaf import (CITY, Opened, apart, blur, camera, choose, differs, direction, far, look, opened, press_choice,
                  press_text, rests, run, shows, state)


class Page(Opened):
    def test_moves(self):
        page = self.page
        press_choice(page, 'fly')
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
        page.wait("document.querySelectorAll('table.ranking tbody tr').length > 2")
        text = page.evaluate("document.querySelector('.answer').innerText")
        assert ' lx' in text and 'class' in text, text
        page.press('table.ranking tbody tr')
        assert page.evaluate('viewer.highlighted.length') >= 1
        shares = page.evaluate('''[...document.querySelectorAll('table.ranking tbody tr td:nth-child(3)')]
            .map((cell) => parseFloat(cell.textContent))''')
        assert 0 < sum(shares) < 101, shares
        kinds = page.evaluate('''[...document.querySelectorAll('table.kinds tbody tr')].map((row) =>
            [row.cells[0].textContent, parseFloat(row.cells[1].textContent)])''')
        assert abs(sum(share for _, share in kinds) - 100) < 1, kinds
        assert 'lamp' in kinds[0][0] and 'window' in kinds[1][0], kinds
        assert kinds[2:] == sorted(kinds[2:], key=lambda one: -one[1]), kinds
        assert 'nocturne influence' in page.evaluate("document.querySelector('.answer textarea.command').value")
        page.evaluate("document.querySelector('table.ranking tbody tr[tabindex]').focus()")
        page.key('Enter')  # the card of a light, and back
        page.wait("document.querySelector('.answer').innerText.includes('What it lights')")
        press_text(page, 'Back to the ranking')
        again = page.evaluate("document.querySelector('.answer').innerText")
        assert ' lx' in again and 'Who lights this place?' in again, again
        press_text(page, 'CSV')
        name, data = page.downloaded()
        lines = data.decode().strip().splitlines()
        assert name.endswith('.csv') and 'share' in lines[0] and len(lines) > 2, (name, lines[:2])
        blur(page)
        page.key('t')

    def test_shows_modes(self):
        page = self.page
        before = look(page)
        names = page.evaluate("""[...document.querySelectorAll('#views button, #modes button')]
            .map((one) => one.dataset.name)""")
        assert names[:3] == ['picture', 'illuminance', 'influential'], names
        assert len(names) > 10, names
        for name in names[1:]:
            press_choice(page, name)
            page.wait(f"viewer.state.panes[0].values.show === '{name}'")
            differs(page, before, 2)
            before = look(page)
        press_choice(page, 'picture')
        page.wait(f"viewer.state.panes[0].values.show === '{names[0]}'")
        page.wait("document.getElementById('legend').hidden")

    def test_has_legends(self):
        page = self.page
        shows(page, 'depth')
        page.wait("document.querySelectorAll('#legend .ticks span').length > 1")
        before = look(page)
        page.evaluate("document.querySelector('#legend .handle.high').focus()")
        for _ in range(6):
            page.key('ArrowLeft')
            assert page.evaluate("document.activeElement?.matches('#legend .handle.high')")
        differs(page, before, 2)
        page.wait("!document.getElementById('legend').inert")
        page.press('#isolines')
        page.evaluate("document.getElementById('isolines').select()")
        page.type('7.5, 12,40')
        page.key('Enter')
        page.wait("viewer.state.panes[0].values.isolines === '7.5,12,40'")
        assert '--isolines 7.5,12,40' in state(page, 'command')
        shown = "[...document.querySelectorAll('#legend .ticks span')].map((one) => one.textContent).slice(2).join(' ')"
        page.wait(f"['7.5', '7.5 12', '7.5 12 40'].includes({shown})")
        page.evaluate("viewer.set('show-range', '1,300')")
        page.evaluate("viewer.set('isolines', '5,5.2,5.4,20')")
        ticks = "[...document.querySelectorAll('#legend .ticks span')].map((one) => one.textContent + one.className)"
        wanted = ['1', '300', '5', '5.2second', '5.4bare', '20']  # no line without a tick, and both ends
        page.wait(f"JSON.stringify({ticks}) === '{json.dumps(wanted, separators=(',', ':'))}'")
        page.evaluate("viewer.set('isolines', '0')")
        blur(page)
        press_choice(page, 'picture')
        page.wait("document.getElementById('legend').hidden")

    def test_legends_make_room(self):
        page = self.page
        legend = "document.getElementById('legend').getBoundingClientRect()"

        def at():
            return page.evaluate(f'(({{ x, y }}) => [x, y])({legend})')

        shows(page, 'depth')
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
        page.reload()
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
        press_choice(page, 'picture')
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
        press_choice(page, 'divider')
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
        page.evaluate("viewer.set('smooth', 'off', 0); viewer.set('smooth', 'on', 1)")
        page.wait("viewer.state.panes[0].values.smooth === 'false'")
        rests(page)
        page.evaluate("(viewer.marks = new Set(), viewer.on('shown', () => viewer.marks.add("
                      "document.querySelector('#status .smoothed').textContent)), 0)")
        x, y = page.middle('.divider')
        page.drag(x - 60, y + 60, x - 30, y + 60)  # the picture
        page.wait("viewer.marks.has('B smoothed, for display')")
        assert page.evaluate("[...viewer.marks].every((text) => text === '' || text.startsWith('B '))")
        page.evaluate("viewer.set('smooth', 'on', 0)")

    def test_says_what_it_waits_for(self):
        page = opened(self.machine, self.served.link)
        page.call('Page.addScriptToEvaluateOnNewDocument', source='''document.addEventListener('DOMContentLoaded', () =>
            new MutationObserver(([{ target }]) => (globalThis.waited ??= []).push(target.textContent))
                .observe(document.getElementById('loading'), { childList: true }))''')
        page.call('Page.reload')
        page.wait("globalThis.waited?.includes('Drawing the first picture')", 60)
        page.wait("document.querySelector('.picture').dataset.n && document.getElementById('loading').hidden", 60)
        page.close()

    def test_holds(self):
        """What is held of A stays while lamps change, under any shape of the window, until the camera moves."""
        page = self.page
        group = next(name for name in state(page, 'world.values') if name == 'group.lamps')
        for pane in (0, 1):
            page.evaluate(f"viewer.set('exposure', 'auto', {pane})")
        page.wait("viewer.state.panes.every(({ values }) => values.exposure === 'auto')")
        rests(page, 4)
        page.press('.hold')
        page.wait("viewer.state.panes.every(({ values }) => values.exposure !== 'auto') && !viewer.waiting.size")
        rests(page, 4)
        before = look(page)
        page.key('p')
        press_text(page, 'All sodium')
        page.wait(f"viewer.state.world.values['{group}'] === '1,2000K'")
        held = look(page)
        assert apart(before, held) < 4, f'what is held is another picture: {apart(before, held)}'
        press_text(page, 'Deep night, 3 h, lamps at half')
        page.wait(f"viewer.state.world.values['{group}'] === '0.5,2000K'") # and keeps its colour
        marks = page.evaluate("[...document.querySelectorAll('.control .mark:not([hidden])')].length")
        assert marks == page.evaluate('viewer.schema.world.length'), marks
        differs(page, before, 6, pane=1)
        assert apart(held, look(page)) == 0, 'what is held has changed'
        assert 'held' in page.evaluate("document.querySelector('.caption').textContent")
        page.evaluate("viewer.goTo('aerial')")
        page.wait("document.querySelector('.hold').getAttribute('aria-pressed') === 'false'")
        page.wait("viewer.state.panes.every(({ values }) => values.exposure === 'auto')")
        differs(page, before, 6)
        page.evaluate("viewer.goTo('street')")
        page.evaluate('''(() => {
            const all = [...document.querySelectorAll('.presets button')];
            for (const text of ['All LED', 'Evening, 19 h']) all.find((one) => one.textContent === text).click();
        })()''')  # before the first one's answer has come
        page.wait(f"viewer.state.world.values['{group}'] === '1,4000K'")
        page.evaluate(f"viewer.setWorld('{group}', '1,own')")
        page.evaluate("viewer.setWorld('hour', viewer.option('hour').value)")
        page.key('Escape')
        rests(page)

    def test_compares(self):
        page = self.page
        method = state(page, 'panes[0].values.method')
        press_choice(page, 'methods')
        page.wait("document.querySelectorAll('.pane').length >= 4")
        page.wait("[...document.querySelectorAll('.picture')].every((one) => one.dataset.n)", 60)
        captions = page.evaluate("[...document.querySelectorAll('.caption')].map((one) => one.innerText)")
        assert len(set(captions)) == 6 and captions[-1] == 'ReSTIR' and all(captions), captions
        assert page.evaluate("viewer.state.panes.every(({ values }) => values.smooth === 'false')")
        page.evaluate("document.querySelectorAll('.picture')[2].dataset.n = 'old'")
        press_choice(page, 'difference')
        page.wait("viewer.state.layout === 'difference'")
        assert page.evaluate("document.querySelectorAll('.picture')[2].dataset.n !== 'old'"), 'a picture of RIS is left'
        page.evaluate("(viewer.told = [], viewer.on('stats', ({ pane, frames }) => pane === 2 && viewer.told.push("
                      "[frames, document.querySelectorAll('.caption')[2].textContent])), 0)")
        page.evaluate("viewer.set('seed', '5')")
        page.wait("viewer.told.some(([frames]) => frames < 16)")
        page.wait("document.querySelectorAll('.caption')[2].textContent.includes('RMSE')", 60)
        told = page.evaluate('viewer.told')
        early = [text for frames, text in told if frames < 16]
        assert early and all('too early' in text and 'MSE' not in text for text in early), told
        assert page.evaluate("viewer.state.panes[0].values.smooth === 'true'")
        page.wait("/early, after \\d+ frame/.test(document.querySelectorAll('.caption')[2].textContent)")
        said = page.evaluate("[document.querySelectorAll('.caption')[2].textContent, viewer.stats[2].bias]")
        bias = float(re.search(r'bias (-?[\d.,]+) %', said[0])[1].replace(',', ''))
        assert abs(bias - 100 * (said[1] - 1)) < 0.6 + 0.1 * abs(bias), said
        page.wait("document.querySelectorAll('#legend-difference .ticks span').length > 1")
        low, high = page.evaluate('[viewer.stats[2].legend.low, viewer.stats[2].legend.high]')
        assert low == -high and high > 0, (low, high)
        assert page.evaluate("document.querySelector('#legend-difference .handle').offsetParent === null")
        self.modes_of_a_difference(page)
        narrow = opened(self.machine, self.served.link, width=390, height=844, phone=True)
        narrow.evaluate("viewer.connection.send('layout', { name: 'difference' })")
        narrow.wait("document.querySelectorAll('#legend-difference .ticks span').length > 1", 60)
        box = narrow.evaluate("(({ left, right, bottom }) => [left, right, innerHeight - bottom])"
                              "(document.getElementById('legend-difference').getBoundingClientRect())")
        assert box[0] >= 0 and box[1] <= 390 and box[2] >= 0, box
        narrow.close()
        press_choice(page, 'single')
        page.wait("document.querySelectorAll('.pane').length === 1")
        assert state(page, 'panes[0].values.method') == method, 'all methods have changed this look'

    def modes_of_a_difference(self, page):
        """Picture and reference show the same kind of numbers, with their legend; the difference keeps its own."""
        press_choice(page, 'illuminance')
        page.wait("[0, 1].every((i) => viewer.stats[i]?.legend?.unit === 'lx')", 60)
        legends = '''(() => {
            const box = (one) => one.getBoundingClientRect();
            const within = (own, pane) => own.left >= pane.left && own.right <= pane.right && own.top >= pane.top;
            const pane = (i) => box(document.querySelector(`.pane[data-pane="${i}"]`));
            const one = (id) => document.getElementById(id);
            return [one('legend').textContent.includes('lx'), one('legend-difference').textContent.includes('cd/m'),
                within(box(one('legend')), pane(0)), within(box(one('legend-difference')), pane(2))];
        })()'''
        assert page.evaluate(legends) == [True] * 4, page.evaluate(legends)
        press_choice(page, 'picture')
        page.wait("[0, 1].every((i) => viewer.state.panes[i].values.show === 'picture' && !viewer.stats[i]?.legend)")
        page.wait("document.getElementById('legend').hidden && !document.getElementById('legend-difference').hidden")
        press_choice(page, 'lights')
        page.wait("document.querySelector('.toast.error') !== null")  # the reference has none
        assert page.evaluate("viewer.state.panes.every(({ values }) => values.show === 'picture')")

    def test_saves(self):
        page = self.page
        for what, begins in (('png', b'\x89PNG'), ('exr', b'\x76\x2f\x31\x01'), ('recipe', b'')):
            page.evaluate(f"viewer.save('{what}', {{ pane: 0 }})")
            name, data = page.downloaded()
            said = 'the mean of' if what != 'recipe' else 'saved.'
            page.wait(f"document.querySelector('#toasts').lastChild?.textContent.includes('{name} saved')")
            assert said in page.evaluate("document.querySelector('#toasts').lastChild.textContent")
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
        other.reload()
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

    def test_comes_back(self):
        page = self.page
        seen = camera(page)
        assert not page.errors, page.errors
        status, said = self.served.end(wait=30 * browser.scale())
        assert status in (0, 130), (status, said)
        page.wait("!document.getElementById('loading').hidden")
        assert page.evaluate("document.querySelector('.pane.waiting .waits').textContent") == 'waiting for the picture'
        self.served = wire.Program(*CITY, port=self.served.port)
        page.wait("document.getElementById('loading').hidden", 60)
        page.wait(f"Math.hypot(...viewer.camera.eye.map((x, i) => x - {seen['eye']}[i])) < 0.01")
        page.wait("document.querySelectorAll('.pane.waiting').length === 0")
        page.errors = [one for one in page.errors if 'WebSocket' not in one]  # what the browser says of tries


if __name__ == '__main__':
    run(Page)
