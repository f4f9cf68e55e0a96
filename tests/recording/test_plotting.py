"""A recording draws itself."""

import matplotlib.pyplot
import pytest

import surae


@pytest.fixture(autouse=True)
def no_window():
    matplotlib.use("agg")
    yield
    matplotlib.pyplot.close("all")


def test_every_kind_of_signal_has_its_panel():
    recording = surae.example()
    panels = recording.plot()
    assert [p.get_ylabel() for p in panels] == ["angle [°]", "torque [Nm]", "emg [mV]"]
    named = [tick.get_text() for tick in panels[2].get_yticklabels()]
    assert named == ["emg ta", "emg gl", "emg sol", "emg gm"]  # one below the other, on one scale
    stacked = [line.get_ydata() for line in panels[2].lines[:4]]
    for role, zero, line in zip(named, panels[2].get_yticks(), stacked, strict=True):
        own = 1e3 * recording.channels[role.replace(" ", "_")].values
        assert line - zero == pytest.approx(own)
    assert next(text.get_text() for text in panels[2].texts).endswith(" mV")
    channel = recording.channels["angle"]
    drawn = panels[0].lines[0].get_ydata()
    assert drawn == pytest.approx(channel.values * 57.29577951308232)


def test_measures_of_a_fit_by_its_package():
    class Told:
        def measures(self, angles):
            return list(angles)

    assert surae.measures(Told(), [5.0]) == [5.0]
    assert surae.measures is surae.measures  # whether or not it was imported before
    assert surae.measures.ANGLES == (-10.0, 0.0, 10.0)
