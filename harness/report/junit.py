"""The table as JUnit XML, one test case a row, for the test views of CI servers."""

from __future__ import annotations

from junitparser import Failure, JUnitXml, Skipped, TestCase, TestSuite

from harness.cases.gate import Judgement
from harness.cases.results import Results
from harness.report import words
from harness.report.gate.places import why


def junit(results: Results, judgement: Judgement | None = None) -> bytes:
    """JUnit XML in UTF-8; a suite for each case, ``quantity [engines]`` for each test.

    judgement: of a gate: what closes it fails, rows that are missing too; engines that were not asked for are skipped.
    """
    document = JUnitXml("denoc validate" if judgement is None else "denoc gate")
    closed = {} if judgement is None else {judged.key: why(judged) for judged in judgement.failed}
    for name in dict.fromkeys(row.case for row in results.rows):
        suite = TestSuite(_printable(name))
        rows = [row for row in results.rows if row.case == name]
        for row in rows:
            test = TestCase(
                _printable(f"{row.quantity} [{'+'.join(row.engines)}]"), classname=_printable(f"denoc.{name}")
            )
            # Measured for each check, which may give several rows; of older results a case is known as a whole.
            test.time = results.case_seconds.get(name, 0.0) / len(rows) if row.seconds is None else row.seconds
            if row.key in closed:
                test.result = [Failure(_printable(closed.pop(row.key)))]
            elif row.verdict == "fail":
                text = f"difference {words.figure(row.difference, verdict='fail')}, allowed {words.figure(row.allowed)}"
                test.result = [Failure(_printable("; ".join(filter(None, [text, row.note, words.divergence(row)]))))]
            elif row.verdict == "skipped":
                test.result = [Skipped(_printable(row.note))]
            suite.add_testcase(test)
        for note in results.notes.get(name, ()):
            suite.add_property("note", _printable(note))
        document.add_testsuite(suite)
    if judgement is not None and (closed or judgement.reference):
        suite = TestSuite("reference")
        if judgement.reference:
            closed["the reference"] = judgement.reference
        for key, said in closed.items():
            test = TestCase(_printable(key), classname="denoc.reference")
            test.result = [Failure(_printable(said))]
            suite.add_testcase(test)
        document.add_testsuite(suite)
    if judgement is not None and judgement.not_asked:
        suite = TestSuite("not held")
        for name, count in sorted(judgement.not_asked.items()):
            test = TestCase(_printable(name), classname="denoc.not_held")
            test.result = [Skipped(f"{count} accepted rows of this engine were not held: --engine leaves it out")]
            suite.add_testcase(test)
        document.add_testsuite(suite)
    document.update_statistics()
    data = document.tostring()
    return data if isinstance(data, bytes) else data.encode()


def _printable(text: str) -> str:
    # XML 1.0 has no way to write control characters.
    return "".join(c for c in text if c in "\t\n" or ord(c) >= 32)
