from __future__ import annotations

import threading

import numpy as np
import voxshell as vx
from poses import at, turned
from queries import wrench


def test_a_scratch_changes_no_answer(ball: vx.Model, cube: vx.Model):
    scratch = vx.QueryScratch()
    contacts = 0
    for i in range(60):
        pose = at(0.05, 0.02, 0.62 - 0.001 * i) @ turned((1, 2, 3), 0.01 * i)
        for shell in ("auto", "fewest", "a", "b", "both"):
            new = vx.contacts(ball, cube, pose, shell=shell)
            old = vx.contacts(ball, cube, pose, shell=shell, scratch=scratch)
            np.testing.assert_array_equal(new.points_b, old.points_b)
            contacts += len(new)
        few = vx.contacts(ball, cube, pose, budget=20, scratch=scratch)
        np.testing.assert_array_equal(vx.contacts(ball, cube, pose, budget=20).ids, few.ids)
        assert (
            vx.distance(ball, cube, pose, scratch=scratch).distance
            == vx.distance(ball, cube, pose).distance
        )
        np.testing.assert_array_equal(
            wrench(ball, cube, pose, scratch=scratch).force, wrench(ball, cube, pose).force
        )
    assert contacts > 1_000


def test_threads_that_share_a_scratch_get_their_own_answers(ball: vx.Model, cube: vx.Model):
    scratch = vx.QueryScratch()
    poses = [at(0.01 * i, 0.0, 0.58) for i in range(20)]
    expected = [vx.contacts(ball, cube, pose).depths.tobytes() for pose in poses]
    failures = []

    def work(step: int) -> None:
        for k in range(200):
            i = (k * step) % len(poses)
            contacts = vx.contacts(ball, cube, poses[i], scratch=scratch)
            if contacts.depths.tobytes() != expected[i]:
                failures.append(i)

    threads = [threading.Thread(target=work, args=(step,)) for step in (1, 3, 7, 9, 11, 13)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert failures == []
