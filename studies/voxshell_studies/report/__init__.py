"""Reports of experiments from parts' data alone: verdicts, figures, replays and the page."""
