"""Sealed cases for others: an export tells nothing, and what others claim is scored against the answers, not taken at its word."""

import json
import runpy
import shutil
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from harness.cli.main import main
from harness.effects.catalogue import catalogue
from harness.errors import InputError
from harness.proof.alike import mistaken_for
from harness.proof.claims import as_found, read_claims, score_claims, tally
from harness.proof.concealments import CONCEALMENTS
from harness.proof.export import export
from harness.proof.run import _scored, score_of_claims
from harness.proof.score import Share, score_case, summarise
from harness.proof.seal import digest

MODEL = """name = "rig"
[[joint]]
name = "pivot"
type = "continuous"
parent = "base"
child = "rod"
axis = [0, 1, 0]
[[link]]
name = "rod"
mass = 0.5
com = [0, 0, -0.2]
inertia = [0.004, 0.004, 0.004]
"""


@pytest.fixture(scope="module")
def proof(tmp_path_factory) -> Path:
    """The folder of a proof of two cases, sealed as ``conceal`` seals them; what is in the recordings is no matter here."""
    out = tmp_path_factory.mktemp("kept") / "proof"
    friction = {"effect": "coulomb_friction", "site": "pivot", "parameters": {"torque": 0.00812}}
    digests = {}
    for name, planted in (("single-0", [friction]), ("clean-0", [])):
        folder = out / "cases" / name
        folder.mkdir(parents=True)
        (folder / "model.toml").write_text(MODEL)
        for run in (1, 2):
            time = np.arange(0.0, 6.0, 0.01)
            angle = 0.4 / run * np.exp(-0.02 * time) * np.cos(6.4 * time)
            lines = [f"{t:.9g},{q:.9g}" for t, q in zip(time, angle, strict=True)]
            (folder / f"run{run}.csv").write_text("\n".join(["time,pivot.position", *lines]) + "\n")
        answer = {
            "salt": f"salt of {name}", "kind": name.partition("-")[0], "planted": planted, "visibility": [50.0] * len(planted),
            "noise_std": 1e-3,
        }  # fmt: skip
        (out / "sealed").mkdir(exist_ok=True)
        (out / "sealed" / f"{name}.json").write_text(json.dumps(answer))
        digests[name] = digest(json.dumps(answer))
    (out / "digests.json").write_text(json.dumps(digests))
    (out / "plan.json").write_text(json.dumps({"seed": 20260, "counts": {"single": 1, "clean": 1}, "short": True}))
    return out


def _claims(path: Path, cases: dict, **rest) -> Path:
    path.write_text(json.dumps({"schema": "denoc.claims/1", "entrant": "me 1", "cases": cases, **rest}))
    return path


def test_an_export_tells_nothing(proof: Path, tmp_path) -> None:
    to = tmp_path / "open"
    assert export(proof, to) == 2
    assert {p.name for p in to.iterdir()} == {"README.md", "cases", "claims.template.json", "digests.json"}
    assert {p.name for p in (to / "cases").iterdir()} == {"case-001", "case-002"}
    seed = str(json.loads((proof / "plan.json").read_text())["seed"])
    for sealed in (proof / "sealed").iterdir():
        answer = json.loads(sealed.read_text())
        words = [p["effect"] for p in answer["planted"]] + [answer["salt"], f'"{seed}"', f": {seed}", sealed.stem]
        for path in to.rglob("*"):
            if path.is_file() and path.name != "README.md":
                assert not any(word in path.read_text() for word in words)
    # The recordings are those that a diagnosis is given, byte by byte.
    names = json.loads((proof / "exported.json").read_text())
    for shown, name in names.items():
        for source in (proof / "cases" / name).glob("run*.csv"):
            assert (to / "cases" / shown / source.name).read_bytes() == source.read_bytes()
    with pytest.raises(InputError, match="not empty"):
        export(proof, to)
    # Again under the same names, so that claims of either export can be scored.
    export(proof, tmp_path / "again")
    assert json.loads((tmp_path / "again" / "digests.json").read_text()) == json.loads(
        (to / "digests.json").read_text()
    )


def test_claims_are_scored_against_the_answers(proof: Path, tmp_path) -> None:
    export(proof, tmp_path / "open")
    names = {name: shown for shown, name in json.loads((proof / "exported.json").read_text()).items()}
    (planted,) = json.loads((proof / "sealed" / "single-0.json").read_text())["planted"]
    parameters = {
        name: {"value": value, "ci95": [value - abs(value) - 1e-3, value + abs(value) + 1e-3]}
        for name, value in planted["parameters"].items()
    }
    right = {"effect": planted["effect"], "site": planted["site"], "parameters": parameters}
    file = _claims(
        tmp_path / "a.json",
        {names["single-0"]: {"findings": [right], "seconds": 3}, names["clean-0"]: {"findings": []}},
    )
    found = score_of_claims(proof, file)
    assert all(s.right for s in found.scores)
    row = found.peers["me 1"]
    assert row["named_single"] == [1, 1] and row["clean_false"] == [0, 1] and row["failed"] == 0
    assert row["coverage95"] == [len(parameters), len(parameters)] and row["seconds"] == 3.0
    # An invention on the clean case, and no answer on the other.
    wrong = {names["clean-0"]: {"findings": [{"effect": "coulomb_friction", "site": "pivot"}]}}
    found = score_of_claims(proof, _claims(tmp_path / "b.json", wrong))
    row = found.peers["me 1"]
    assert row["clean_false"] == [1, 1] and row["failed"] == 1
    # What was asked and not answered is not named: who answers only what is easy gains nothing.
    assert row["named_single"] == [0, 1] and row["false_beside_single"] == [0, 0]
    assert found.summary.failed.hits == 1


EVERYTHING = sorted(catalogue())


@pytest.mark.parametrize("named", sorted(CONCEALMENTS))
def test_who_lists_the_whole_catalogue_gains_nothing(named: str) -> None:
    """Concealed in turn is every effect that a proof conceals at one joint; one and the same claim is made of each."""
    site = {"joint": "pivot", "link": "rod", "channel": "pivot.position", "base": "base"}
    at = {e: site.get(catalogue()[e].site, "loop") for e in EVERYTHING}
    answers = {e: {"kind": "single", "planted": [{"effect": e, "site": at[e], "parameters": {}}], "visibility": [50.0]}
               for e in CONCEALMENTS}  # fmt: skip
    claim = {"effect": named, "site": at[named], "indistinguishable_from": [e for e in EVERYTHING if e != named]}
    said = {e: {"findings": [claim]} for e in answers}
    row = tally(score_claims(said, answers), said, answers)
    assert row["listed_single"] == len(EVERYTHING)
    # By itself it is right once; with its list no more than where it may be mistaken, and worth no more than one guess.
    assert row["named_single"][0] <= 1 + len(mistaken_for(named)) <= len(EVERYTHING) / 3
    assert row["worth_single"] * len(answers) <= row["named_single"][0] / len(EVERYTHING) + 1e-12 < 0.3
    honest = {e: {"findings": [{**claim, "indistinguishable_from": []}]} for e in answers}
    assert tally(score_claims(honest, answers), honest, answers)["worth_single"] >= row["worth_single"]


def test_a_list_of_two_true_equivalents_is_worth_a_half_and_each_filler_lowers_it() -> None:
    tilt = {
        "kind": "single",
        "planted": [{"effect": "base_tilt", "site": "base", "parameters": {}}],
        "visibility": [50.0],
    }

    def worth(*others: str, site: str = "p.position") -> float:
        said = {"x": {"findings": [{"effect": "sensor_offset", "site": site, "indistinguishable_from": list(others)}]}}
        return tally(score_claims(said, {"x": tilt}), said, {"x": tilt})["worth_single"]

    assert worth("base_tilt") == worth("base_tilt", "base_tilt") == 0.5
    assert worth("base_tilt", "sensor_zero") == pytest.approx(1.0 / 3.0)
    assert worth("base_tilt", "quadratic_drag") == pytest.approx(1.0 / 3.0)
    assert worth("sensor_zero") == worth() == 0.0
    # Nobody takes drag for a tilt: listing it does not make it so.
    said = {"x": {"findings": [{"effect": "quadratic_drag", "site": "p", "indistinguishable_from": ["base_tilt"]}]}}
    (score,) = score_claims(said, {"x": tilt})
    assert not score.in_class and score.false == (("quadratic_drag", "p"),)


def test_an_effect_at_another_joint_is_not_the_one_concealed() -> None:
    answer = {
        "kind": "single",
        "planted": [{"effect": "coulomb_friction", "site": "elbow", "parameters": {}}],
        "visibility": [9.0],
    }

    def right(*listed: str) -> bool:
        finding = {"effect": "coulomb_friction", "site": "shoulder", "indistinguishable_from": list(listed)}
        (score,) = score_claims({"x": {"findings": [finding]}}, {"x": answer})
        return score.in_class

    # A bare name is of the finding's own joint; the other joint has to be said.
    assert not right() and not right("stribeck_friction") and right("coulomb_friction@elbow")
    finding = {"effect": "stribeck_friction", "site": "shoulder", "indistinguishable_from": ["coulomb_friction"]}
    (score,) = score_claims({"x": {"findings": [finding]}}, {"x": answer})
    assert not score.in_class


def test_intervals_without_end_hold_the_truth_and_say_so() -> None:
    answers = {str(k): {"kind": "single", "planted": [{"effect": "coulomb_friction", "site": "p", "parameters": {"torque": 0.01}}],
                        "visibility": [50.0]} for k in range(2)}  # fmt: skip

    def row(*ends: tuple[float, float]) -> dict:
        said = {}
        for name, (low, high) in zip(answers, ends, strict=True):
            torque = {"value": 0.5 * (low + high), "ci95": [low, high]}
            said[name] = {"findings": [{"effect": "coulomb_friction", "site": "p", "parameters": {"torque": torque}}]}
        return tally(score_claims(said, answers), said, answers)

    sharp, endless = row((0.009, 0.011), (0.0095, 0.0105)), row((-1e308, 1e308), (-1e308, 1e308))
    assert sharp["coverage95"] == endless["coverage95"] == [2, 2]
    assert sharp["interval_width"] == pytest.approx(0.15) and sharp["interval_score"] == pytest.approx(0.15)
    assert endless["interval_width"] == endless["interval_score"] == np.inf
    # Half of them endless: a median of widths does not show it, the score does. One that misses costs forty times its distance.
    assert row((0.009, 0.011), (-1e3, 1e3))["interval_score"] > 1e4
    assert row((0.009, 0.011), (0.011, 0.012))["interval_score"] == pytest.approx((0.2 + 0.1 + 40 * 0.1) / 2)


def test_slips_of_a_claims_file_are_refused_and_not_scored(proof: Path, tmp_path) -> None:
    export(proof, tmp_path / "open")
    names = {name: shown for shown, name in json.loads((proof / "exported.json").read_text()).items()}
    case = names["single-0"]

    def told(*findings: dict, **more: object) -> str:
        with pytest.raises(InputError) as error:
            score_of_claims(proof, _claims(tmp_path / "s.json", {case: {"findings": list(findings)}, **more}))
        assert "\n" not in str(error.value)
        return str(error.value)

    friction = {"effect": "coulomb_friction", "site": "pivot"}
    text = told({"effect": "coulomb_friction", "site": "pivt"})
    assert f"case {case}, finding 1 has coulomb_friction at 'pivt'" in text and "there: pivot" in text
    text = told(friction, {"effect": "payload_mass", "site": "pivot"})
    assert "finding 2" in text and "sits at a link; there: rod" in text
    assert "there: pivot.position" in told({"effect": "sensor_offset", "site": "pivot"})
    assert "base_tilt at 'pivot'" in told({**friction, "indistinguishable_from": ["base_tilt@pivot"]})
    assert "there: none" in told({"effect": "loop_clearance", "site": "pivot"})
    assert "coulomb_friction at pivot more than once" in told(friction, friction)
    assert "under two names" in told(**{"single-0": {"findings": []}})
    # That a case was passed by is not for an entrant to say.
    said = {case: {"findings": [], "skipped": "too hard"}}
    (row,) = score_of_claims(proof, _claims(tmp_path / "p.json", said)).peers.values()
    assert (row["asked"], row["not_for_it"], row["named_single"]) == (2, 0, [0, 1])


def test_a_remainder_everywhere_is_told() -> None:
    clean = {"kind": "clean", "planted": [], "visibility": []}
    outside = {"kind": "outside", "planted": [{"effect": "gust", "site": "p", "parameters": {}}], "visibility": [50.0]}
    said = {"verdict": "unexplained", "findings": [], "seconds": 1.0}
    summary = summarise([score_case("c", clean, said), score_case("o", outside, said)], 5.0)
    assert summary.outside_told == Share(1, 1) and summary.told_in_vain == Share(1, 1)


def test_the_example_enters_and_sees_friction_by_hand(proof: Path, tmp_path) -> None:
    export(proof, tmp_path / "open")
    entrant = runpy.run_path(str(Path(__file__).parents[2] / "examples" / "enter_the_proof.py"))
    entrant["main"](tmp_path / "open", tmp_path / "claims.json")
    assert len(score_of_claims(proof, tmp_path / "claims.json").scores) == 2


@pytest.mark.parametrize(("dry", "viscous", "drag"), [(6e-3, 0.0, 0.0), (0.0, 6e-3, 0.0), (0.0, 0.0, 3e-4)])
def test_the_examples_work_of_friction_is_what_a_swing_loses(dry: float, viscous: float, drag: float) -> None:
    # SciPy's DOP853 from 1.4 rad to the next turning point, J = 0.02 kg·m², k = 1 N·m: energy lost, nothing of a small angle.
    entrant = runpy.run_path(str(Path(__file__).parents[2] / "examples" / "enter_the_proof.py"))

    def rate(_, y):
        return [y[1], (-np.sin(y[0]) + dry + viscous * -y[1] + drag * y[1] ** 2) / 0.02]

    def turns(t, y):
        return y[1] if t > 0.1 else -1.0

    turns.terminal, turns.direction = True, 1
    end = solve_ivp(rate, (0.0, 5.0), [1.4, 0.0], "DOP853", events=turns, rtol=1e-11, atol=1e-12).y_events[0][0][0]
    lost = np.cos(end) - np.cos(1.4)
    (work,) = entrant["friction_work"](np.array([0.5 * (1.4 - end)]), 1.0, 0.02)
    assert float(work @ [dry, viscous, drag]) == pytest.approx(lost, rel=2e-3)


@pytest.mark.parametrize(("viscous", "dry"), [(2e-3, 0.0), (0.0, 2e-3)])
def test_the_example_sees_friction_of_swings_that_stay_large(tmp_path, viscous: float, dry: float) -> None:
    (tmp_path / "model.toml").write_text(MODEL)
    rng = np.random.default_rng(2)
    time = np.arange(0.0, 6.0, 5e-3)
    for k, angle in enumerate((0.97, 0.67, 0.8), 1):

        def rate(_, y):
            return [y[1], (-0.981 * np.sin(y[0]) - viscous * y[1] - dry * np.tanh(y[1] / 1e-3)) / 0.024]

        q = solve_ivp(rate, (0.0, 6.0), [angle, 0.0], "DOP853", time, rtol=1e-9, atol=1e-11, max_step=0.01).y[0]
        table = np.column_stack([time, q + 1e-3 * rng.standard_normal(len(time))])
        np.savetxt(tmp_path / f"run{k}.csv", table, delimiter=",", header="time,pivot.position", comments="")
    entrant = runpy.run_path(str(Path(__file__).parents[2] / "examples" / "enter_the_proof.py"))
    (found,) = entrant["claims"](tmp_path)["findings"]
    acts = "viscous_damping" if viscous else "coulomb_friction"
    assert acts in (found["effect"], *found["indistinguishable_from"])
    if found["effect"] == acts:
        ((value,),) = [[p["value"] for p in found["parameters"].values()]]
        assert value == pytest.approx(2e-3, rel=0.15)


def _swings(folder: Path, model: str, dry: float, viscous: float, weight: float = 1.0) -> None:
    """Free swings of ``MODEL`` by SciPy's DOP853 along J q'' = -m g l sin q - c q' - dry; weight: true over stated."""
    (folder / "model.toml").write_text(model)
    rng = np.random.default_rng(6)
    time = np.arange(0.0, 6.0, 5e-3)
    for k, angle in enumerate((0.97, 0.67, 0.8), 1):

        def rate(_, y):
            return [y[1], (-0.981 * weight * np.sin(y[0]) - viscous * y[1] - dry * np.tanh(y[1] / 1e-3)) / 0.024]

        q = solve_ivp(rate, (0.0, 6.0), [angle, 0.0], "DOP853", time, rtol=1e-9, atol=1e-11, max_step=0.01).y[0]
        table = np.column_stack([time, q + 2e-4 * rng.standard_normal(len(time))])
        np.savetxt(folder / f"run{k}.csv", table, delimiter=",", header="time,pivot.position", comments="")


def test_the_example_takes_off_what_the_model_states(tmp_path) -> None:
    # Dry friction stated as an effect, as a sealed case may: nothing is missing. Of more than stated the rest is claimed.
    entrant = runpy.run_path(str(Path(__file__).parents[2] / "examples" / "enter_the_proof.py"))
    effect = '[[effect]]\nname = "coulomb_friction"\nsite = "pivot"\nparameters = { torque = 4e-3 }\n'
    _swings(tmp_path, MODEL + effect, 4e-3, 0.0)
    assert entrant["claims"](tmp_path)["findings"] == []
    _swings(tmp_path, MODEL + effect, 7e-3, 0.0)
    (found,) = entrant["claims"](tmp_path)["findings"]
    assert found["effect"] == "coulomb_friction"
    low, high = found["parameters"]["torque"]["ci95"]
    assert low <= 3e-3 <= high
    # Of what it has no closed form for it says nothing.
    _swings(tmp_path, MODEL + '[[effect]]\nname = "dahl_friction"\nsite = "pivot"\n'
            "parameters = { torque = 4e-3, stiffness = 1.0 }\n", 4e-3, 0.0)  # fmt: skip
    assert entrant["claims"](tmp_path)["findings"] == []


@pytest.mark.parametrize("weight", [0.97, 1.03])
def test_the_example_allows_for_the_stated_tolerance(tmp_path, weight: float) -> None:
    # Damping as stated, weight off by one and a half of the stated tolerance: the losses seem 3 % off, and nothing is missing.
    entrant = runpy.run_path(str(Path(__file__).parents[2] / "examples" / "enter_the_proof.py"))
    stated = "tolerance = 0.02\n" + MODEL.replace('type = "continuous"\n', 'type = "continuous"\ndamping = 4e-3\n')
    _swings(tmp_path, stated, 0.0, 4e-3, weight)
    assert entrant["claims"](tmp_path)["findings"] == []


def test_the_commands_go_together(proof: Path, tmp_path, capsys) -> None:
    to, kept = tmp_path / "open", str(proof)

    def status(*arguments: str) -> int:
        with pytest.raises(SystemExit) as ended:
            main(["prove", *arguments])
        return int(ended.value.code or 0)

    assert status("--resume", kept, "--export", str(to)) == 0
    assert "seed 20260 is short" in " ".join(capsys.readouterr().out.split())
    assert (
        status("--score", kept, "--claims", str(to / "claims.template.json"), "--json", str(tmp_path / "s.json")) == 0
    )
    assert json.loads((tmp_path / "s.json").read_text())["clean_false"] == [0, 1]
    capsys.readouterr()
    for arguments, told in (
        (("--score", str(to), "--claims", str(to / "claims.template.json")), "it is an export"),
        (("--claims", str(to / "claims.template.json")), "--score DIR"),
        (("--resume", kept, "--export", str(proof / "inside")), "where the answers are kept"),
        (("--resume", kept, "--export", str(tmp_path / "more"), "--peers"), "asks nobody"),
        (("--score", kept, "--claims", str(to / "digests.json")), "denoc.claims/1"),
    ):
        assert status(*arguments) == 2
        said = capsys.readouterr().err
        assert told in said and len(said.strip().splitlines()) == 1


def test_the_seed_of_an_export_cannot_be_tried_out(tmp_path, monkeypatch) -> None:
    # A rig of each of 2^31 seeds takes days to draw; a plan that nobody gave a seed has one of 128 bits.
    drawn = []

    def conceal_all(folder: Path, *, seed: int, **_: object) -> tuple[int, dict]:
        drawn.append(seed)
        return seed, {}

    monkeypatch.setattr("harness.proof.run.conceal_all", conceal_all)
    monkeypatch.setattr("harness.proof.export.export", lambda *_: 0)
    for name in ("a", "b"):
        with pytest.raises(SystemExit):
            main(["prove", "--quick", "--out", str(tmp_path / name), "--export", str(tmp_path / f"to_{name}")])
    assert len(set(drawn)) == 2 and min(drawn) >= 2**127
    # Recordings can be drawn from it: entropy of any length.
    assert np.random.default_rng([drawn[0], 0]).random() != np.random.default_rng([drawn[1], 0]).random()


def _of_friction(**parameters) -> dict:
    return {"c": {"findings": [{"effect": "coulomb_friction", "site": "p", "parameters": parameters}]}}


@pytest.mark.parametrize(
    ("cases", "told"),
    [
        ({}, 'no "cases"'),
        ({"c": {}}, 'case c has no "findings"'),
        ({"c": {"findings": [{"effect": "stiction", "site": "p"}]}}, "'stiction', which the catalogue does not know"),
        ({"c": {"findings": [{"effect": "coulomb_friction"}]}}, 'case c, finding 1 has no "effect" and "site"'),
        (_of_friction(mu={"value": 1}), "coulomb_friction has torque"),
        (_of_friction(torque={"value": "1"}), "a number"),
        (_of_friction(torque={"value": 1, "ci95": [2, 0]}), "[low, high]"),
        ({"c": {"findings": [], "verdict": "fine"}}, "verdict 'fine'"),
        ({"c": {"findings": [], "seconds": "3 s"}}, "seconds that is no number"),
        ({"c": {"findings": [], "seconds": -3}}, "seconds that is no number of nothing or more"),
        ({"c": {"findings": [], "heldout_rmse": 10**400}}, "heldout_rmse that is no number"),
        (_of_friction(torque={"value": 1, "ci95": [2, 3]}), "outside its own"),
        ({"c": {"findings": [{"effect": "coulomb_friction", "site": "p"}], "verdict": "consistent"}}, "has findings"),
        (
            {"c": {"findings": [{"effect": "coulomb_friction", "site": "p", "indistinguishable_from": [3]}]}},
            "'3' in \"indistinguishable_from\"",
        ),
        (
            {"c": {"findings": [{"effect": "coulomb_friction", "site": "p", "indistinguishable_from": ["sticktion"]}]}},
            "'sticktion' in \"indistinguishable_from\"",
        ),
    ],
)
def test_what_is_no_claims_file_is_told_in_one_line(cases: dict, told: str, tmp_path) -> None:
    with pytest.raises(InputError) as error:
        read_claims(_claims(tmp_path / "c.json", cases))
    assert told in str(error.value) and "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("[" * 100_000 + "]" * 100_000, "nested too deep"),
        ('{"schema": "denoc.claims/1", "seconds": 1' + 5000 * "0" + "}", "cannot be read"),
        ('{"schema": "denoc.claims/1", "cases": {"c": {"findings": []}, "c": {"findings": []}}}', '"c" more than once'),
        ('{"schema": "denoc.claims/1", "entrant": 5, "cases": {"c": {"findings": []}}}', "no text"),
    ],
)
def test_what_no_library_writes_is_told_in_one_line_too(text: str, told: str, tmp_path) -> None:
    (tmp_path / "c.json").write_text(text)
    with pytest.raises(InputError, match=told):
        read_claims(tmp_path / "c.json")


def test_a_mark_of_the_encoding_is_no_matter(tmp_path) -> None:
    text = '{"schema": "denoc.claims/1", "entrant": "me", "cases": {"c": {"findings": []}}}'
    (tmp_path / "c.json").write_bytes(b"\xef\xbb\xbf" + text.encode())
    assert read_claims(tmp_path / "c.json").entrant == "me"


@pytest.mark.parametrize(
    ("file", "text", "told"),
    [
        ("digests.json", "{", "digests.json: is damaged"),
        ("exported.json", "[]", "exported.json: is damaged"),
        ("sealed/clean-0.json", None, "clean-0.json: the sealed answer is gone"),
        ("sealed/clean-0.json", "{}", "was changed"),
    ],
)
def test_a_damaged_folder_is_told_in_one_line(proof: Path, tmp_path, file: str, text: str | None, told: str) -> None:
    kept = tmp_path / "kept"
    shutil.copytree(proof, kept)
    export(kept, tmp_path / "open")
    (kept / file).unlink()
    if text is not None:
        (kept / file).write_text(text)
    with pytest.raises(InputError, match=told):
        score_of_claims(kept, tmp_path / "open" / "claims.template.json")


def test_claims_of_a_class_and_of_strange_cases(proof: Path, tmp_path) -> None:
    answer = {
        "kind": "single",
        "planted": [{"effect": "base_tilt", "site": "base", "parameters": {}}],
        "visibility": [50.0],
        "noise_std": 1e-3,
    }
    said = {
        "x": {
            "findings": [{"effect": "sensor_offset", "site": "p.position", "indistinguishable_from": ["base_tilt"]}],
            "heldout_rmse": 2e-3,
        }
    }
    (score,) = score_claims(said, {"x": answer})
    assert score.in_class and not score.exact
    row = tally([score], said, {"x": answer})
    assert (
        row["named_single"] == [1, 1]
        and row["named_exactly"] == [0, 1]
        and row["heldout_over_noise"] == pytest.approx(2.0)
    )
    # What a method is not made for counts neither for nor against it.
    passed_by = {"x": {"skipped": "it is for one joint that turns"}}
    row = tally(score_claims(passed_by, {"x": answer}), passed_by, {"x": answer})
    assert (row["asked"], row["failed"], row["not_for_it"], row["named_single"]) == (0, 0, 1, [0, 0])
    assert as_found(None) == {"error": "no answer"}
    with pytest.raises(InputError, match="case-777"):
        score_of_claims(proof, _claims(tmp_path / "d.json", {"case-777": {"findings": []}}))


def test_the_diagnosis_stands_beside_its_peers(proof: Path, tmp_path, monkeypatch) -> None:
    """On the same cases, by the same table: one that says nothing anywhere is right of the clean case alone."""
    from harness.proof.peers import ask

    out = tmp_path / "proof"
    shutil.copytree(proof, out)
    (out / "found").mkdir()
    told = {"effect": "coulomb_friction", "site": "pivot", "indistinguishable_from": [], "grade": "established",
            "parameters": {"torque": {"value": 0.0081, "std": 1e-4, "ci95": [0.0079, 0.0083], "unit": "N*m"}}}  # fmt: skip
    fit = [{"channel": "pivot.position", "augmented": {"heldout_rmse": 2e-3}}]
    for name, findings in (("single-0", [told]), ("clean-0", [])):
        verdict = "explained" if findings else "consistent"
        found = {"verdict": verdict, "findings": findings, "fit": fit, "seconds": 2.0, "mismatch": []}
        (out / "found" / f"{name}.json").write_text(json.dumps(found))
    digests = json.loads((out / "digests.json").read_text())
    monkeypatch.setattr(ask, "PEERS", {"silent": lambda folder: {"findings": []}})
    rows = ask.compare_peers(out, _scored(out, digests), workers=1)
    assert list(rows) == ["denoc", "silent"]
    assert rows["denoc"]["named_single"] == [1, 1] and rows["denoc"]["coverage95"] == [1, 1]
    assert rows["silent"]["named_single"] == [0, 1] and rows["silent"]["clean_false"] == [0, 1]
    assert rows["denoc"]["seconds"] == pytest.approx(2.0)
