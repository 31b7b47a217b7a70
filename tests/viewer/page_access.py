#!/usr/bin/env python3
"""The page for who does not see, point or have much room."""
import json

from leaf import Opened, blur, camera, opened, press_text, rests, run


class Access(Opened):
    def test_by_keys_alone(self):
        page = self.page
        blur(page)
        page.evaluate("document.getElementById('stage').focus()")
        page.key('?', shift=True)
        page.wait("document.getElementById('help').open")
        page.key('Escape')
        page.wait("!document.getElementById('help').open")
        focused = 'document.activeElement.id || document.activeElement.textContent'

        def tab_to(wanted):  # the tab key comes to every panel's button
            seen = []
            while page.evaluate(focused) != wanted:
                page.key('Tab')
                seen.append(page.evaluate(focused))
                assert len(seen) < 40, seen

        tab_to('more')
        page.key('Enter')
        page.wait("!document.getElementById('laboratory').hidden")
        tab_to('Settings')
        page.key('Enter')
        page.wait("!document.getElementById('left').hidden")
        assert page.evaluate("document.getElementById('laboratory').hidden"), 'two things are beside the picture'
        page.key('Escape')
        page.wait("document.getElementById('left').hidden")
        assert page.evaluate(focused) == 'more', 'the focus did not come back'
        page.evaluate("document.querySelector('#views button[tabindex=\"0\"]').focus()")
        page.key('ArrowRight')
        name = page.evaluate('document.activeElement.dataset.name')
        page.wait(f"viewer.state.panes[0].values.show === '{name}'")
        page.key('ArrowLeft')
        page.wait("viewer.state.panes[0].values.show === 'picture'")

    def test_more(self):
        """Three buttons say what is shown; all else that can be is behind one that discloses it, for this session."""
        page = opened(self.machine, self.served.link, width=1280, height=720)
        seen = "[...document.querySelectorAll('%s')].filter((one) => one.checkVisibility()).map((one) => one.innerText)"
        assert page.evaluate(seen % '#views button') == ['Picture', 'Lux', 'Who lights it']
        assert page.evaluate(seen % '#layouts button, #modes button') == []
        more = "(({ ariaExpanded: on, textContent: says }) => `${on},${says}`)(document.getElementById('more'))"
        assert page.evaluate(more) == 'false,More'
        assert page.evaluate("document.getElementById(document.getElementById('more').getAttribute('aria-controls'))"
                             "?.id") == 'laboratory'
        page.evaluate("document.getElementById('more').focus()")
        page.key(' ')
        page.wait(f"{more} === 'true,More'")
        assert page.evaluate(seen % '#layouts button') == ['One', 'A|B', 'Methods', 'Difference']
        assert page.evaluate((seen % '#modes button') + '.length') == page.evaluate('viewer.schema.modes.length - 3')
        page.key('Tab')  # into what it discloses
        assert page.evaluate("document.activeElement.closest('#laboratory') !== null")
        page.evaluate("document.querySelector('#modes [data-name=depth]').click()")
        page.wait("viewer.stats[0].show === 'depth'")
        assert page.evaluate(more) == 'true,More: depth'
        assert page.evaluate("document.querySelectorAll('#views [aria-checked=true]').length") == 0
        page.reload()
        page.wait("globalThis.viewer?.state && document.querySelector('.picture').dataset.n", 60)
        page.wait(f"{more} === 'true,More: depth'")
        other = opened(self.machine, self.served.link, width=1280, height=720)
        assert other.evaluate(more) == 'false,More', 'another session has it'
        other.close()
        page.evaluate("document.querySelector('#layouts [tabindex=\"0\"]').focus()")
        page.key('Escape')
        page.wait(f"{more} === 'false,More: depth'")
        assert page.evaluate('document.activeElement.id') == 'more', 'the focus is lost'
        page.reload()
        page.wait(f"globalThis.viewer?.state && {more} === 'false,More: depth'")
        for key, name in (('2', 'illuminance'), ('3', 'influential'), ('1', 'picture')):
            page.key(key)
            page.wait(f"document.querySelector('#views [data-name={name}]').ariaChecked === 'true'")
        for width, behind in ((1000, ['moving']), (640, ['tabs', 'moving']), (1000, ['moving']), (1280, [])):
            page.viewport(width, 720)
            page.wait(f"innerWidth === {width} && JSON.stringify([...document.querySelectorAll('#laboratory > [id]')]"
                      f".map(({{ id }}) => id)) === '{json.dumps(behind, separators=(',', ':'))}'")
        last = page.evaluate("[...document.querySelectorAll('#bar > *')].slice(-2).map(({ id }) => id)")
        assert last == ['moving', 'tabs'], last
        assert not page.errors, page.errors
        page.close()

    def test_everything_has_a_key_a_name_and_a_focus(self):
        """Tab reaches every control that is seen; each has a name, and shows that it has the focus."""
        page = self.page
        page.viewport(1280, 720)
        page.press('#more')
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
            const seen = all.filter((one) => one.checkVisibility() && !one.disabled && one.tabIndex >= 0
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
        blur(page)
        page.key('Escape')
        page.key('Escape')
        page.key('Escape')
        page.wait("['left', 'right', 'laboratory'].every((id) => document.getElementById(id).hidden)")
        page.viewport(640, 420)
        page.wait('innerWidth === 640')
        roles = page.evaluate("""['said', 'toasts', 'loading'].map((id) => document.getElementById(id))
            .map((one) => one.getAttribute('aria-live') ?? one.getAttribute('role'))""")
        assert roles == ['polite', 'polite', 'status'], roles

    def test_escape_closes_from_everywhere(self):
        """What is begun is left first, then what is open is closed: that with the focus, else the newest."""
        page = self.page
        shut = "document.getElementById('%s').hidden"
        for _ in range(2):
            page.click(320, 330)
            page.wait(f"!({shut % 'right'})")  # a click waits for a second one
            page.wait("document.querySelectorAll('table.ranking tbody tr').length > 2")
            assert page.evaluate("document.activeElement.id") == 'stage'
            page.key('Escape')
            page.wait(shut % 'right')
        page.viewport(1000, 420)  # which has room for both
        page.wait('innerWidth === 1000')
        page.key('p')
        page.key('b')
        blur(page)
        page.key('Escape')
        page.wait(f"{shut % 'right'} && !({shut % 'left'})")
        page.key('Escape')
        page.wait(shut % 'left')
        page.viewport(640, 420)
        page.key('t')
        press_text(page, 'Polygon on map')
        page.wait("document.querySelector('.map-body').innerText.includes('Click the corners')")
        page.evaluate("document.getElementById('stage').focus()")
        page.key('Escape')
        page.wait("!document.querySelector('.map-body').innerText.includes('Click the corners')")
        assert not page.evaluate(shut % 'right')
        page.key('h')
        page.wait("document.body.classList.contains('bare')")
        page.key('Escape')
        page.wait("!document.body.classList.contains('bare')")
        page.key('Escape')
        page.wait(shut % 'right')

    def test_an_answer_has_the_focus(self):
        page = self.page
        page.evaluate("viewer.goTo('aerial')")
        page.wait("viewer.state.camera.name === 'aerial'")
        rests(page)
        page.key('t')
        page.evaluate("[...document.querySelectorAll('.panel button')].find((one) => one.textContent === 'Middle')"
                      ".focus()")
        page.key('Enter')
        page.wait("document.querySelectorAll('table.ranking tbody tr').length > 2")
        assert page.evaluate("document.activeElement.className") == 'answer'
        for _ in range(2):  # to its first row or button, whatever pictures and answers come
            page.key('Tab')
        assert page.evaluate("document.activeElement.closest('.answer') !== null")
        page.key('Escape')
        page.wait("document.getElementById('right').hidden")
        page.evaluate("viewer.goTo('street')")
        page.wait("viewer.state.camera.name === 'street'")
        rests(page)

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
                if (!(own || field) || !one.offsetParent || one.closest(':disabled, .pane, .hidden, .legend')) continue;
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
            phone.wait(f'innerWidth === {width} && innerHeight === {height}')
            wide = phone.evaluate('document.documentElement.scrollWidth')
            assert wide <= width, f'the page is {wide} wide on {width}'
            self.has_room(phone, width, height)
        before = phone.wait('viewer.camera')
        phone.touch('touchStart', [(400, 250)])
        for x in range(410, 500, 10):
            phone.touch('touchMove', [(x, 250)])
        phone.touch('touchEnd', [])
        phone.wait(f'Math.hypot(...viewer.camera.target.map((x, i) => x - {before["target"]}[i])) > 0.3')
        phone.wait("document.querySelector('.map-body').textContent.includes('two zoom')")
        assert 'wheel' not in phone.evaluate("document.querySelector('.map-body').textContent")
        assert not phone.errors, phone.errors
        phone.close()

    def has_room(self, phone, width, height):
        """One row of buttons, and half of the screen for the picture, whatever is opened beside it."""
        box = "document.getElementById('%s').getBoundingClientRect().toJSON()"
        bar = phone.evaluate(box % 'bar')
        tops = phone.evaluate("""[...document.querySelectorAll('#bar button')].filter((one) => one.offsetParent)
            .map((one) => one.getBoundingClientRect())
            .map(({ top, bottom, left, right }) => [top, bottom, left, right])""")
        assert len(tops) == 4 and bar['height'] <= 48 and bar['width'] == width, (tops, bar)
        assert all(0 <= top and bottom <= bar['bottom'] and bottom - top >= 32 for top, bottom, _, _ in tops), tops
        assert all(one[3] <= two[2] for one, two in zip(tops, tops[1:])) and tops[-1][3] <= width, tops

        def picture():
            stage = phone.evaluate(box % 'stage')
            return stage['width'] * stage['height'] / (width * height)

        assert picture() > 0.75, picture()
        phone.press('#more')
        phone.wait("!document.getElementById('laboratory').hidden")
        assert picture() >= 0.5, picture()
        over = phone.evaluate(f"(({{ top, left }}, stage) => top < stage.bottom - 1 && left < stage.right - 1)"
                              f"({box % 'laboratory'}, {box % 'stage'})")
        assert not over, 'it lies over the picture'
        phone.press('#tabs button')
        phone.wait("!document.getElementById('left').hidden && document.getElementById('laboratory').hidden")
        assert picture() >= 0.5, picture()
        phone.press('#more')
        phone.wait("document.getElementById('left').hidden && !document.getElementById('laboratory').hidden")
        phone.press('#more')
        phone.wait("document.getElementById('laboratory').hidden")


if __name__ == '__main__':
    run(Access)
