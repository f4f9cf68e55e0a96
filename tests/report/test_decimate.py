import numpy as np

from surae.report.traces import extremes, min_max


def test_peaks_stay():
    rng = np.random.default_rng(0)
    time = np.arange(100_000) / 1000
    values = rng.standard_normal(100_000)
    values[33_333], values[77_777] = 50.0, -40.0
    t, v = min_max(time, values, 4000)
    assert len(v) <= 4002
    assert v.max() == 50.0
    assert v.min() == -40.0
    assert t[v.argmax()] == time[33_333]
    assert (t[0], t[-1]) == (time[0], time[-1])
    assert np.all(np.diff(t) > 0)


def test_every_stretch_keeps_its_extremes():
    time = np.arange(6000.0)
    values = np.random.default_rng(1).standard_normal(6000)
    t, v = min_max(time, values, 2000)
    for begin in range(0, 6000, 6):
        inside = (t >= begin) & (t < begin + 6)
        assert v[inside].max() == values[begin : begin + 6].max()
        assert v[inside].min() == values[begin : begin + 6].min()


def test_a_short_signal_is_left_alone():
    time = np.arange(4000.0)
    t, v = min_max(time, time, 4000)
    assert np.array_equal(t, time)
    assert np.array_equal(v, time)


def test_signals_shown_together_lose_no_peak_of_any():
    rng = np.random.default_rng(2)
    signals = rng.standard_normal((3, 50_000))
    signals[0, 11_111], signals[1, 22_222], signals[2, 33_333] = 50.0, -40.0, 30.0
    index = extremes(list(signals), 2000)
    assert len(index) <= 2002
    assert {0, 11_111, 22_222, 33_333, 49_999} <= set(index.tolist())
    assert np.all(np.diff(index) > 0)


def test_a_fast_chirp_keeps_its_amplitude():
    time = np.arange(0.0, 40.0, 1.0 / 1024.0)
    chirp = np.sin(2 * np.pi * 0.3 * time**2)
    shown = chirp[extremes([chirp], 2000)]
    late = shown[len(shown) // 2 :]
    assert np.quantile(np.abs(late), 0.2) > 0.9  # every 20th sample alone would beat to 0
