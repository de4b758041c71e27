"""The report's answers, counts and words, from results made by hand."""

import re

import pytest

from tessera import paper
from training.paper import answers, claims, epochs, markdown, report, settings, stage_claims, stages, texts
from training.paper.comparing import OURS, PAPER


def row(figure, n, m, worst, networks=PAPER, contours=100, **more):
    """A group's line as `stages` leaves it."""
    errors = {"worst": worst, "mean": worst / 4, "worst_spread": 0.5, "mean_spread": 0.1}
    return {"figure": figure, "n": n, "m": m, "networks": networks, "contours": contours, **errors, **more}


def by_text(found, part):
    """The one claim whose words have a part."""
    (claim,) = [claim for claim in found if part in claim.what]
    return claim


@pytest.mark.parametrize(
    ("value", "spread", "larger", "wanted"),
    [
        (11.4, 0, False, "reproduced"),
        (11.6, 0, False, "worse"),
        (8.4, 0, False, "better"),
        (11.6, 0.9, False, "reproduced"),
        (8.4, 0, True, "worse"),
        (11.6, 0, True, "better"),
        (None, 0, False, "not tested"),
    ],
)
def test_answers_are_by_the_rule_that_is_stated(value, spread, larger, wanted):
    assert answers.answer(value, 10, spread, larger) == wanted
    assert "within 15 % of" in texts.introduction(settings.read(), "4") and answers.CLOSE == 0.15


def test_a_small_group_is_not_the_largest_error():
    rows = [row(22, 6, 1, 2.0), row(22, 6, 2, 90.0, contours=answers.ENOUGH - 1), row(22, 12, 14, 23.0)]
    claim = by_text(stage_claims.stage_claims(rows), "NN2 alone, largest ē_worst")
    assert (claim.ours, claim.answer, claim.paper) == ("+23.0 % (12, 14)", "reproduced", "23.41 % (12, 14)")


@pytest.mark.parametrize(("most", "ours", "answer"), [(9.0, "2 of 2", "reproduced"), (1.0, "1 of 2", "worse")])
def test_growth_is_from_the_fewest_vertices_to_the_most(most, ours, answer):
    rows = [row(22, 6, 2, 8.0), row(22, 6, 1, 2.0), row(22, 8, 4, most), row(22, 8, 3, 4.0), row(22, 8, 2, 5.0)]
    few = row(22, 6, 5, 0.0, contours=answers.ENOUGH - 1)
    claim = by_text(stage_claims.stage_claims([*rows, few]), "than with the fewest")
    assert (claim.ours, claim.answer) == (ours, answer)


def test_a_largest_error_of_some_edges_alone_is_no_better():
    rows = [row(27, 6, 1, 12.0), row(22, 14, 3, 1.0)]
    found = list(stage_claims.stage_claims(rows))
    claim = by_text(found, "whole scheme, largest ē_worst")
    assert claim.answer == "not tested" and claim.ours == "+12.0 % (6, 1); N_C 14 not measured"
    assert (
        by_text(stage_claims.stage_claims([row(27, 6, 1, 50.0), rows[1]]), "scheme, largest ē_worst").answer == "worse"
    )


def test_numbers_and_answers_of_groups_reach_their_cells():
    rows = [
        row(22, 6, 2, 10.1),
        row(22, 6, 2, -6.2, OURS),
        row(24, 14, 10, 0.3),
        row(25, 6, 4, 20.0),
        row(25, 6, 6, 15.6),
        row(25, 10, 8, 23.0, **{"rest by CDT": 10.2}),
        row(22, 10, 8, 12.0),
        row(27, 10, 8, 22.9),
    ]
    found = list(stage_claims.stage_claims(rows))
    assert by_text(found, "NN2 alone, ē_worst of N_C 6, N_I 2") == answers.Claim(
        "Fig. 22: NN2 alone, ē_worst of N_C 6, N_I 2", "10.5 %", "+10.1 %", "reproduced", "-6.2 %"
    )
    calculated = by_text(found, "N_C 14, N_I 10")
    assert (calculated.of, calculated.answer, calculated.shipped) == (answers.LIBRARY, "better", "the same")
    change = by_text(found, "from N_I 4 to 6")
    assert (change.paper, change.ours, change.answer) == ("-23 %", "-22 %", "reproduced")
    assert by_text(found, "from N_I 8 to 10").answer == "not tested"
    assert by_text(found, "NN3 alone, ē_worst of N_C 10").ours == "+23.0 % (+10.2 % with sub-contours by CDT)"
    grows = by_text(found, "than with the fewest")
    assert (grows.ours, grows.answer, grows.shipped) == ("—", "not tested", "—")
    above = by_text(found, "ē_worst is above those")
    assert (above.ours, above.answer) == ("0 of 1 groups, not (10, 8)", "worse")


def counts(errors):
    """NN1's lines from errors by (N_C, l_s), the shipped ones a tenth of them."""
    return [
        {"n": n, "l_s": l_s, "networks": name, "error": error * scale, "deviation": 8.0 * l_s}
        for (n, l_s), error in errors.items()
        for name, scale in ((PAPER, 1.0), (OURS, 0.1))
    ]


def test_errors_of_counts_are_answered():
    errors = {(4, 0.2): 0.6, (14, 0.2): 1.2, (16, 0.2): 1.38, (4, 1.0): 0.2, (14, 1.0): 0.5, (16, 1.0): 0.4}
    found = list(claims._counts(counts(errors)))
    assert by_text(found, "N_C 14, l_s 0.2") == answers.Claim(
        "Fig. 19: NN1's mean absolute error, N_C 14, l_s 0.2", "1.3", "1.20", "reproduced", "0.12"
    )
    assert by_text(found, "N_C 14, l_s 1").answer == "worse"
    largest = by_text(found, "the largest")
    assert (largest.ours, largest.answer, largest.shipped) == (
        "1.38 (16, l_s 0.2)",
        "reproduced",
        "0.14 (16, l_s 0.2)",
    )
    assert by_text(found, "over that with 4").ours == "2.3 ×"
    every = by_text(found, "at every l_s")
    assert (every.ours, every.answer) == ("1 of 2, not 1", "worse")
    assert by_text(found, "grows with N_C, at l_s 0.2").answer == "reproduced"
    assert by_text(found, "for every N_C").ours == "3 of 3"


@pytest.mark.parametrize(("spread", "fine", "answer"), [(0.001, 0.05, "reproduced"), (0.02, 0.05, "not tested")])
def test_no_gain_is_found_only_where_errors_are_small(spread, fine, answer):
    rows = [{"grid": grid, "error": error, "spread": spread} for grid, error in ((10, 0.08), (20, 0.05), (40, fine))]
    found = list(claims._resolution(rows))
    assert by_text(found, "40×40").answer == answer
    assert ("too much to tell" in by_text(found, "40×40").ours) == (answer == "not tested")


def test_answers_are_counted_by_what_is_measured():
    found = [
        answers.Claim("a", "1", "2", "worse"),
        answers.Claim("b", "1", "1", "reproduced", of=answers.LIBRARY),
        answers.Claim("c", "1", "1", "better", of=OURS),
        answers.Claim("d", "1", "1", "worse"),
    ]
    text = markdown.claim_table(found)
    assert "- 2 about the paper's networks: 2 worse.\n" in text
    assert "- 1 about the library's triangulation with calculated tables: 1 reproduced.\n" in text
    assert (
        "- 1 about the shipped networks: 1 better.\n" in text and "| d | 1 | 1 | **worse** | no counterpart |" in text
    )


def test_epochs_of_nn3_are_of_random_vertices_and_of_meshes(monkeypatch, tmp_path):
    config = {"folders": {"models": tmp_path}, "nn3": {"steps": 5000, "share": 0.5, "references": 5000}}
    notes = {"role": "nn3", "step": 20000, "examples": 101325}
    monkeypatch.setattr(epochs, "about", lambda file: notes if file.name == "nn3_8_12.onnx" else None)
    random, meshes = epochs.connection_epochs(config, 8, 12, 1325)
    assert random == pytest.approx(51.2) and meshes == pytest.approx(20000 * 256 / 1325)
    assert epochs.connection_epochs(config, 8, 11, 1325) == (None, None)


def test_the_page_is_made_of_the_kept_results_and_networks():
    config = settings.read()
    text = report.text_of(config, report.results(config))
    assert text == (config["folders"]["docs"] / "reproduction.md").read_text(), "python -m training.paper.report"
    for command in re.findall(r"`python -m training\.paper\.(\w+)", text):
        assert (settings.FILE.with_name(f"{command}.py")).exists()
    assert {f"stages {figure}" for figure in stages.FIGURES} <= set(re.findall(r"training\.paper\.(stages \d+)", text))


@pytest.mark.parametrize(
    ("numbers", "words"), [([0, 1, 2], "0 to 2"), ([0, 1, 2, 5], "0 to 2 and 5"), ([1, 3, 4, 9], "1, 3 to 4 and 9")]
)
def test_ranges_are_said_in_words(numbers, words):
    assert paper._ranges(numbers) == words
