"""One HTML file that says what a run, a study or a sweep found, from its files alone."""

from coupling.report import plotting  # isort: skip  # noqa: F401 - before any other import of matplotlib
from coupling.report.picture import render_picture
from coupling.report.video import VIDEOS, render_video
from coupling.report.write import write_report

__all__ = ["VIDEOS", "render_picture", "render_video", "write_report"]
