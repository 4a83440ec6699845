"""A swarm's mission is scored; the same seed gives the same score."""


def score(run):
    report = run.end().report
    return report["mission"]["score"], report["trace_sha256"]


def test_a_score_can_be_repeated(puckloop_start):
    scores = []
    for _ in range(2):
        run = puckloop_start("aggregation", seed=3, options=["--set", "robots=3"])
        run.step(to="3 s")
        scores.append(score(run))
    assert scores[0] == scores[1]
