"""What experiments say: verdicts, figures, replays and the page, from parts' data alone."""
