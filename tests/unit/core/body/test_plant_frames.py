"""The frames of plants one after the other are measured as plant by plant."""

import numpy as np

from motionedit.core.body.contacts import Plant
from motionedit.core.body.plant_frames import frames_of


def test_values_means_and_medians_are_those_of_each_plant_by_itself():
    rng = np.random.default_rng(2)
    spans = [(0, 3, 0), (2, 2, 1), (5, 11, 0), (4, 9, 1)]
    plants = [Plant("left", "heel", 7, point, start, stop, 0.0) for start, stop, point in spans]
    values, places = rng.normal(size=(12, 2)), rng.normal(size=(12, 2, 3))
    down = frames_of(plants)
    alone = [values[start : stop + 1, point] for start, stop, point in spans]
    np.testing.assert_array_equal(down.of(values), np.concatenate(alone))
    np.testing.assert_array_equal(down.medians(down.of(values)), [np.median(each) for each in alone])
    np.testing.assert_allclose(down.means(down.of(values)), [each.mean() for each in alone], rtol=1e-14)
    means = [places[start : stop + 1, point].mean(axis=0) for start, stop, point in spans]
    np.testing.assert_allclose(down.means(down.of(places)), means, rtol=1e-13)
    np.testing.assert_array_equal(down.spread(down.counts), [4] * 4 + [1] + [7] * 7 + [6] * 6)


def test_of_no_plants_there_are_no_frames():
    assert frames_of([]) is None
