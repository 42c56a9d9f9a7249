from __future__ import annotations


def test_times_are_there_and_in_order(voxshell, cone_model_path):
    told = voxshell("bench", cone_model_path, "--poses", 8, "--repeats", 2, "--json").json
    assert told["mean_contacts"] > 0.0
    assert {"collide", "contacts", "manifold", "distance"} <= set(told["seconds"])
    for row in told["seconds"].values():
        assert 0.0 < row["median"] <= row["p99"] < 1.0
    assert told["environment"]["cpu"]
    ended = voxshell("bench", cone_model_path, "--poses", 8, "--repeats", 2)
    assert ended.code == 0, ended.err
    assert max(map(len, ended.out.splitlines())) <= 80
    assert "8 random poses" in ended.out.replace("\n", " ")
