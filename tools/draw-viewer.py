#!/usr/bin/env python3
"""draw-viewer.py [FOLDER]: screenshots of every mode and layout of the viewer, at 1280x720 and on a phone, into FOLDER
(default: viewer-pictures), to be looked at. --docs: the few that docs/viewer.md shows, into docs/viewer/. Needs
Chromium, and build/nocturne (or NOC_PROGRAM)."""
import os
import sys

SOURCE = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
sys.path.insert(0, os.path.join(SOURCE, 'tests', 'viewer'))
os.environ.setdefault('NOC_PROGRAM', os.path.join(SOURCE, 'build', 'nocturne'))
import browser  # noqa: E402
import wire  # noqa: E402

REST = 4  # seconds in which pictures become what they are


def ready(page):
    page.wait("globalThis.viewer?.state && document.querySelector('.picture').dataset.n", 120)


def shown(page, rest):
    """Waits for pictures of what was asked for: the second that comes was begun after it."""
    page.evaluate('''new Promise((done) => {
        let left = 2;
        const watch = new MutationObserver(() => --left || (watch.disconnect(), done()));
        watch.observe(document.querySelector('.picture'), { attributes: true, attributeFilter: ['data-frames'] });
        setTimeout(done, 6000); // there are no more
    })''')
    page.browser.listen(rest)


def panel(page, name, opened=True):
    page.evaluate(f'''(() => {{
        const tab = [...document.querySelectorAll('#tabs button')].find((one) => one.textContent === '{name}');
        if ((tab.getAttribute('aria-expanded') === 'true') !== {str(opened).lower()}) tab.click();
        document.activeElement.blur();
    }})()''')


def layout(page, name):
    page.evaluate(f"document.querySelector('#layouts button[data-name={name}]').click()")
    page.wait(f"viewer.state.layout === '{name}'")
    page.wait("[...document.querySelectorAll('.picture')].every((one) => one.dataset.n)", 120)


def pick(page, x, y):
    box = page.evaluate("(({ left, top, width, height }) => [left, top, width, height])"
                        "(document.querySelector('.pane').getBoundingClientRect())")
    page.click(box[0] + x * box[2], box[1] + y * box[3])
    page.wait("document.querySelectorAll('table.ranking tbody tr').length > 2", 60)


def show(page, mode):
    page.evaluate(f"viewer.set('show', '{mode}')")
    page.wait(f"viewer.state.panes[0].values.show === '{mode}'")


def every(machine, link, folder):
    """All there is to be seen."""
    windows = (('wide', 1280, 720, False), ('phone', 390, 844, True), ('lying', 844, 390, True))
    for name, width, height, phone in windows:
        page = machine.page(link, width, height, phone)
        ready(page)

        def shot(what, rest=REST):
            shown(page, rest)
            page.screenshot(os.path.join(folder, f'{name}-{what}.png'))

        shot('picture')
        for mode in page.evaluate('viewer.schema.modes.map((one) => one.name)'):
            show(page, mode)
            shot(f'mode-{mode}', 0)
        show(page, page.evaluate('viewer.schema.modes[0].name'))
        page.press('#more')
        shot('more', 0)
        page.press('#more')
        for one in ('divider', 'methods', 'difference'):
            layout(page, one)
            shot(f'layout-{one}')
        layout(page, 'single')
        for one in ('Settings', 'Map', 'Lights', 'Photo', 'Places', 'Out'):
            panel(page, one)
            if one == 'Lights':
                pick(page, 0.5, 0.75)
            shot(f'panel-{one.lower()}', 0)
            panel(page, one, False)
        if page.errors:
            print(f'{name}: {page.errors}')
        page.close()


def for_docs(machine, link, folder):
    page = machine.page(link, 1280, 720)
    ready(page)
    page.viewport(1280, 720, density=0.75)
    panel(page, 'Settings')
    panel(page, 'Map')
    shown(page, REST)
    page.screenshot(os.path.join(folder, 'settings-map.png'))
    panel(page, 'Settings', False)
    panel(page, 'Lights')
    pick(page, 0.45, 0.75)
    shown(page, REST)
    page.screenshot(os.path.join(folder, 'who-lights-this.png'))
    panel(page, 'Lights', False)
    show(page, 'illuminance')
    shown(page, REST)
    page.screenshot(os.path.join(folder, 'illuminance.png'))
    show(page, page.evaluate('viewer.schema.modes[0].name'))
    layout(page, 'methods')
    shown(page, REST)
    page.screenshot(os.path.join(folder, 'methods.png'))
    layout(page, 'divider')  # sodium at 21 h, and LED at 3 h, at half
    shown(page, 2 * REST)
    page.press('.hold')
    panel(page, 'Settings')
    for text in ('All LED', 'Deep night, 3 h, lamps at half'):
        page.evaluate(f'''[...document.querySelectorAll('.presets button')]
            .find((one) => one.textContent === '{text}').click()''')
    page.wait("viewer.state.world.values['group.lamps'] === '0.5,4000K'")
    page.browser.listen(2 * REST)
    page.screenshot(os.path.join(folder, 'before-and-after.png'))
    page.close()
    page = machine.page(link, 390, 844, True)
    ready(page)
    page.viewport(390, 844, True, density=1)
    page.press('#views button[data-name=illuminance]')
    page.press('#more')
    shown(page, REST)
    page.screenshot(os.path.join(folder, 'phone.png'))
    page.close()


def main():
    if '-h' in sys.argv or '--help' in sys.argv:
        print(__doc__)
        return
    docs = '--docs' in sys.argv
    rest = [one for one in sys.argv[1:] if one != '--docs']
    folder = os.path.join(SOURCE, 'docs', 'viewer') if docs else rest[0] if rest else 'viewer-pictures'
    os.makedirs(folder, exist_ok=True)
    served = wire.Program()
    try:
        with browser.Browser() as machine:
            (for_docs if docs else every)(machine, served.link, folder)
    finally:
        served.end()


if __name__ == '__main__':
    main()
