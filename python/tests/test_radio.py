"""Programs that command the radios of their stations."""

from __future__ import annotations

import math
from collections.abc import Generator

import pytest
from conftest import SCENARIOS

import sextant

Waits = Generator[sextant.Wait, "sextant.RadioEvent | None", None]

#: The node sends 20 octets, 832 us on air, and turns around for 192 us before.
SLOT_S = 1.1e-3


class SlottedAloha(sextant.RadioProgram):
    """Sends in each slot with a probability."""

    def __init__(self, probability: float, slot_s: float = SLOT_S) -> None:
        self.probability, self.slot_s = probability, slot_s

    def run(self, port: sextant.Port) -> Waits:
        radio, slot = port.radio(), 0
        while True:
            slot += 1
            while port.random.random() >= self.probability:
                slot += 1
            yield sextant.wait(seconds=slot * self.slot_s - radio.turnaround_s - port.now_s)
            packet = radio.offer(9)
            radio.transmit(b"a reading", packet=packet)
            yield sextant.wait("sent")
            radio.done(packet)


def scenario(**settings: object) -> sextant.Scenario:
    own = {"mac.program.wake_up_us": 192.0, "reception": "overlap", **settings}
    return sextant.Scenario(SCENARIOS / "mac" / "own-radio.toml", **own)


def test_slotted_aloha_brings_the_throughput_of_its_closed_form() -> None:
    nodes, probability, duration_s = 10, 0.1, 60.0
    programs = {f"n{i}": SlottedAloha(probability) for i in range(nodes)}
    run = scenario(duration_s=duration_s).run(applications=programs)
    slots = duration_s / SLOT_S
    expected = nodes * probability * (1 - probability) ** (nodes - 1)
    assert abs(expected - 0.3874) < 1e-4
    found = run.summary["mac"]["delivered"] / slots
    # Slots are independent: four deviations, a false alarm in 16000 runs.
    assert abs(found - expected) < 4 * math.sqrt(expected * (1 - expected) / slots), found


class Listener(sextant.Application):
    """Listens for a second on each of two channels."""

    def __init__(self) -> None:
        self.events: list[tuple[str, float]] = []
        self.frames: list[sextant.RadioEvent] = []
        self.energy_j: list[float] = []

    def started(self, port: sextant.Port) -> None:
        radio = port.radio()
        assert (radio.state, radio.channel, radio.earliest_s) == ("sleep", 26, pytest.approx(192e-6))
        radio.listen(1.0)

    def radio(self, event: sextant.RadioEvent, port: sextant.Port) -> None:
        radio = port.radio()
        self.events.append((event.kind, round(port.now_s, 6)))
        self.energy_j.append(radio.energy_j)
        if event.kind == "received":
            self.frames.append(event)
        if event.kind == "window-over" and radio.channel == 26:
            radio.tune(15)
            radio.listen(2.5, from_s=1.5)


class Caller(sextant.RadioProgram):
    """Calls the listener on two channels."""

    def __init__(self) -> None:
        self.kinds: list[str] = []
        self.refused: list[str] = []

    def run(self, port: sextant.Port) -> Waits:
        radio = port.radio()
        for at_s, channel in ((0.5, 26), (2.0, 15)):
            radio.tune(channel)
            with pytest.raises(sextant.RunError) as error:
                radio.transmit(b"early", "n1", at_s=port.now_s)
            self.refused.append(str(error.value))
            radio.transmit(b"hello", "n1", at_s=at_s, acknowledged=True)
            event = yield sextant.wait("acknowledged", "unacknowledged")
            assert event is not None
            self.kinds.append(event.kind)
            assert (yield sextant.wait("received", seconds=0.1)) is None


def test_a_window_on_each_of_two_channels_hears_what_is_sent_there() -> None:
    caller, listener = Caller(), Listener()
    scenario().run(applications={"n0": caller, "n1": listener})
    assert caller.kinds == ["acknowledged", "acknowledged"]
    assert all("because the radio needs that time to turn around" in words for words in caller.refused)
    assert [kind for kind, _ in listener.events] == 2 * ["ready", "began", "received", "ready", "window-over"]
    assert listener.events[0] == ("ready", 192e-6) and listener.events[4] == ("window-over", 1.0)
    first = listener.frames[0]
    assert (first.sender, first.to, first.payload, first.acknowledged) == ("n0", "n1", b"hello", True)
    assert first.start_s == pytest.approx(0.5) and first.end_s == pytest.approx(0.5 + 22 * 32e-6)
    assert first.lqi == 255 and first.power_dbm is not None and first.power_dbm < 0.0
    assert listener.energy_j == sorted(listener.energy_j)


class Saver(sextant.Application):
    """Listens until half of its battery is left, and then sleeps."""

    def __init__(self) -> None:
        self.left_j: list[float | None] = []
        self.slept_s: float | None = None

    def started(self, port: sextant.Port) -> None:
        self.left_j.append(port.charge_j)
        port.radio().receive()
        port.after(0.1, 1)

    def timer(self, timer: int, port: sextant.Port) -> None:
        left_j = port.charge_j
        self.left_j.append(left_j)
        if left_j is None:
            return
        if left_j < 0.282:
            port.radio().off()
            self.slept_s = port.now_s
        else:
            port.after(0.1, 1)


def test_a_program_knows_what_is_left_in_its_battery() -> None:
    saver = Saver()
    # 0.564 J: ten seconds at 56.4 mW.
    own = {"duration_s": 20.0, "battery": {"capacity_j": 0.564}}
    run = scenario(**own).run(applications={"n0": saver})
    assert saver.left_j[:2] == [pytest.approx(0.564), pytest.approx(0.564 - 0.1 * 0.0564, abs=1e-5)]
    assert saver.slept_s == pytest.approx(5.1)
    node = run.summary["battery"]["nodes"][0]
    assert node["left_j"] == pytest.approx(0.564 - 5.1 * 0.0564 - 14.9 * 60e-6, abs=1e-5)
    silent = Saver()
    scenario(duration_s=1.0).run(applications={"n0": silent})
    assert silent.left_j == [None, None]


def test_what_a_radio_cannot_do_says_why() -> None:
    class Asks(sextant.Application):
        def started(self, port: sextant.Port) -> None:
            radio = port.radio()
            for call, words in (
                (lambda: radio.tune(14), "the channel is 14; allowed"),
                (lambda: radio.set_power(1.0), "the transmit power is 1 dBm"),
                (lambda: radio.transmit(bytes(117)), "the payload has 117 octets; allowed: at most 116"),
                (lambda: radio.transmit(b"", "n0"), "`n0` cannot receive the frame"),
                (lambda: radio.assess(), "the receiver is not on"),
                (lambda: radio.done(7), "there is no open packet number 7"),
                (lambda: radio.set_ack_wait(1e-6), "allowed: at least 544"),
            ):
                with pytest.raises(sextant.RunError, match=words):
                    call()
            with pytest.raises(ValueError, match='the outcome is "lost"'):
                radio.done(7, "lost")
            with pytest.raises(KeyError, match="there is no station `n99`"):
                radio.transmit(b"", "n99")

    scenario().run(applications={"n0": Asks()})


def test_a_network_with_channel_access_has_no_radio_for_programs() -> None:
    class Asks(sextant.Application):
        def started(self, port: sextant.Port) -> None:
            with pytest.raises(sextant.RunError, match="only with `mac.program`"):
                port.radio()
            port.send(b"a reading")

    star = sextant.Scenario(SCENARIOS / "mac" / "one-shot-star.toml")
    star.run(applications={"n0": Asks()})


def test_nothing_to_wait_for_is_refused() -> None:
    with pytest.raises(ValueError, match="nothing to wait for"):
        sextant.wait()
