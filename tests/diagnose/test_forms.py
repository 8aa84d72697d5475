"""A force of few terms is written as a sum, as one writes it by hand."""

import pytest

from harness.diagnose.criticism.check import Form


@pytest.mark.parametrize(
    ("terms", "coefficients", "text"),
    [
        (("1", "sin(q)", "v |v|"), (-0.000518, -0.00782, 4.03e-5), "-0.000518 - 0.00782·sin(q) + 4.03e-05·v |v|"),
        (("v", "1"), (0.25, 1.0), "0.25·v + 1"),
        ((), (), ""),
    ],
)
def test_a_form_reads_as_a_sum(terms: tuple[str, ...], coefficients: tuple[float, ...], text: str) -> None:
    assert str(Form("pivot", terms, coefficients, 1.0)) == text
