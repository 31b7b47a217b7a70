#!/usr/bin/env python3
"""The page's map, search, bookmarks and photograph."""
import json

import wire
from leaf import (Opened, blur, camera, direction, far, on_stage, opened, press_choice, press_text, rests, run,
                  seen_at, state)


class Places(Opened):
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
        page.drag(60, 210, 200, 330)
        page.wait("document.querySelectorAll('table.ranking tbody tr').length > 2")
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

    def test_anybodys_links_do_no_harm(self):
        """What no view has is left out of links and of what the browser kept: nothing throws, no connection breaks."""
        page = self.page
        page.evaluate("(globalThis.broken = 0, viewer.connection.on('closed', () => broken++), 0)")
        none, long, nowhere = {'toString': 1, 'valueOf': 1}, 'x' * 5000, [0, 0, 5]
        fine = {'eye': [0, 0, 50], 'target': [1, 2, 3], 'fov': 40}
        cameras = [5, 'x', {}, {**fine, 'eye': 'abc'}, {**fine, 'eye': [1e30, 0, 0]}, {**fine, 'fov': 1e9},
                   {**fine, 'eye': [None, 'a', {}]}, {'eye': nowhere, 'target': nowhere, 'fov': 50}]
        views = [{'panes': one} for one in (5, 'x', {}, [none, 7, None], [{}] * 200, [{'preset': long}],
                                            [{'show': none, 'seed': [1]}])]
        views += [{'world': one} for one in (5, {'hour': none}, {'hour': long}, {'wet': [[]]})]
        views += [{'camera': one} for one in cameras] + [{'layout': one} for one in ({}, 'x', none)]
        views += [{'navigate': one} for one in ('x', {'mode': 'x'}, {'mode': 'fly', 'speed': none, 't': 'x'})]
        views += [{'bookmarks': one} for one in (5, {}, [{**one, 'name': 'n'} for one in cameras[2:]], [fine, None])]
        views += [{'bookmarks': [{**fine, 'name': long}, {**fine, 'name': '\0\ud800'}], 'camera': fine}]
        for view in [5, [], 'x'] + [{'v': 1, **one} for one in views]:
            page.evaluate(f"(location.hash = `token={wire.TOKEN}&view=` + encodeURIComponent("
                          f"{json.dumps(json.dumps(view))}), 0)")
            self.machine.listen(0.1)
        page.wait('Math.abs(viewer.camera.eye[2] - 50) < 1e-3')
        names = page.evaluate("[...document.querySelectorAll('.bookmarks .name')].map((one) => one.textContent)")
        assert names == ['x' * 60, 'place'], names
        assert page.evaluate('broken') == 0 and not page.errors, page.errors
        assert state(page, 'layout') == 'single' and state(page, 'navigate.mode') == 'fly'
        page.key('p')
        page.evaluate(f"(viewer.set('show-range', '{long}'), viewer.ask('name', {{ street: '{long}' }}, "
                      "({ refused }) => (globalThis.told = refused)), 0)")
        assert 'too long' in page.wait('globalThis.told')
        kept = json.dumps({'hash': f'#token={wire.TOKEN}', 'view': {'panes': 5, 'camera': 'x'}})
        page.evaluate(f"(location.hash = 'token={wire.TOKEN}', localStorage.setItem(`nocturne bookmarks "
                      f"${{viewer.scene.name}}`, '{{}}'), addEventListener('pagehide', () => "
                      f"sessionStorage.setItem('nocturne view', {json.dumps(kept)})), 0)")
        page.call('Page.reload')
        self.machine.listen(0.5)
        page.wait("globalThis.viewer?.state && document.querySelector('.picture').dataset.n", 60)
        assert not page.errors, page.errors

    def test_finds_by_name(self):
        page = self.page
        page.key('/')
        page.type('ring e')
        page.wait("document.querySelector('.found li')?.dataset.kind === 'street'")
        page.key('Enter')
        page.wait("document.querySelector('.answer h3')?.textContent === 'Who lights Ring East?'")
        page.wait("document.querySelectorAll('table.ranking tbody tr').length > 2")
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

    def test_map_keeps_its_place(self):
        """Closed and opened again it is as it was, until the whole city is asked for."""
        page = self.page
        scale = "(({ textContent, style }) => textContent + style.width)(document.querySelector('.map-scale'))"
        page.key('m')
        press_text(page, 'Whole city')
        self.machine.listen(0.2)
        whole = page.evaluate(scale)
        page.evaluate("document.querySelector('.map').focus()")
        for _ in range(4):
            page.key('+')
        page.wait(f"{scale} !== '{whole}'")
        self.machine.listen(0.2)
        near = page.evaluate(scale)
        page.key('Escape')
        page.wait("document.getElementById('right').hidden")
        page.key('t')
        press_text(page, 'Rectangle on map')
        self.machine.listen(0.3)
        assert page.evaluate(scale) == near, (whole, near)
        page.key('Escape')
        press_text(page, 'Whole city')
        page.wait(f"{scale} === '{whole}'")
        page.key('Escape')

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
        assert 'sets hour 3, lamps 0.5' in titles, titles
        page.evaluate("(document.querySelector('input[type=search]').value = '', 0)")
        page.key('Escape')
        page.wait("document.getElementById('left').hidden")

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
        press_choice(page, 'fly')
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

    def test_wide_photograph(self):
        """One that is wider than the picture's room fits in, and pairs can be set at its sides."""
        page = opened(self.machine, self.served.link, width=1000, height=500)
        page.key('o')
        page.wait("document.getElementById('photo-file')?.checkVisibility()")
        page.evaluate('''(async () => {
            const canvas = new OffscreenCanvas(800, 200);
            canvas.getContext('2d').fillRect(0, 0, 800, 200);
            const files = new DataTransfer();
            files.items.add(new File([await canvas.convertToBlob()], 'wide.png', { type: 'image/png' }));
            const box = document.getElementById('photo-file');
            box.files = files.files;
            box.dispatchEvent(new Event('change'));
        })()''')
        shape = "(({ width, height }) => width / height)(document.querySelector('.picture'))"
        page.wait(f'Math.abs({shape} - 4) < 0.1')
        press_text(page, 'Set pairs')
        page.click(*on_stage(page, (0.01, 0.5)))
        page.wait("document.querySelector('#right').innerText.includes('same point')")
        press_text(page, 'Take away')
        page.wait(f'{shape} < 3')
        assert not page.errors, page.errors
        page.close()

    def test_ids_break_behind_signs(self):
        parts = self.page.evaluate("import('./dom.js').then(({ breaks }) => breaks('DEBY_LOD2_4959457-a')"
                                   ".map((one) => one.tagName ?? one))")
        assert parts == ['DEBY_', 'WBR', 'LOD2_', 'WBR', '4959457-', 'WBR', 'a'], parts


if __name__ == '__main__':
    run(Places)
