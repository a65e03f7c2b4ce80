"""The unit that a clip is likely in, and names as `info` shows them."""

import pytest
import yaml

from motionedit.jobs.clip.unit import likely_unit
from motionedit.jobs.info.text import flow, shown_name


@pytest.mark.parametrize(
    ("leg", "name", "likely"),
    [(0.85, "m", True), (91.0, "cm", True), (800.0, "mm", True), (33.0, "in", True), (15.0, "cmu", True),
     (8.0, "cmu", False)],
)  # fmt: skip
def test_the_likely_unit_makes_the_leg_nearest_a_humans(leg, name, likely):
    unit = likely_unit(leg)
    assert (unit["name"], unit["likely"]) == (name, likely)


def test_no_length_has_no_unit():
    assert likely_unit(0.0) is None


@pytest.mark.parametrize(
    "name", ["LeftHand", "mixamorig:Hips", "foot.L", "left foot", "001", "yes", "a: b", 'q"t', "左足"]
)
def test_names_in_yaml_are_read_back_as_they_are(name):
    assert yaml.safe_load(flow(name)) == name
    assert yaml.safe_load(flow({"joint": name, "offset": [0.0, -92.5, 1e-7]}))["joint"] == name


def test_names_with_blanks_at_their_ends_are_shown_in_quotes():
    assert shown_name("Hips ") == '"Hips "'
    assert shown_name("left foot") == "left foot"
