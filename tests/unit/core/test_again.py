"""Results are found again by the very thing that they were made of, and only the last few are kept."""

from motionedit.core.again import LastFew, Same, once


def test_a_thing_is_the_same_as_itself_and_not_as_its_equal():
    one, other = [1], [1]
    assert Same(one) == Same(one) != Same(other)
    assert Same(one) != one
    assert len({Same(one), Same(one), Same(other)}) == 2


def test_the_oldest_result_goes_first():
    few = LastFew(2)
    for key in "abc":
        assert few.keep(key, key.upper()) == key.upper()
    assert [few.get(key) for key in "abc"] == [None, "B", "C"]


def test_what_is_made_once_is_made_when_it_is_first_asked_for_be_it_nothing():
    made = []
    nothing = once(lambda: made.append(1))
    assert made == []
    assert [nothing(), nothing()] == [None, None]
    assert made == [1]
