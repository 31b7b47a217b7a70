#!/usr/bin/env python3
"""The picture under a button is the button's: until it comes, the old one is dimmed and says what it waits for."""
from leaf import Opened, press_choice, press_text, rests, run

# Pictures that come are kept until release() shows the oldest; as long as none is shown, none of its pane follows.
KEEP = '''(() => {
    const emit = viewer.emit;
    globalThis.kept = [];
    viewer.emit = (kind, ...values) => (kind === 'picture' ? kept.push(values[0]) : emit.call(viewer, kind, ...values));
    globalThis.release = () => {
        const one = kept.shift();
        emit.call(viewer, 'picture', one);
        return one.n;
    };
    globalThis.free = () => {
        viewer.emit = emit;
        while (kept.length) release();
    };
})()'''
SAYS = '''[...document.querySelectorAll('.pane')].map((pane) => [pane.classList.contains('waiting'),
    pane.querySelector('.waits').textContent, !pane.querySelector('.lit').hidden])'''
MODE = '''(() => {
    const one = document.querySelector('[role=radio][data-name="%s"]');
    one.click();
    return one.getAttribute('aria-checked');
})()'''
AGREES = "document.querySelectorAll('.pane.waiting').length === 0"
LIT = 'headlight: lit from the camera'


def shown(page, n):
    page.wait(f"document.querySelector('.picture').dataset.n === '{n}'")


class Waits(Opened):
    def test_a_picture_waits_for_its_button(self):
        page = self.page
        page.wait(AGREES)
        page.evaluate(KEEP)
        page.evaluate("viewer.set('exposure', '0', 0, true)")  # one more picture of the old mode
        page.wait('kept.length === 1')
        assert page.evaluate(MODE % 'illuminance') == 'true', 'the button is not pressed at once'
        wanted = [[True, 'waiting for illuminance', False]]
        assert page.evaluate(SAYS) == wanted, page.evaluate(SAYS)
        page.wait("viewer.state.panes[0].values.show === 'illuminance'")
        shown(page, page.evaluate('release()'))
        assert page.evaluate(SAYS) == wanted, 'a picture of the old mode has ended it'
        opacity = "Number(getComputedStyle(document.querySelector('.picture')).opacity)"
        page.wait(f'{opacity} < 0.6')
        while page.evaluate(SAYS) == wanted:
            page.wait('kept.length === 1')
            before = page.evaluate('viewer.stats[0].show')
            shown(page, page.evaluate('release()'))
            assert (page.evaluate(SAYS) == wanted) == (before != 'illuminance'), before
        assert page.evaluate(SAYS) == [[False, '', False]]
        assert not page.evaluate("document.getElementById('legend').hidden")
        page.wait(f'{opacity} === 1')
        page.evaluate(MODE % 'picture')  # its legend stays with the old picture, and sets nothing
        page.wait("viewer.state.panes[0].values.show === 'picture'")
        assert page.evaluate(SAYS) == [[True, 'waiting for the picture', False]]
        legend = "(({ hidden, inert }) => [hidden, inert].join())(document.getElementById('legend'))"
        assert page.evaluate(legend) == 'false,true'
        page.evaluate('free()')
        page.wait(AGREES)
        page.wait(f"{legend} === 'true,false'")
        page.evaluate("viewer.set('exposure', 'auto')")

    def test_a_headlight_says_that_it_is_one(self):
        page = self.page
        page.wait(AGREES)
        assert page.evaluate("document.querySelector('.lit').textContent") == LIT
        page.evaluate(KEEP)
        page.key('z')
        page.wait("viewer.state.panes[0].values.method === 'headlight'")
        assert page.evaluate(SAYS) == [[True, 'waiting for the picture', False]], 'the old one is none'
        page.evaluate('free()')
        page.wait(AGREES)
        assert page.evaluate(SAYS) == [[False, '', True]]
        page.evaluate(KEEP)
        page.key('z')
        page.wait("viewer.state.panes[0].values.method === 'ris'")
        assert page.evaluate(SAYS) == [[True, 'waiting for the picture', True]]
        page.evaluate('free()')
        page.wait(AGREES)
        assert page.evaluate(SAYS) == [[False, '', False]]
        page.key('z')
        page.wait(f"{AGREES} && viewer.state.panes[0].values.method === 'headlight'")
        page.evaluate(MODE % 'illuminance')  # which is of the city's lights
        page.wait(f"viewer.stats[0].show === 'illuminance' && {AGREES}")
        assert page.evaluate('viewer.stats[0].method') == 'ris'
        assert not page.evaluate("document.querySelector('.toast.error')")
        page.evaluate(MODE % 'picture')
        page.wait(f"viewer.stats[0].show === 'picture' && {AGREES}")

    def test_what_is_refused_is_not_waited_for(self):
        page = self.page
        page.evaluate("viewer.set('method', 'is')")
        page.wait(f"viewer.state.panes[0].values.method === 'is' && {AGREES}")
        assert page.evaluate(MODE % 'lights') == 'true'
        page.wait("document.querySelector('.toast.error')?.textContent.includes('only ris and restir')")
        page.wait(AGREES)
        checked = "document.querySelector('[role=radio][data-name=picture]').getAttribute('aria-checked')"
        assert page.evaluate(checked) == 'true'
        page.evaluate("(document.querySelector('.toast.error').click(), viewer.set('method', 'ris'))")
        page.wait(f"viewer.state.panes[0].values.method === 'ris' && {AGREES}")

    def test_presets_wait_and_sliders_do_not(self):
        page = self.page
        page.key('p')
        rests(page)
        page.wait(AGREES)
        page.evaluate(KEEP)
        press_text(page, 'All sodium')
        page.wait("viewer.state.world.values['group.lamps'] === '1,2000K'")
        assert page.evaluate(SAYS) == [[True, 'waiting for the picture', False]]
        page.evaluate('free()')
        page.wait(AGREES)
        assert page.evaluate('viewer.stats[0].world >= viewer.state.world.version')
        page.evaluate("(viewer.waited = false, 0)")
        page.evaluate("viewer.on('waiting', () => (viewer.waited ||= viewer.waiting.size > 0))")
        for group, name in (('group.lamps', 'world'), ('draws', 'panes[0]')):
            before = page.evaluate(f"viewer.state.{name}.values['{group}']")
            page.evaluate(f'''(() => {{
                const slider = document.querySelector('.control[data-name="{group}"] input[type=range]');
                slider.value = slider.value < 300 ? 400 : 200;
                slider.dispatchEvent(new Event('input', {{ bubbles: true }}));
            }})()''')
            page.wait(f"viewer.state.{name}.values['{group}'] !== '{before}'")
        rests(page)
        assert not page.evaluate('viewer.waited'), 'the picture was dimmed while a slider was pulled'
        page.evaluate("(viewer.setWorld('group.lamps', '1,own'), viewer.set('draws', viewer.option('draws').value))")
        page.wait(f"viewer.state.world.values['group.lamps'] === '1,own' && {AGREES}")
        assert page.evaluate('viewer.waited')
        page.key('Escape')

    def test_each_pane_waits_for_its_own(self):
        page = self.page
        press_choice(page, 'divider')
        page.wait(f"viewer.state.layout === 'divider' && {AGREES}")
        page.evaluate('viewer.edit(1)')
        page.evaluate(KEEP)
        page.evaluate(MODE % 'illuminance')
        page.wait("viewer.state.panes[1].values.show === 'illuminance'")
        wanted = [[False, '', False], [True, 'waiting for illuminance', False]]
        assert page.evaluate(SAYS) == wanted, page.evaluate(SAYS)
        # a frame that fails has no picture, and no clock ends that
        page.evaluate('''viewer.connection.emit('t:state', { ...viewer.state, panes: viewer.state.panes.map((pane, i) =>
            ({ ...pane, failed: i === 1 })) })''')
        assert page.evaluate(SAYS)[1] == [True, 'illuminance: its frame failed', False]
        page.evaluate('free()')
        page.wait(AGREES)

    def test_what_is_held_waits_for_another_mode_alone(self):
        """A that is held is of other lamps, as it is meant to be, and lets go where it is to show something else."""
        page = self.page
        page.evaluate("(viewer.edit(0), viewer.set('show', 'picture', -1))")
        page.wait(f"viewer.state.panes[1].values.show === 'picture' && {AGREES}")
        rests(page, 2)
        page.press('.hold')
        page.wait(f"viewer.state.panes.every(({{ values }}) => values.exposure !== 'auto') && {AGREES}")
        page.evaluate("viewer.setWorld('group.lamps', '0.5,2000K')")
        page.wait("document.querySelector('.caption').textContent.includes('held')")
        page.wait(f"viewer.state.world.values['group.lamps'] === '0.5,2000K' && {AGREES}")
        assert 'held' in page.evaluate("document.querySelector('.caption').textContent")
        page.evaluate(KEEP)
        page.evaluate(MODE % 'illuminance')
        assert page.evaluate(SAYS)[0] == [True, 'waiting for illuminance', False]
        page.evaluate('free()')
        page.wait(AGREES)
        assert page.evaluate("document.querySelector('.hold').getAttribute('aria-pressed')") == 'false'
        assert 'A shows another mode' in page.evaluate("document.getElementById('toasts').textContent")
        page.evaluate("(viewer.setWorld('group.lamps', '1,own'), viewer.set('show', 'picture'))")
        page.wait(f"viewer.state.world.values['group.lamps'] === '1,own' && {AGREES}")
        press_choice(page, 'single')
        page.wait(f"viewer.state.layout === 'single' && {AGREES}")


if __name__ == '__main__':
    run(Waits)
