"""The report says where a model means little, and shows what failed."""

from coupling.report.identification_report import identification_page

MODE = {
    name: value
    for figure, size in {
        "mass_kg": 90.0, "frequency_hz": 0.96, "damping_ratio": 0.005, "pendulum_length_m": 0.27,
        "hinge_height_m": -0.02, "spring_rate_n_m": 3600.0,
    }.items()
    for name, value in ((figure, size), (f"{figure}_error", 0.01 * abs(size)))
}  # fmt: skip


def row(left_out):
    lines = [0.3, 0.9, 1.5]
    return {
        "condition": "one", "failure": None, "fill_fraction": 0.5, "amplitude_m": 0.001,
        "liquid_mass_kg": 180.0, "fixed_mass_kg": 90.0, "fixed_mass_kg_error": 0.4,
        "fixed_height_m": 0.0, "fixed_height_m_error": 0.001, "modes": [MODE],
        "left_out_error": {"1": left_out}, "coherence_least": 0.95, "coherence_median": 0.99,
        "apparent_mass": {
            "frequency_hz": lines, "real_kg": [190.0, 900.0, 20.0], "imag_kg": [0.0, -80.0, -1.0],
            "error_kg": [1.0, 9.0, 1.0],
        },
        "validation": [
            {"name": "record", "says": "record", "force_error": 0.07, "followed": False,
             "failure": None},
        ],
        "other_amplitudes": [],
    }  # fmt: skip


def page(tmp_path, *rows):
    content = {
        "title": "", "model": "potential", "followed_within": 0.05, "linear_within": 0.1,
        "rows": list(rows),
    }  # fmt: skip
    return identification_page(tmp_path, content)


def test_a_scene_that_is_not_followed_is_counted_as_such(tmp_path):
    found = page(tmp_path, row(0.03))
    assert found.verdict.startswith("The models follow 0 of 1 scenes")
    assert found.alarm == ""


def test_sweeps_that_contradict_each_other_raise_an_alarm(tmp_path):
    alarm = page(tmp_path, row(0.17)).alarm
    assert "misses the other at 0.5, 1\u202fmm (17\u202f%)" in alarm


def test_what_failed_is_shown_with_its_reason(tmp_path):
    failed = {"condition": "two", "failure": "sweep_up: why", "fill_fraction": 0.2,
              "amplitude_m": 0.001, "modes": [], "validation": []}  # fmt: skip
    found = page(tmp_path, row(0.03), failed)
    assert found.alarm == "1 of 2 conditions have no model."
    assert ["0.2, 1\u202fmm", "sweep_up: why"] in found.sections[0].tables[0].rows


def test_figures_are_told_to_the_second_digit_of_their_error(tmp_path):
    cells = page(tmp_path, row(0.03)).sections[0].tables[0].rows[1]
    assert cells[1] == "90 ± 0.9"
    assert cells[2] == "0.96 ± 0.0096"
