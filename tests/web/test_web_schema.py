"""Whatever is sent, as the API describes itself: an answer, never a server error."""

import pytest
import schemathesis
from hypothesis import HealthCheck, Phase, given, settings
from schemathesis.checks import not_a_server_error
from schemathesis.specs.openapi.checks import (
    content_type_conformance,
    response_schema_conformance,
    status_code_conformance,
)

#: Streams never end, and jobs that work would go on after the test.
LEFT_OUT = r"/(events|start|profile|design)$"
CHECKS = [
    not_a_server_error,
    status_code_conformance,
    content_type_conformance,
    response_schema_conformance,
]


@pytest.fixture
def schema(browser, recorded):
    """The API of a project that holds something, and a draft that could be fitted."""
    browser.change(recordings=[recorded], prepared=True, starts=1)
    loaded = schemathesis.openapi.from_dict(browser.get("/api/openapi.json").json())
    loaded.location = str(browser.base_url)
    return loaded.exclude(path_regex=LEFT_OUT)


def examined(schema, browser, examples: int) -> int:
    """Send examples of every operation; how many were sent."""
    sent = 0
    for get_all_operation in schema.get_all_operations():
        operation = get_all_operation.ok()

        @settings(
            max_examples=examples,
            database=None,
            phases=[Phase.explicit, Phase.generate],
            suppress_health_check=list(HealthCheck),
        )
        @given(case=operation.as_strategy())
        def send(case) -> None:
            nonlocal sent
            answer = case.call(
                base_url=str(browser.base_url).rstrip("/"),
                headers={"X-CSRF-Token": browser.headers["X-CSRF-Token"]},
                cookies=dict(browser.cookies),
            )
            sent += 1
            case.validate_response(answer, checks=CHECKS)

        send()
    return sent


@pytest.mark.slow  # most of its time is schemathesis's own
def test_no_request_is_a_server_error(schema, browser) -> None:
    assert examined(schema, browser, 1) > 40


@pytest.mark.slow
def test_no_request_among_many_is_a_server_error(schema, browser) -> None:
    assert examined(schema, browser, 100) > 3000
