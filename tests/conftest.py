"""Which tests are slow: whole diagnoses with the whole catalogue, and what is marked so where it stands.

``make test`` leaves them out, ``make test-all`` runs every one.
"""

from __future__ import annotations

from pathlib import Path

import pytest

# Of the folders whose tests diagnose recordings, the files that do so in seconds.
QUICK = {
    "diagnose": (
        "test_absence", "test_actuator_saturation",
        "test_assemblies", "test_averaged_intervals", "test_balanced_link", "test_band_of_efforts", "test_beside_a_remainder",
        "test_beyond_belief", "test_price_of_vibrations", "test_coarse_effort", "test_effort_noise_beside", "test_stop_and_go",
        "test_unseen_numbers", "test_slow_channel", "test_balancing_spring", "test_drive_limit", "test_kinds_told",
        "test_stop_met_early",
        "test_changed_numbers",
        "test_conventions", "test_crosstalk", "test_curved_valley", "test_deadline", "test_diagnose_noise_colour",
        "test_discrepancy",
        "test_dispersion", "test_effect_without_parameters", "test_effort_laws", "test_effort_words",
        "test_efforts_first", "test_end_of_link", "test_few_beside_a_force",
        "test_forms", "test_free_motion", "test_held_start", "test_joint_gain", "test_jump_in_short_windows",
        "test_noise_free_recording", "test_numbers_beside_others", "test_numbers_in_tables",
        "test_one_law_far_off",
        "test_provenance", "test_pushed_runs", "test_refused_midway",
        "test_replay", "test_resolved_numbers", "test_score_beside_force",
        "test_disagreement", "test_short_single_recording", "test_place_of_left_force", "test_link_inertia",
        "test_weighing_cut_short", "test_imbalance_found", "test_second_encoders_beside", "test_servo_gain",
        "test_without_joints", "test_loads_of_coordinates_added",
        "test_folds", "test_plain_laws", "test_search_ends", "test_separation", "test_sharp_sensitivities", "test_state_force",
        "test_summary", "test_against_nominal", "test_taken_away",
        "test_thinned_recordings", "test_trials", "test_turning_in_space", "test_turning_joints", "test_unequal_windows",
        "test_unnamed_force", "test_weak_contact", "test_what_acts",
        "test_whole_waves", "test_words_of_answers", "test_zero_of_every_recording",
    ),
    "proof": ("test_full_disk", "test_score", "test_truth", "test_same_recordings", "test_practitioner", "test_paper_damping"),
}  # fmt: skip
HERE = Path(__file__).parent


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark as slow what is not quick in the folders above."""
    for item in items:
        place = item.path.relative_to(HERE) if item.path.is_relative_to(HERE) else None
        if place is not None and place.parts[0] in QUICK and place.stem not in QUICK[place.parts[0]]:
            item.add_marker(pytest.mark.slow)
