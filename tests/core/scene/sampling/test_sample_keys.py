"""Numbers of objects and contacts, from which keys of samples are made."""

from __future__ import annotations

import numpy as np

import pacinian as pc
from pacinian.scene.sampling.posed_skin import PosedSkin
from pacinian.scene.sampling.sample_keys import NUMBERS, make_keys, number_contact, number_object

NAMES = ["", "ball", "ball 2", "péntek", "x" * 200]
HANDS = [PosedSkin(pc.Hand.open("right", name=name)) for name in ("right", "left", "3rd")]


def make(name: str) -> pc.Point:
    return pc.Point(name=name, position=(0.0, 0.0, 0.2), radiation_pressure=1.0)


def test_a_name_decides_and_without_one_the_index() -> None:
    for name in NAMES[1:]:
        assert number_object(make(name), 3) == number_object(make(name), 7)
    assert [number_object(make(""), i) for i in range(5)] == list(range(5))
    assert len({number_object(make(name), 12345) for name in NAMES}) == len(NAMES)


def test_each_hand_has_a_number_of_its_own_for_each_object() -> None:
    numbers = {number_contact(number_object(make(n), 0), hand) for n in NAMES for hand in HANDS}
    assert len(numbers) == len(NAMES) * len(HANDS)


def test_keys_of_the_largest_number_fit_into_64_bits() -> None:
    numbers = [number_object(make(name), 0) for name in NAMES] + [NUMBERS - 1]
    numbers += [number_contact(number, hand) for number in numbers for hand in HANDS]
    assert all(0 <= number < NUMBERS for number in numbers)
    assert make_keys(NUMBERS - 1, 0.0, np.array([5])).tolist() == [((NUMBERS - 1) << 31) + 5]
