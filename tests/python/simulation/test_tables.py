from __future__ import annotations

import numpy as np
from voxshell.simulation.tables import (
    as_contacts,
    as_hits,
    as_timings,
    compute_forces,
    take_contacts,
)


def test_contacts_take_their_columns_in_order():
    rows = np.arange(34.0).reshape(2, 17)
    table = as_contacts(rows)
    assert table.shape == (2,)
    second = table[1]
    assert [second[name].tolist() for name in table.dtype.names or ()] == [
        17,
        18,
        19,
        [20.0, 21.0, 22.0],
        [23.0, 24.0, 25.0],
        [26.0, 27.0, 28.0],
        29.0,
        30.0,
        [31.0, 32.0, 33.0],
    ]


def test_contacts_of_a_body_are_turned_so_that_it_is_body_a():
    rows = np.arange(68.0).reshape(4, 17)
    rows[:, :2] = (1, 2), (3, 1), (2, 3), (2, 1)
    given = rows.copy()
    table = as_contacts(take_contacts(rows, 1))
    np.testing.assert_array_equal(rows, given)
    assert table["body_a"].tolist() == [1, 1, 1]
    assert table["body_b"].tolist() == [2, 3, 2]
    assert table["id"].tolist() == [2, 19, 53]
    assert table["point_a"][:, 0].tolist() == [3.0, 23.0, 57.0]
    assert table["point_b"][:, 0].tolist() == [6.0, 20.0, 54.0]
    assert table["normal"][:, 2].tolist() == [11.0, -28.0, -62.0]
    assert table["depth"].tolist() == [12.0, 29.0, 63.0]
    assert table["friction"][:, 0].tolist() == [14.0, -31.0, -65.0]
    assert as_contacts(take_contacts(rows, 1, 2))["impulse"].tolist() == [13.0, 64.0]
    assert len(take_contacts(rows, 4)) == len(take_contacts(np.empty((0, 17)), 1)) == 0


def test_forces_act_on_the_dynamic_body_and_on_body_a_if_both_are():
    table = np.zeros(3, as_contacts(np.empty((0, 17))).dtype)
    table["body_a"], table["body_b"] = (1, 0, 2), (0, 1, 1)
    table["normal"], table["impulse"] = (0.0, 0.0, 1.0), 0.02
    forces = compute_forces(table, [1, 2], 0.01)
    np.testing.assert_allclose(forces[:, 2], [2.0, -2.0, 2.0])


def test_hits_take_their_columns_in_order():
    [hit] = as_hits(np.arange(8.0)[None])
    assert (hit["body"], hit["fraction"]) == (0, 1.0)
    assert (hit["point"].tolist(), hit["normal"].tolist()) == ([2.0, 3.0, 4.0], [5.0, 6.0, 7.0])


def test_timings_are_not_copied():
    rows = np.arange(10.0).reshape(2, 5)
    table = as_timings(rows)
    assert table["step"].tolist() == [0.0, 5.0]
    assert table["manifold"].tolist() == [4.0, 9.0]
    assert np.shares_memory(rows, table)


def test_nothing_is_an_empty_table():
    assert len(as_contacts(np.empty((0, 17)))) == len(as_hits(np.empty((0, 8)))) == 0
